//! Grade as text for a terminal and as JSON, limited by the mode.

use std::path::Path;

use serde_json::{Value, json};
use sulcus_program::PathText;

use super::args::{GradeArgs, file_name};
use super::session::One;
use crate::cli::print::object;
use crate::grade::revision::Proposal;
use crate::grade::run::MEASURES_SOURCE;
use crate::grade::stats::rounded;
use crate::record::mode::Mode;

/// Text for a terminal.
pub(super) fn text(path: &Path, one: &One, args: &GradeArgs) -> String {
    let exam = one.shown.mode == Mode::Exam;
    let grade = &one.graded.grade;
    let mut lines = vec![path.shown().to_string()];
    lines.push(format!("  mode       {}", one.shown.words()));
    if let (Some(own), Some(score)) = (one.self_score, grade.score) {
        lines.push(format!(
            "  own score  {own:.1}, {:+.1} against the program's score",
            own - score
        ));
    }
    lines.push(grade.text(exam, args.truth));
    if let Some(sidecar) = &one.sidecar {
        let before = sidecar.proposal.differs(&Proposal::of(grade));
        let before = before.filter(|_| !sidecar.revisions.is_empty());
        lines.extend(before.map(|said| format!("  THEN       revised when {said} was proposed")));
        for (k, said) in sidecar.revisions.iter().enumerate() {
            let last = k + 1 == sidecar.revisions.len();
            lines.push(format!(
                "  {} {:.1}, {}, by {} at {}: {}",
                if last { "REVISED   " } else { "before    " },
                said.score,
                if said.passed { "passed" } else { "not passed" },
                said.by.escape_debug(),
                said.at.escape_debug(),
                said.reason.escape_debug()
            ));
        }
    }
    lines.push(String::new());
    lines.join("\n")
}

/// Fields of a zone that an exam shows: the calls, and the hand's technique. No field tells a real or prescribed depth.
const IN_EXAM: [&str; 12] = [
    "tooth",
    "site",
    "asked",
    "called_mm",
    "recession_called_mm",
    "bleeding_called",
    "furcation_called",
    "max_force_n",
    "held_s",
    "tilt_deg",
    "into_col_deg",
    "tilt_right",
];

/// JSON for other programs.
pub(super) fn json(path: &Path, one: &One) -> Value {
    let mut json = object(one.graded.grade.to_json());
    if one.shown.mode == Mode::Exam {
        json.remove("advice");
        let sites = json.get_mut("sites").and_then(Value::as_array_mut);
        for site in sites.into_iter().flatten().filter_map(Value::as_object_mut) {
            site.retain(|key, _| IN_EXAM.contains(&key.as_str()));
        }
    }
    json.insert(
        "graded_by".into(),
        json!({ "version": env!("CARGO_PKG_VERSION"), "measures": MEASURES_SOURCE }),
    );
    json.insert("file".into(), json!(file_name(path)));
    json.insert("seconds".into(), json!(rounded(one.graded.seconds, 3)));
    json.insert("moments".into(), json!(one.moments));
    json.insert("mode".into(), json!(one.shown.mode));
    json.insert("recorded_mode".into(), json!(one.shown.recorded));
    json.insert("self_score".into(), json!(one.self_score));
    if let Some(error) = &one.unkept {
        json.insert("unkept".into(), json!(crate::sentence(error)));
    }
    let revisions = one.sidecar.as_ref().map(|sidecar| &sidecar.revisions);
    json.insert(
        "revisions".into(),
        json!(revisions.map_or(&[][..], Vec::as_slice)),
    );
    Value::Object(json)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grade::test_help::zone;
    use sulcus_core::tissue::gingiva::Site;

    /// Fields of a zone that an exam keeps back.
    const KEPT_BACK: [&str; 10] = [
        "bled",
        "deepest_mm",
        "finding",
        "furcation_truth",
        "measured_mm",
        "pressed_s",
        "probed",
        "recession_truth_mm",
        "shown_mm",
        "truth_mm",
    ];

    /// Before, an exam's JSON had the prescribed furcation, a field that was new at that time.
    #[test]
    fn whatever_a_zone_says_is_shown_in_an_exam_or_kept_back() {
        let zone = json!(zone(Site::Buccal, 3.0, Some(3.0), Some(3)));
        let keys: Vec<&str> = zone
            .as_object()
            .expect("an object")
            .keys()
            .map(String::as_str)
            .collect();
        let mut known = [&IN_EXAM[..], &KEPT_BACK].concat();
        known.sort_unstable();
        assert_eq!(keys, known);
    }
}
