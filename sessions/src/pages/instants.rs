//! Instants of the findings that cost points: where the tip stood, when, and what is to be seen there.
//!
//! An instant exists only for a zone that the tip was in. A missed zone has none.

use sulcus_core::tissue::gingiva::Site;

use crate::grade::sites::{Finding, SiteGrade};
use crate::grade::{Grade, Graded, Point};

/// Largest number of pictures on a page. Chosen: three rows of two below the sheet.
pub const MOST: usize = 6;

/// Instant of a finding.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Instant {
    /// FDI number of the tooth.
    pub tooth: u8,
    /// Site of the zone.
    pub site: Site,
    /// Tick of the session.
    pub tick: u64,
    /// Name of the view of the student's screen that shows the site.
    pub view: &'static str,
    /// Finding as a sentence, without tooth and site.
    pub says: String,
}

impl Instant {
    /// Tooth, site and finding as one text.
    pub fn words(&self, tooth: &str) -> String {
        format!("{tooth} {}: {}", self.site.name(), self.says)
    }
}

/// Fault of a zone, from the worst kind to the lightest.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Fault {
    Heavy,
    Short,
    Misread,
    Tilted,
    Off,
}

impl Fault {
    /// Metrics that lose points by the fault.
    fn metrics(self) -> &'static [&'static str] {
        const CALLED: &str = "called_exact";
        const WITHIN: &str = "called_within_1mm";
        match self {
            Self::Heavy => &[
                "trauma_events",
                "damage_events",
                "readings_too_heavy",
                "touches_too_heavy",
                "force_in_band",
            ],
            Self::Short => &["floor_reached", CALLED, WITHIN],
            Self::Misread => &["misread", CALLED, WITHIN],
            Self::Tilted => &["angle_mid", "angle_proximal"],
            Self::Off => &[CALLED, WITHIN],
        }
    }

    /// Whether the fault cost points: a metric with a weight lost some, or is a critical error.
    fn costs(self, grade: &Grade) -> bool {
        let of = |name: &str| self.metrics().contains(&name);
        let lost = |score: Option<f64>| score.is_some_and(|score| score < 100.0);
        let mut metrics = grade.metrics.iter().filter(|metric| of(metric.name));
        metrics.any(|metric| metric.weight > 0.0 && lost(metric.score))
            || grade.critical.iter().any(|one| of(&one.metric))
    }
}

/// Instants of the findings that cost points, the worst first, at most `most`. Each zone has one at most.
///
/// The order is by the kind of fault, then by its size: force above the band, distance from the floor, error of the
/// call, tilt.
pub fn instants(graded: &Graded, most: usize) -> Vec<Instant> {
    let Some([_, heavy_n]) = graded.grade.force_band_n else {
        return Vec::new();
    };
    let mut found: Vec<(Fault, f64, Instant)> = Vec::new();
    for site in graded.grade.sites.iter().filter(|site| site.asked) {
        let Some((fault, size)) = fault(site, heavy_n, graded) else {
            continue;
        };
        let seen = graded.series.0.iter();
        let seen = seen.filter(|point| point.zone == Some((site.tooth, site.site)));
        // The fault shows where it is largest: the force, or the depth.
        let by = |point: &Point| match fault {
            Fault::Heavy => point.force,
            _ => point.depth,
        };
        let Some(point) = seen.max_by(|a, b| by(a).total_cmp(&by(b))) else {
            continue;
        };
        let instant = Instant {
            tooth: site.tooth,
            site: site.site,
            tick: point.tick,
            view: if site.site.is_buccal() {
                "close-up"
            } else {
                "lingual"
            },
            says: says(fault, site, graded),
        };
        found.push((fault, size, instant));
    }
    found.sort_by(|a, b| a.0.cmp(&b.0).then(b.1.total_cmp(&a.1)));
    found.truncate(most);
    found.into_iter().map(|(_, _, instant)| instant).collect()
}

