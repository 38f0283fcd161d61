//! Force that the hand must feel for a metric to judge the hand.

use super::Definition;

/// Force that a metric expects the hand to feel. Without a device that displays this force the metric has no meaning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Feels {
    /// Force on a floor in the target band `force_n`.
    Band,
    /// Force on a floor at the scene's zone of trauma.
    Trauma,
    /// Force on a floor at the scene's zone of damage.
    Damage,
    /// Force on the probe at the target of the rubric.
    Probe,
    /// Force on the mirror at the target of the rubric.
    Mirror,
}

impl Definition {
    /// Force that the metric expects the hand to feel; `None` for a metric of sight, of motion or of calls.
    pub fn feels(&self) -> Option<Feels> {
        Some(match self.name {
            "floor_reached" | "touches_too_light" | "touches_too_heavy" | "readings_held"
            | "readings_too_heavy" | "force_in_band" => Feels::Band,
            "trauma_events" => Feels::Trauma,
            "damage_events" => Feels::Damage,
            "probe_peak" | "contact_force" => Feels::Probe,
            "mirror_peak" | "mirror_force" => Feels::Mirror,
            _ => return None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::METRICS;
    use super::*;

    #[test]
    fn every_metric_of_a_force_expects_a_felt_force() {
        let feel = METRICS.iter().filter(|metric| metric.feels().is_some());
        assert_eq!(feel.count(), 12);
        for metric in &METRICS {
            let of_force = metric.unit == "N" || metric.name.contains("force");
            assert!(!of_force || metric.feels().is_some(), "{}", metric.name);
        }
    }

    #[test]
    fn a_force_on_a_tool_is_that_of_the_tool_in_the_title() {
        for metric in &METRICS {
            match metric.feels() {
                Some(Feels::Mirror) => assert!(metric.title.contains("mirror")),
                Some(Feels::Probe) => assert!(metric.title.contains("probe")),
                _ => {}
            }
        }
    }
}
