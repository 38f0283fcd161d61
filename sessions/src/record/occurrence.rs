//! Events with name and data, as lines of a session's log: `KIND at tick N: JSON`. Events of a client and events of the
//! exercise have the same form.

use std::fmt;

use serde_json::{Value, json};
use sulcus_core::output::{ForceZone, PocketReading};

use crate::record::message::Level;

/// Kind of the event: the force of a hand on the floor of a pocket enters another zone.
pub const FORCE_ZONE: &str = "force_zone";

/// Event of an exercise, with name and data.
#[derive(Clone, Debug, PartialEq)]
pub struct Occurrence {
    /// Kind, one word.
    pub kind: String,
    /// Tick of the event.
    pub tick: u64,
    /// Data of the event.
    pub data: Value,
}

impl Occurrence {
    /// Event `force_zone`: a hand entered another zone of force. Data: `tool`, `object`, `zone` (`light`, `too_heavy`,
    /// `trauma` or `damage`), `floor_force_n`, `depth_mm` and `around_deg` (from mesial over buccal).
    pub fn force_zone(tick: u64, tool: usize, reading: &PocketReading) -> Self {
        Self {
            kind: FORCE_ZONE.into(),
            tick,
            data: json!({
                "tool": tool,
                "object": reading.object,
                "zone": zone_name(reading.zone),
                "floor_force_n": reading.floor_force,
                "depth_mm": reading.depth * 1e3,
                "around_deg": reading.around.to_degrees(),
            }),
        }
    }

    /// Importance. Faults of a learner, gaps of the connection and other devices after a gap are warnings.
    pub fn level(&self) -> Level {
        let light = self.kind == FORCE_ZONE && self.data["zone"] == zone_name(ForceZone::Light);
        let wrong = match self.kind.as_str() {
            FORCE_ZONE => !light,
            "angle" => self.data["right"] == false,
            "withdrawn" | "detached" | "devices_changed" | "diverged" => true,
            "bleeding" => self.data["cause"] == "trauma",
            _ => false,
        };
        if wrong { Level::Warning } else { Level::Info }
    }

    /// Occurrence in a line of the log; `None` for any other line.
    pub fn parse(text: &str) -> Option<Self> {
        let (head, data) = text.split_once(": ")?;
        let (kind, tick) = head.split_once(" at tick ")?;
        Some(Self {
            kind: kind.to_owned(),
            tick: tick.parse().ok()?,
            data: serde_json::from_str(data).ok()?,
        })
    }
}

impl fmt::Display for Occurrence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} at tick {}: {}", self.kind, self.tick, self.data)
    }
}

/// Name of a zone of force in data.
pub fn zone_name(zone: ForceZone) -> &'static str {
    match zone {
        ForceZone::Light => "light",
        ForceZone::TooHeavy => "too_heavy",
        ForceZone::Trauma => "trauma",
        ForceZone::Damage => "damage",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_occurrence_survives_the_log() {
        let reading = PocketReading {
            object: 1,
            around: 1.5,
            depth: 4.25e-3,
            floor_force: 0.53,
            zone: ForceZone::Trauma,
            entered_zone: true,
        };
        let said = Occurrence::force_zone(1234, 0, &reading);
        assert_eq!(said.data["zone"], "trauma");
        assert_eq!(said.data["floor_force_n"], 0.53);
        assert_eq!(Occurrence::parse(&said.to_string()), Some(said));
        for other in [
            "session ended: Stopped",
            "x at tick y: {}",
            "x at tick 1: {",
        ] {
            assert_eq!(Occurrence::parse(other), None);
        }
    }
}