/// Worst fault of a zone that cost points, and its size. None without such a fault.
fn fault(site: &SiteGrade, heavy_n: f64, graded: &Graded) -> Option<(Fault, f64)> {
    let force = site.max_force_n.unwrap_or_default();
    let trauma = graded.trauma_n.is_some_and(|trauma| force >= trauma);
    let heavy = trauma || site.is_pressed() || site.finding == Finding::ReadTooHeavy;
    let error = site.error_mm().map_or(0.0, f64::abs);
    let short = || site.truth_mm.unwrap_or_default() - site.deepest_mm.unwrap_or_default();
    let tilted = site.tilt_right == Some(false);
    let all = [
        (heavy, Fault::Heavy, force - heavy_n),
        (
            site.finding == Finding::NeverReachedFloor,
            Fault::Short,
            short(),
        ),
        (site.finding == Finding::Misread, Fault::Misread, error),
        (
            tilted || site.finding == Finding::ReadTilted,
            Fault::Tilted,
            site.tilt_deg.unwrap_or_default(),
        ),
        (site.finding == Finding::Off, Fault::Off, error),
    ];
    let mut all = all.into_iter().filter(|(is_there, _, _)| *is_there);
    let found = all.find(|(_, fault, _)| fault.costs(&graded.grade));
    found.map(|(_, fault, size)| (fault, size))
}

/// The finding in words. Prescribed values do not appear.
fn says(fault: Fault, site: &SiteGrade, graded: &Graded) -> String {
    let force = site.max_force_n.unwrap_or_default();
    let deepest = site.deepest_mm.unwrap_or_default();
    let called = site.called_mm.unwrap_or_default();
    let [least, most] = graded.grade.force_band_n.unwrap_or_default();
    match fault {
        Fault::Heavy => {
            let bleeds = graded.trauma_n.filter(|trauma| force >= *trauma);
            let bleeds = bleeds.map(|n| format!("; from {n:.2} N on, healthy tissue bleeds"));
            format!(
                "the tip stood here and pressed with {force:.2} N, taught are {least:.2} to {most:.2} N{}.",
                bleeds.unwrap_or_default()
            )
        }
        Fault::Short => format!(
            "the tip stood here, {deepest:.1} mm below the margin, and went no deeper: it did not reach the floor."
        ),
        Fault::Misread => {
            let reached = site.measured_mm.unwrap_or(deepest);
            format!(
                "the tip stood here, {reached:.1} mm below the margin; called were {called} mm."
            )
        }
        Fault::Tilted => {
            let tilt = site.tilt_deg.unwrap_or_default();
            match site.into_col_deg.filter(|_| site.site.is_proximal()) {
                Some(into) => format!(
                    "the probe stood here {tilt:.0} degrees off the tooth's axis, {into:.0} of them into the col."
                ),
                None => format!("the probe stood here {tilt:.0} degrees off the tooth's axis."),
            }
        }
        Fault::Off => format!(
            "the tip stood here, {deepest:.1} mm below the margin; the call of {called} mm is more than 1 mm off."
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pages::sample::{KINDS, session};

    #[test]
    fn an_instant_is_where_the_fault_is_largest_and_the_worst_comes_first() {
        let (_, mut graded) = session("x", KINDS[0], 1);
        // A metric of forces and one of readings have lost points.
        graded.grade.metrics[2].name = "touches_too_heavy";
        let found = instants(&graded, 4);
        // Two zones of tooth 36 have a force above 0.3 N, from which tissue bleeds.
        assert_eq!(found.len(), 2);
        assert!(found[0].says.contains("pressed with"), "{found:?}");
        for one in &found {
            let zone = Some((one.tooth, one.site));
            let seen = graded.series.0.iter().filter(|point| point.zone == zone);
            let largest = seen
                .clone()
                .fold(0.0f64, |most, point| most.max(point.force));
            let at = seen.clone().find(|point| point.tick == one.tick);
            let at = at.expect("a point of the zone");
            if one.says.contains("pressed with") {
                assert_eq!(at.force, largest, "{one:?}");
            }
            assert_eq!(one.view == "close-up", one.site.is_buccal());
        }
        let mut zones: Vec<_> = found.iter().map(|one| (one.tooth, one.site)).collect();
        zones.dedup();
        assert_eq!(zones.len(), found.len());
    }

    #[test]
    fn a_fault_that_cost_nothing_and_a_zone_without_the_tip_have_no_instant() {
        let (_, mut graded) = session("x", KINDS[0], 1);
        for metric in &mut graded.grade.metrics {
            metric.score = Some(100.0);
        }
        graded.grade.critical.clear();
        assert!(instants(&graded, MOST).is_empty());
        let (_, mut graded) = session("x", KINDS[0], 1);
        graded.series.0.clear();
        assert!(instants(&graded, MOST).is_empty());
    }
}
