//! Log of a session as sentences, and states over time.

use std::collections::BTreeMap;

use crate::review::{Lane, ReviewFile, Weight};
use sulcus_core::Scene;
use sulcus_core::output::ForceZone;

use super::window::{Window, moment};
use sulcus_sessions::exercise::events::call::READING_CALLED;
use sulcus_sessions::record::message::{Level, Message};
use sulcus_sessions::record::occurrence::{FORCE_ZONE, Occurrence, zone_name};
use sulcus_sessions::record::read::{ReadError, Recording};
use sulcus_sessions::record::viewers::is_sum;

/// Log of a session.
pub(super) struct Story(Vec<Line>);

struct Line {
    tick: u64,
    weight: Weight,
    text: String,
    /// Occurrence, for a line with name and data.
    what: Option<Occurrence>,
}

impl Story {
    /// All lines of the log.
    ///
    /// # Errors
    /// The recording has changed since it was opened.
    pub fn read(recording: &Recording) -> Result<Self, ReadError> {
        let mut lines = Vec::new();
        let mut tick = 0;
        for message in recording.messages() {
            match message? {
                Message::Row(row) => tick = row.tick,
                Message::Snapshot { tick: of, .. } => tick = of,
                // The hash is for programs only.
                Message::Event(event) if is_sum(&event.text) => {}
                Message::Event(event) => {
                    let what = Occurrence::parse(&event.text);
                    lines.push(Line {
                        // A line may have been written a little later than its tick.
                        tick: what.as_ref().map_or(tick, |what| what.tick),
                        weight: match event.level {
                            Level::Info => Weight::Info,
                            Level::Warning => Weight::Warning,
                            Level::Error => Weight::Error,
                        },
                        text: what.as_ref().map_or(event.text, sentence),
                        what,
                    });
                }
                Message::Signed(_) => {}
            }
        }
        lines.sort_by_key(|line| line.tick);
        Ok(Self(lines))
    }

    /// Writes the lines in the window; their number.
    pub fn tell(&self, file: &mut ReviewFile, scene: &Scene, window: Window) -> u64 {
        let mut told = 0;
        // States at the start of the window.
        let mut before: BTreeMap<Lane, String> = BTreeMap::new();
        for line in &self.0 {
            let time_s = line.tick as f64 * scene.tick_s();
            let lane = line.what.as_ref().and_then(lane);
            if time_s < window.from_s {
                before.extend(lane);
                continue;
            }
            if !window.holds(time_s) {
                break;
            }
            told += 1;
            let at = moment(scene, line.tick);
            file.event(at, line.weight, &line.text);
            if let Some((lane, state)) = lane {
                begin(file, scene, window, &mut before);
                file.state(at, lane, &state);
            }
            let called = line.what.iter().filter(|what| what.kind == READING_CALLED);
            for depth in called.filter_map(|what| what.data["depth_mm"].as_f64()) {
                file.called(at, depth);
            }
        }
        begin(file, scene, window, &mut before);
        told
    }
}

/// State that an occurrence begins.
fn lane(what: &Occurrence) -> Option<(Lane, String)> {
    match what.kind.as_str() {
        "site_reached" => Some((Lane::Site, place(what))),
        "left_site" => Some((Lane::Site, String::new())),
        "target_visible" => Some((Lane::Target, "target visible".to_owned())),
        "target_hidden" => Some((Lane::Target, "target hidden".to_owned())),
        _ => None,
    }
}

/// Begins the window with the states from before, once.
fn begin(
    file: &mut ReviewFile,
    scene: &Scene,
    window: Window,
    before: &mut BTreeMap<Lane, String>,
) {
    let tick = (window.from_s / scene.tick_s()).ceil() as u64;
    for (lane, state) in std::mem::take(before) {
        file.state(moment(scene, tick), lane, &state);
    }
}

/// Tooth and site in the words of a dentist.
fn place(what: &Occurrence) -> String {
    let tooth = what.data["tooth"].as_u64().map(|fdi| fdi.to_string());
    let site = what.data["site"].as_str().map(str::to_owned);
    let parts: Vec<String> = tooth.into_iter().chain(site).collect();
    parts.join(" ")
}

