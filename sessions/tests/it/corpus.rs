//! The corpus: small recordings of every exercise and of hard cases, which every later version replays bit for bit, or migrates and
//! grades.
//!
//! # What is there
//! `tests/corpus/*.mcap`, each under 300 kB: a second or so of each exercise (`crown`, `probing`, `retraction`, `bimanual`), one with an
//! instructor's and the network's commands (`commands`: pause, limit of force, skipped ticks, a stale and an absent
//! tool), one at two thousand ticks a second (`crown-2khz`), one with Clarabel in the tick (`crown-judged`), and hard cases (`hard-...`). They begin with a snapshot in mid-exercise. Their scenes are those of the exercises without what the tick
//! does not read, and of the mouth one tooth with its gingiva and the tongue.
//!
//! What can be graded carries its rubric, and has its grade beside it (`NAME.grade.json`): years later it is the same. In
//! `tests/corpus/before` are recordings of the same format that an earlier program made, without what it did not write yet. In
//! `tests/corpus/format-N` are a few of those that an earlier version of the format made. The files of `tests/corpus` itself are of
//! version 4 until the corpus is made anew. Those of `format-5` and `format-6` are the rows of the present files, written by
//! programs of these versions.
//!
//! # How it is made
//! ```text
//! cargo run --release -p sulcus-client --example corpus
//! ```
//! writes all files anew; the same program writes the same bytes. It refuses to run as a debug build, and these tests are a debug
//! build's: so they also show that debug and release give the same bits.
//!
//! # When a test here fails
//! The tick, the state or the format is not what it was. If that was not meant, it is a fault. If it was: raise
//! [`sulcus_sessions::record::header::FORMAT_VERSION`], say in `sessions/src/record/format.rs` what changed and what becomes of older recordings, move
//! a few of the files to `tests/corpus/format-N`, where they are graded for good, and make the corpus anew.
#![allow(clippy::unwrap_used)]

use std::path::{Path, PathBuf};

use crate::common::{Edit, rewritten};
use serde_json::Value;
use sulcus_core::output::status;
use sulcus_core::tissue::TissueModel;
use sulcus_sessions::*;

/// Names of the files, without their extension.
const NAMES: [&str; 15] = [
    "bimanual",
    "commands",
    "crown",
    "crown-2khz",
    "crown-judged",
    "hard-infeasible",
    "hard-nan-poses",
    "hard-peg-in-hole",
    "hard-pocket-flicker",
    "hard-thin-plate-0.3mm-2",
    "hard-tongue-teleport",
    "hard-two-probes",
    "hard-wedge",
    "probing",
    "retraction",
];
/// Those of them that can be graded.
const GRADED: [&str; 5] = ["commands", "crown", "crown-2khz", "crown-judged", "probing"];
/// Recordings of the present format by an earlier program: without a sum over what viewers read, a rubric, the tick's source.
const BEFORE: [&str; 2] = ["hard-wedge", "probing"];
/// Largest file, bytes.
const MOST_BYTES: u64 = 300_000;

/// Recordings of former versions, by folder.
const FORMER: [(&str, &[&str]); 1] = [(
    "format-3",
    &["hard-tongue-teleport", "probing", "retraction"],
)];

/// Recordings of former versions whose tick is the present one, by folder: held to every bit. `crown` has its grade beside it.
const FORMER_OF_THIS_TICK: [(&str, &[&str]); 3] = [
    ("format-4", &["crown", "hard-wedge"]),
    ("format-5", &["crown", "hard-wedge"]),
    ("format-6", &["crown", "hard-wedge"]),
];

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus")
}

