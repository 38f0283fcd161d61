//! Moments of a session that explain its grade: where points were lost, trauma, and what an instructor flagged or noted.
//!
//! A person who asks for the reason of a grade opens the replay at a moment. The moments come from the replay and from
//! the session's log; no depth by the scene appears in them.

use serde::Serialize;
use sulcus_core::Scene;

use super::instants::instants;
use crate::grade::Graded;
use crate::grade::stats::rounded;
use crate::record::message::Message;
use crate::record::occurrence::{FORCE_ZONE, Occurrence};
use crate::record::read::{ReadError, Recording};

/// Largest number of moments of each source. Chosen: a list that a person reads.
const MOST: usize = 64;

/// Source of a moment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// Finding of a zone that cost points.
    Finding,
    /// Force from which healthy tissue bleeds, or above.
    Trauma,
    /// Moment that an instructor flagged.
    Flag,
    /// Note of an instructor.
    Note,
}

/// Moment of a session.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Moment {
    /// Tick of the session.
    pub tick: u64,
    /// Time in the session, seconds.
    pub at_s: f64,
    /// Source.
    pub kind: Kind,
    /// FDI number of the tooth; null without a tooth.
    pub tooth: Option<u8>,
    /// Name of the site; null without a site.
    pub site: Option<&'static str>,
    /// Description, one sentence.
    pub text: String,
    /// Opaque id of the instructor; null for a finding of the program.
    pub by: Option<String>,
}

/// Moments of a graded session, in the order of their times. Findings are left out of an exam, because their sentences
/// tell reached depths. A session in several recordings has the moments of its last recording, without findings.
///
/// # Errors
/// A file that changed after it was opened, or a scene that cannot be read.
pub fn moments(
    recording: &Recording,
    graded: &Graded,
    is_exam: bool,
) -> Result<Vec<Moment>, ReadError> {
    let scene = recording.scene()?;
    let tick_s = scene.tick_s();
    let mut all = Vec::new();
    if !is_exam && graded.grade.parts.len() < 2 {
        all.extend(instants(graded, MOST).into_iter().map(|one| Moment {
            tick: one.tick,
            at_s: 0.0,
            kind: Kind::Finding,
            tooth: Some(one.tooth),
            site: Some(one.site.name()),
            text: one.says,
            by: None,
        }));
    }
    let mut said = Vec::new();
    for message in recording.messages() {
        let Message::Event(event) = message? else {
            continue;
        };
        let occurrence = Occurrence::parse(&event.text);
        said.extend(occurrence.and_then(|one| of_log(&one, &scene)));
    }
    // The worst are not the first: each source is limited by itself.
    for kind in [Kind::Trauma, Kind::Flag, Kind::Note] {
        let of_kind = said.iter().filter(|one: &&Moment| one.kind == kind);
        all.extend(of_kind.take(MOST).cloned());
    }
    for one in &mut all {
        one.at_s = rounded(one.tick as f64 * tick_s, 3);
    }
    all.sort_by_key(|one| one.tick);
    Ok(all)
}

/// Moment of a line of the log, without its time in seconds. None for a line that explains no grade.
fn of_log(one: &Occurrence, scene: &Scene) -> Option<Moment> {
    let text = |field: &str| one.data[field].as_str().map(str::to_owned);
    let moment = |kind, tooth, text, by| Moment {
        tick: one.tick,
        at_s: 0.0,
        kind,
        tooth,
        site: None,
        text,
        by,
    };
    match one.kind.as_str() {
        "flag" => Some(moment(Kind::Flag, None, text("text")?, text("by"))),
        "note" => Some(moment(Kind::Note, None, text("text")?, text("by"))),
        FORCE_ZONE => {
            let zone = one.data["zone"].as_str()?;
            let told = match zone {
                "trauma" => "healthy tissue bleeds under this force",
                "damage" => "this force damages healthy tissue",
                _ => return None,
            };
            let force = one.data["floor_force_n"].as_f64()?;
            let object = one.data["object"].as_u64().unwrap_or(u64::MAX);
            let object = usize::try_from(object).ok();
            let tooth = object.and_then(|k| scene.objects.get(k)).map(|o| o.fdi);
            let text = format!("the tip presses the floor with {force:.2} N: {told}.");
            Some(moment(
                Kind::Trauma,
                tooth.filter(|fdi| *fdi != 0),
                text,
                None,
            ))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn scene() -> Scene {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/corpus/probing.mcap");
        let recording = Recording::open(file.as_ref()).expect("a recording");
        recording.scene().expect("a scene")
    }

    #[test]
    fn flags_notes_and_trauma_of_the_log_are_moments_and_nothing_else_is() {
        let scene = scene();
        let line = |kind: &str, data| Occurrence {
            kind: kind.into(),
            tick: 40,
            data,
        };
        let flag = line("flag", json!({ "by": "t04", "text": "wrist <b>" }));
        let flag = of_log(&flag, &scene).expect("a moment");
        assert_eq!(
            (flag.kind, flag.tick, flag.text.as_str(), flag.by.as_deref()),
            (Kind::Flag, 40, "wrist <b>", Some("t04"))
        );
        let pocket = scene.objects.iter().position(|object| object.fdi != 0);
        let zone = |zone: &str| {
            let data = json!({ "zone": zone, "floor_force_n": 0.624, "object": pocket });
            of_log(&line(FORCE_ZONE, data), &scene)
        };
        let trauma = zone("trauma").expect("a moment");
        assert!(trauma.text.contains("0.62 N") && trauma.tooth.is_some());
        assert!(zone("damage").is_some());
        assert_eq!(zone("light"), None);
        assert_eq!(zone("too_heavy"), None);
        assert_eq!(of_log(&line("bleeding", json!({})), &scene), None);
        // A line of a damaged log is no moment.
        assert_eq!(of_log(&line("flag", json!({ "by": 3 })), &scene), None);
        let data = json!({ "zone": "trauma", "floor_force_n": 1.0, "object": 9999 });
        let far = of_log(&line(FORCE_ZONE, data), &scene).expect("a moment");
        assert_eq!(far.tooth, None);
    }
}
