//! Couplings of a session: recorded, signed, and part of every replay.
#![allow(clippy::unwrap_used)]

use std::path::Path;

use sulcus_core::{Coupling, NoProbe, Scene, State, TickInput, Workspace, tick};
use sulcus_sessions::{
    Recorder, Recording, ReplayOptions, ReplayReport, Row, SessionEnd, SessionHeader, Signature,
    info, replay,
};

use crate::common::program::*;
use crate::common::*;

/// Coupling of a device that displays less than the scene's 500 N/m. Neither number is exact in JSON's fast parser.
const SOFT: Coupling = Coupling {
    n_per_m: 214.350_000_000_000_02,
    nm_per_rad: 0.1 + 0.2,
};

/// Records `ticks` ticks on the scene `runs`, with `couplings` in the header.
fn recorded_on(runs: &Scene, couplings: &[Coupling], ticks: u64) -> Vec<u8> {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("session.mcap");
    let header = SessionHeader {
        couplings: couplings.to_vec(),
        ..header(&scene())
    };
    let mut recorder = Recorder::create(&path, &header, key()).unwrap();
    let (mut state, mut workspace) = (State::new(runs), Workspace::new(runs));
    recorder.snapshot(BEGAN, 0, &state.to_bytes()).unwrap();
    for k in 0..ticks {
        let input: TickInput = input(k);
        let output = tick(runs, &mut state, &mut workspace, &input, &mut NoProbe);
        let now = BEGAN + output.tick * 1_000_000;
        recorder.push(&Row::new(now, &input, &output)).unwrap();
    }
    let end = SessionEnd {
        ticks,
        ..SessionEnd::default()
    };
    recorder.finish(end).unwrap();
    std::fs::read(path).unwrap()
}

fn soft_scene() -> Scene {
    scene().with_couplings(&[SOFT]).unwrap()
}

fn replayed(bytes: &[u8]) -> ReplayReport {
    let recording = Recording::from_bytes(bytes.to_vec()).unwrap();
    replay(&recording, &ReplayOptions::default(), &mut |_| {}).unwrap()
}

fn with_metadata(bytes: &[u8], value: Option<&str>) -> Vec<u8> {
    let edit = &mut Edit {
        message: &mut |_, _| true,
        metadata: &mut |pairs| {
            pairs.remove("couplings").expect("it is there");
            pairs.extend(value.map(|value| ("couplings".to_owned(), value.to_owned())));
        },
        attachment: &mut |_, _| {},
    };
    rewritten(bytes, edit)
}

#[test]
fn a_session_with_a_softer_coupling_replays_bit_for_bit() {
    let bytes = recorded_on(&soft_scene(), &[SOFT], 2000);
    let recording = Recording::from_bytes(bytes.clone()).unwrap();
    assert_eq!(recording.format(), 7);
    assert_eq!(recording.header().couplings, [SOFT]);
    assert_eq!(recording.scene().unwrap(), soft_scene());
    // The compiled scene and its hash are those of the file.
    let compiled = scene().to_bytes().unwrap();
    assert_eq!(recording.header().scene, compiled);
    assert_eq!(
        recording.header().scene_hash(),
        *blake3::hash(&compiled).as_bytes()
    );
    let report = replayed(&bytes);
    assert!(
        report.identical && report.gradable && !report.is_finding(),
        "{report:?}"
    );
}

#[test]
fn the_same_rows_without_the_coupling_diverge() {
    let softer = recorded_on(&soft_scene(), &[], 2000);
    let report = replayed(&softer);
    assert!(!report.identical && !report.gradable, "{report:?}");
    assert!(report.first_divergent_tick.is_some());
    // The other way round: a coupling in the header that was not in force.
    let report = replayed(&recorded_on(&scene(), &[SOFT], 2000));
    assert!(!report.identical && !report.gradable, "{report:?}");
    assert!(replayed(&recorded_on(&scene(), &[], 2000)).identical);
}

#[test]
fn an_edited_coupling_breaks_the_signature() {
    let bytes = recorded_on(&soft_scene(), &[SOFT], 500);
    let written = r#"[{"n_per_m":"214.35000000000002","nm_per_rad":"0.30000000000000004"}]"#;
    let mut same = None;
    rewritten(
        &bytes,
        &mut Edit {
            message: &mut |_, _| true,
            metadata: &mut |pairs| same = pairs.get("couplings").cloned(),
            attachment: &mut |_, _| {},
        },
    );
    assert_eq!(same.as_deref(), Some(written));
    let other = r#"[{"n_per_m":"300","nm_per_rad":"0.3"}]"#;
    for value in [None, Some(other), Some(&written.replace("02\"", "020\""))] {
        let report = replayed(&with_metadata(&bytes, value));
        assert!(
            matches!(report.signature, Signature::Invalid { .. }),
            "{value:?}"
        );
        assert!(!report.gradable, "{value:?}");
    }
    for bad in ["[]x", r#"[{"n_per_m":"0","nm_per_rad":"0.3"}]"#] {
        let error = Recording::from_bytes(with_metadata(&bytes, Some(bad))).unwrap_err();
        assert!(error.to_string().contains("coupling"), "{error}");
    }
    // The scene has one tool.
    let two = format!("[{0},{0}]", r#"{"n_per_m":"300","nm_per_rad":"0.3"}"#);
    let recording = Recording::from_bytes(with_metadata(&bytes, Some(&two))).unwrap();
    let error = recording.scene().unwrap_err().to_string();
    assert!(error.contains("number of couplings is 2"), "{error}");
}

#[test]
fn info_and_export_use_the_coupling() {
    let dir = tempfile::tempdir().unwrap();
    let (path, out) = (dir.path().join("a.mcap"), dir.path().join("out"));
    std::fs::write(&path, recorded_on(&soft_scene(), &[SOFT], 300)).unwrap();
    let told = info(&path, &Recording::open(&path).unwrap()).unwrap();
    assert_eq!(told.couplings, [SOFT]);
    let line = "  coupling   tool 0: 214.35000000000002 N/m and 0.30000000000000004 N m/rad in force instead of the scene's\n";
    assert!(told.to_string().contains(line), "{told}");
    let output = run(&["info", text_of(&path), "--json"]);
    assert_eq!(code(&output), 0);
    let told = json_of(&output)["couplings"][0]["nm_per_rad"].as_f64();
    assert!((told.unwrap() - SOFT.nm_per_rad).abs() < 1e-12);
    // An export replays the recording, and tells if the replay differs.
    let output = run(&["export", text_of(&path), "--out", text_of(&out)]);
    assert_eq!((code(&output), err(&output).as_str()), (0, ""));
    let plain = info(
        Path::new("x.mcap"),
        &Recording::from_bytes(recorded_on(&scene(), &[], 50)).unwrap(),
    );
    let plain = plain.unwrap();
    assert!(plain.couplings.is_empty() && !plain.to_string().contains("  coupling"));
}