fn open(name: &str) -> Recording {
    let path = folder().join(format!("{name}.mcap"));
    Recording::open(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn replayed(recording: &Recording, options: &ReplayOptions) -> ReplayReport {
    replay(recording, options, &mut |_| {}).unwrap()
}

fn rows(recording: &Recording) -> Vec<Row> {
    let rows = recording
        .messages()
        .filter_map(|message| match message.unwrap() {
            Message::Row(row) => Some(row),
            _ => None,
        });
    rows.collect()
}

#[test]
fn the_corpus_is_all_there_and_small() {
    let folders = [&FORMER[..], &FORMER_OF_THIS_TICK].concat();
    let folders = folders
        .into_iter()
        .map(|(folder, names)| (folder, names.to_vec()));
    let present = [("", NAMES.to_vec()), ("before", BEFORE.to_vec())];
    for (of, names) in folders.chain(present) {
        let entries = std::fs::read_dir(folder().join(of)).unwrap();
        let mut found: Vec<(String, u64)> = entries
            .map(|entry| entry.unwrap())
            .filter(|entry| entry.path().extension().is_some_and(|is| is == "mcap"))
            .map(|entry| {
                let name = entry.file_name().into_string().unwrap();
                (name, entry.metadata().unwrap().len())
            })
            .collect();
        found.sort();
        let mut names: Vec<String> = names.iter().map(|name| format!("{name}.mcap")).collect();
        // (A dot comes behind a hyphen.)
        names.sort();
        assert!(found.iter().map(|(name, _)| name).eq(&names), "{found:?}");
        assert!(
            found.iter().all(|(_, bytes)| *bytes < MOST_BYTES),
            "{found:?}"
        );
    }
}

#[test]
fn recordings_of_former_versions_are_migrated_and_graded() {
    for (of, names) in FORMER {
        let (mut differ, mut graded) = (0, 0);
        for name in names {
            let name = format!("{of}/{name}");
            let recording = open(&name);
            let migration = recording.migration().unwrap();
            assert_eq!(format!("format-{}", migration.from), of, "{name}");
            let report = replayed(&recording, &ReplayOptions::default());
            // The tick is another; signatures are over what was written.
            assert!(report.is_close(), "{name}: {report:?}");
            assert!(
                matches!(report.signature, Signature::Valid { .. }) && report.chain_ok,
                "{name}: {report:?}"
            );
            assert!(
                report.gradable && !report.is_finding(),
                "{name}: {report:?}"
            );
            let found = grade::grade(&recording, &grade::Options::default(), &mut |_| {}).unwrap();
            let grade = &found.grade;
            let migrated = grade.migrated.as_ref().unwrap();
            assert_eq!(
                migrated.max_force_n > 0.0,
                !report.identical,
                "{name}: {migrated:?}"
            );
            if grade.score.is_some() {
                assert!(grade.text(false, false).contains("migrated   from format"));
                graded += 1;
            }
            differ += u32::from(!report.identical);
        }
        assert!(
            // (A scene cut down for its size has not what `retraction` asks for, and so no grade.)
            differ >= 1 && graded >= 1,
            "{of}: {differ} differ, {graded} are graded"
        );
    }
}

#[test]
fn recordings_of_former_versions_with_the_present_tick_are_held_to_every_bit() {
    for (of, names) in FORMER_OF_THIS_TICK {
        for name in names {
            let recording = open(&format!("{of}/{name}"));
            assert!(recording.migration().is_none(), "{name}");
            let report = replayed(&recording, &ReplayOptions::default());
            assert!(
                report.identical && report.gradable && !report.is_finding(),
                "{name}: {report:?}"
            );
            let path = folder().join(of).join(format!("{name}.grade.json"));
            let Ok(golden) = std::fs::read_to_string(path) else {
                continue;
            };
            let golden: serde_json::Value = serde_json::from_str(&golden).unwrap();
            let found = grade::grade(&recording, &grade::Options::default(), &mut |_| {}).unwrap();
            let found = found.grade.to_json();
            assert_eq!(found["score"], golden["score"], "{name}");
            let values = |grade: &serde_json::Value| -> Vec<_> {
                let metrics = grade["metrics"].as_array().unwrap();
                metrics
                    .iter()
                    .map(|metric| (metric["name"].clone(), metric["value"].clone()))
                    .collect()
            };
            assert!(!values(&golden).is_empty());
            assert_eq!(values(&found), values(&golden), "{name}");
            assert!(found["migrated"].is_null(), "{name}");
        }
    }
}

#[test]
fn a_former_version_cannot_pass_for_the_present_one() {
    // Under the name of a version with the present tick it is held to the present measure, and the signature does not hold.
    for (pretended, says) in [
        ("3", None),
        ("4", Some("differs")),
        ("5", Some("differs")),
        ("6", Some("differs")),
        ("7", Some("differs")),
    ] {
        let bytes = std::fs::read(folder().join("format-3/hard-tongue-teleport.mcap")).unwrap();
        let recording = Recording::from_bytes(rewritten(
            &bytes,
            &mut Edit {
                message: &mut |_, _| true,
                metadata: &mut |pairs| {
                    pairs.insert("format_version".to_owned(), pretended.to_owned());
                },
                attachment: &mut |_, _| {},
            },
        ));
        let report = replayed(&recording.unwrap(), &ReplayOptions::default());
        assert_eq!(report.gradable, says.is_none(), "{report:?}");
        assert_eq!(
            report.is_finding(),
            says.is_some_and(|says| report.reason.as_ref().unwrap().contains(says)),
            "{report:?}"
        );
        assert_eq!(report.chain_ok, says.is_none());
    }
}

#[test]
fn every_recording_replays_bit_for_bit() {
    for name in NAMES {
        let recording = open(name);
        // Recorded by a release build, replayed by this one.
        assert_eq!(recording.header().build, "release", "{name}");
        let report = replayed(&recording, &ReplayOptions::default());
        assert!(
            report.identical && report.gradable,
            "{name}: see the head of this file: {report:?}"
        );
        assert!(report.ticks >= 200, "{name}: {report:?}");
        // From the snapshot in the middle.
        let scene = recording.scene().unwrap();
        let (first, last) = recording.facts().ticks.unwrap();
        let late = last - (last - first) / 4;
        let span = Span {
            from_s: Some(late as f64 * scene.tick_s()),
            to_s: None,
        };
        let part = replayed(
            &recording,
            &ReplayOptions {
                span,
                ..ReplayOptions::default()
            },
        );
        assert!(
            part.identical && part.ticks < report.ticks,
            "{name}: {part:?}"
        );
        assert!(part.part.unwrap().snapshot_tick > first, "{name}: {part:?}");
    }
}

#[test]
fn what_an_earlier_program_recorded_replays_bit_for_bit_too() {
    for name in BEFORE {
        let recording = open(&format!("before/{name}"));
        assert_eq!(recording.header().rubric, "", "{name}");
        assert!(recording.migration().is_none(), "{name}");
        let report = replayed(&recording, &ReplayOptions::default());
        assert!(report.identical && report.gradable, "{name}: {report:?}");
    }
}

/// Members of a grade's JSON that hold words only.
const WORDS: [&str; 6] = [
    "definition",
    "recorded_definition",
    "redefined",
    "source",
    "text",
    "title",
];

/// A grade without its words: members of words are left out, and a sentence becomes the list of its numbers.
fn numbers_of(value: &Value) -> Value {
    match value {
        Value::Object(map) => {
            let kept = map.iter().filter(|(key, _)| !WORDS.contains(&key.as_str()));
            kept.map(|(key, value)| (key.clone(), numbers_of(value)))
                .collect()
        }
        Value::Array(list) => list.iter().map(numbers_of).collect(),
        Value::String(text) if text.contains(' ') => {
            let words = text.split(|c: char| !(c.is_ascii_digit() || "+-.".contains(c)));
            words
                .filter(|word| word.contains(|c: char| c.is_ascii_digit()))
                .collect()
        }
        other => other.clone(),
    }
}

#[test]
fn a_mended_sentence_changes_no_numbers_and_a_changed_number_does() {
    let of = |text: &str| numbers_of(&serde_json::from_str(text).unwrap());
    let grade =
        r#"{"name": "a", "text": "hold it", "failures": ["41.9 points, 70 needed"], "value": 1.5}"#;
    let mended = grade
        .replace("needed", "are needed")
        .replace("hold it", "hold");
    assert_eq!(of(grade), of(&mended));
    for (from, to) in [("41.9", "41.8"), ("1.5", "1.50001"), ("\"a\"", "\"b\"")] {
        assert_ne!(of(grade), of(&grade.replace(from, to)), "{from}");
    }
}

/// A grade is recomputed from the recording alone: every number of it is the same in debug and release builds, here and elsewhere.
/// The words are compared by their version (`sulcus_sessions::grade::definitions`). Where a metric is meant to be measured otherwise
/// from now on, `--example corpus -- grades` writes the grades alone.
#[test]
fn every_grade_is_what_it_was() {
    for name in NAMES {
        let recording = open(name);
        let found = grade::grade(&recording, &grade::Options::default(), &mut |_| {}).unwrap();
        assert_eq!(
            GRADED.contains(&name),
            found.grade.score.is_some(),
            "{name}"
        );
        if found.grade.score.is_none() {
            continue;
        }
        let used = found.grade.rubric.as_ref().unwrap();
        assert_eq!(used.source, grade::report::Source::Recording, "{name}");
        let path = folder().join(format!("{name}.grade.json"));
        let golden: Value = serde_json::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
        // Both from text, so that a number is what a reader of the file finds.
        let text = found.grade.to_json().to_string();
        let grade: Value = serde_json::from_str(&text).unwrap();
        assert_eq!(numbers_of(&grade), numbers_of(&golden), "{name}");
    }
}

/// A grade shows each metric's definition as it was recorded, beside this program's. No metric is named as redefined,
/// because the corpus has earlier words of the same meaning only. The recording of format 4 keeps the first version of the words.
#[test]
fn a_recording_shows_the_definitions_that_it_carries() {
    let old = "format-4/crown";
    for name in GRADED.into_iter().chain([old]) {
        let recording = open(name);
        let recorded = Rubric::parse(&recording.header().rubric).unwrap();
        let grade = grade::grade(&recording, &grade::Options::default(), &mut |_| {});
        let grade = grade.unwrap().grade;
        let used = grade.rubric.as_ref().unwrap();
        assert_eq!(
            (&used.name, used.version),
            (&recorded.name, recorded.version)
        );
        let present = Rubric::built_in()
            .into_iter()
            .find(|rubric| rubric.name == used.name);
        let former = name == old;
        assert!(!former || present.unwrap().version > used.version, "{name}");
        let golden = std::fs::read_to_string(folder().join(format!("{name}.grade.json")));
        let golden: Value = serde_json::from_str(&golden.unwrap()).unwrap();
        assert!(!grade.metrics.is_empty(), "{name}");
        for (metric, golden) in grade
            .metrics
            .iter()
            .zip(golden["metrics"].as_array().unwrap())
        {
            let text = recorded
                .metrics
                .iter()
                .find(|weighed| weighed.name == metric.name);
            let text = text.and_then(|weighed| weighed.definition.as_deref());
            let shown = metric
                .recorded_definition
                .as_deref()
                .unwrap_or(metric.definition);
            assert_eq!(Some(shown), text, "{name}: {}", metric.name);
            let differs = text != Some(metric.definition);
            assert_eq!(metric.recorded_definition.is_some(), differs);
            assert!(!former || differs, "{name}: {}", metric.name);
            // The golden grade has the words of its time.
            let then = &golden["recorded_definition"];
            let then = then.as_str().or(golden["definition"].as_str());
            assert_eq!(then, text, "{name}: {}", metric.name);
        }
        assert!(used.redefined.is_empty(), "{name}: {:?}", used.redefined);
    }
}

#[test]
fn something_is_touched_in_each_and_by_both_hands_where_there_are_two() {
    for name in NAMES {
        let recording = open(name);
        let rows = rows(&recording);
        for slot in 0..recording.scene().unwrap().tools.len() {
            let pressed = rows
                .iter()
                .filter(|row| row.wrench[slot][..3].iter().any(|f| f.abs() > 0.01));
            assert!(pressed.count() >= 20, "{name}: tool {slot}");
        }
    }
    let scene = open("bimanual").scene().unwrap();
    assert_eq!(scene.tools.len(), 2);
    let has = |kind: fn(&TissueModel) -> bool| scene.objects.iter().any(|o| kind(&o.tissue));
    assert!(
        has(|t| matches!(t, TissueModel::Gingiva(_)))
            && has(|t| matches!(t, TissueModel::Skeleton(_)))
    );
}

#[test]
fn the_commands_are_among_them() {
    let rows = rows(&open("commands"));
    let said = |what: fn(&Row) -> bool| assert!(rows.iter().filter(|row| what(row)).count() > 0);
    said(|row| row.input.paused);
    said(|row| row.input.force_limit_n > 0.0);
    said(|row| row.input.skipped > 0);
    said(|row| row.input.tools[0].stale);
    said(|row| row.status[0] & status::ABSENT != 0);
    said(|row| row.status[0] & status::SATURATED != 0);
}

#[test]
fn the_judge_agrees() {
    for name in ["probing", "retraction", "bimanual", "hard-wedge"] {
        let options = ReplayOptions {
            audit: true,
            ..ReplayOptions::default()
        };
        let audit = replayed(&open(name), &options).audit.unwrap();
        assert!(audit.ticks > 100, "{name}: {audit:?}");
        assert!(audit.unjudged * 20 <= audit.ticks, "{name}: {audit:?}");
        assert!(
            audit.max_pose_error_mm < 1e-2 && audit.max_kkt_residual < 1e-5,
            "{name}: {audit:?}"
        );
    }
}

#[test]
fn what_if_tissue_were_otherwise_can_be_asked_of_them() {
    for (name, choice) in [
        ("probing", TissueChoice::Rigid),
        ("probing", TissueChoice::Printed),
        ("retraction", TissueChoice::Rigid),
        ("retraction", TissueChoice::Printed),
        ("bimanual", TissueChoice::Printed),
    ] {
        let what_if = WhatIf {
            tissue: Some(choice),
            ..WhatIf::default()
        };
        let report = compare(
            &open(name),
            &what_if,
            &ReplayOptions::default(),
            &mut |_| {},
        )
        .unwrap();
        assert!(
            report.comparison && report.recorded_side_identical,
            "{name} {choice:?}: {report:?}"
        );
        assert!(
            report.first_divergent_tick.is_some(),
            "{name} {choice:?}: {report:?}"
        );
        assert!(
            report.apart.max_force_n > 0.01,
            "{name} {choice:?}: {report:?}"
        );
    }
    // A rigid tongue pushes back harder than one that gives way.
    let what_if = WhatIf {
        tissue: Some(TissueChoice::Rigid),
        ..WhatIf::default()
    };
    let report = compare(
        &open("retraction"),
        &what_if,
        &ReplayOptions::default(),
        &mut |_| {},
    )
    .unwrap();
    assert!(
        report.what_if.max_force_n > 1.5 * report.recorded.max_force_n,
        "{report:?}"
    );
}

#[test]
fn bare_spheres_and_coarser_teeth_are_felt() {
    let bytes = open("crown");
    let told = |what_if: WhatIf| {
        compare(&bytes, &what_if, &ReplayOptions::default(), &mut |_| {}).unwrap()
    };
    let bare = told(WhatIf {
        blend: Some(false),
        ..WhatIf::default()
    });
    let coarse = told(WhatIf {
        level: Some(1),
        ..WhatIf::default()
    });
    assert!(bare.apart.rms_tip_mm > 0.0, "{bare:?}");
    assert!(
        coarse.apart.rms_tip_mm > 2.0 * bare.apart.rms_tip_mm,
        "{bare:?} {coarse:?}"
    );
    assert!(bare.what_if.max_residual_um <= 0.5 && coarse.what_if.max_residual_um <= 0.5);
}