/// An occurrence as a sentence.
fn sentence(what: &Occurrence) -> String {
    let number = |key: &str, digits: usize| match what.data[key].as_f64() {
        Some(x) => format!("{x:.digits$}"),
        None => "?".to_owned(),
    };
    let word = |key: &str| what.data[key].as_str().unwrap_or("?").replace('_', " ");
    let place = place(what);
    match what.kind.as_str() {
        "site_reached" => format!("{place}: the tip comes in"),
        "floor_felt" => format!(
            "{place}: floor felt at {} mm with {} N",
            number("depth_mm", 1),
            number("force_n", 2)
        ),
        "angle" => {
            let right = what.data["right"] == true;
            format!(
                "{place}: tilt {}, {} degrees to the tooth's axis",
                if right { "is right again" } else { "is wrong" },
                number("tilt_deg", 0)
            )
        }
        "left_site" => {
            let deepest = match what.data["deepest_mm"].as_f64() {
                Some(mm) => format!("deepest {mm:.1} mm at the reading force"),
                None => "never at the reading force".to_owned(),
            };
            format!(
                "{place}: left after {} s, {deepest}, at most {} N on the floor",
                number("seconds", 1),
                number("max_force_n", 2)
            )
        }
        "withdrawn" => format!(
            "{place}: withdrawn from the pocket between {} and {}",
            word("from"),
            word("to")
        ),
        "bleeding" => format!("{place}: bleeds, by {}", word("cause")),
        FORCE_ZONE => {
            let light = what.data["zone"] == zone_name(ForceZone::Light);
            let force = number("floor_force_n", 2);
            if light {
                format!("force on the floor is light again: {force} N")
            } else {
                format!(
                    "force on the floor: {}, {force} N at {} mm",
                    word("zone"),
                    number("depth_mm", 1)
                )
            }
        }
        "target_visible" | "target_hidden" => {
            let seen = what.kind == "target_visible";
            format!(
                "{place} {}: {} % of it free of the tongue",
                if seen { "can be seen" } else { "is hidden" },
                what.data["free"]
                    .as_f64()
                    .map_or("?".to_owned(), |free| format!("{:.0}", free * 100.0))
            )
        }
        READING_CALLED => format!("{place}: called {} mm", number("depth_mm", 0)),
        _ => plainly(what),
    }
}

/// Text of an occurrence without a sentence: its kind and its data.
fn plainly(what: &Occurrence) -> String {
    let name = what.kind.replace('_', " ");
    let Some(data) = what.data.as_object().filter(|data| !data.is_empty()) else {
        return name;
    };
    let said = data.iter().map(|(key, value)| {
        let value = match value.as_str() {
            Some(text) => text.to_owned(),
            None => value.to_string(),
        };
        format!("{} {value}", key.replace('_', " "))
    });
    format!("{name}: {}", said.collect::<Vec<_>>().join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn said(kind: &str, data: serde_json::Value) -> String {
        sentence(&Occurrence {
            kind: kind.into(),
            tick: 7,
            data,
        })
    }

    #[test]
    fn events_are_told_as_a_dentist_says_them() {
        let at = |more: serde_json::Value| {
            let mut data = json!({"tool": 0, "tooth": 36, "site": "mesiobuccal"});
            for (key, value) in more.as_object().expect("an object") {
                data[key] = value.clone();
            }
            data
        };
        for (kind, data, expected) in [
            (
                "floor_felt",
                at(json!({"depth_mm": 4.04, "force_n": 0.2151})),
                "36 mesiobuccal: floor felt at 4.0 mm with 0.22 N",
            ),
            (
                "left_site",
                at(json!({"deepest_mm": null, "max_force_n": 0.1, "seconds": 1.25})),
                "36 mesiobuccal: left after 1.2 s, never at the reading force, at most 0.10 N on the floor",
            ),
            (
                "force_zone",
                json!({"zone": "too_heavy", "floor_force_n": 0.31, "depth_mm": 4.2}),
                "force on the floor: too heavy, 0.31 N at 4.2 mm",
            ),
            (
                "target_hidden",
                json!({"tooth": 37, "free": 0.25}),
                "37 is hidden: 25 % of it free of the tongue",
            ),
            (
                "reading_called",
                at(json!({"depth_mm": 4})),
                "36 mesiobuccal: called 4 mm",
            ),
            // Kinds of another version, or of a client.
            (
                "some_thing",
                json!({"a_b": "x", "c": 1}),
                "some thing: a b x, c 1",
            ),
            ("floor_felt", json!(null), ": floor felt at ? mm with ? N"),
        ] {
            assert_eq!(said(kind, data), expected);
        }
    }
}
