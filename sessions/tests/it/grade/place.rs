//! Sessions to be graded, and a folder in which the program is run.

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;
use sulcus_core::scene::Band;
use sulcus_core::{NoProbe, State, Workspace, tick};
use sulcus_sessions::grade::{Grade, Options, grade};
use sulcus_sessions::{
    Exercise, Level, Mode, Recorder, Recording, Row, Rubric, SessionEnd, SessionHeader, StationKey,
};

use crate::common::{BEGAN, input, key};

/// A session of the crown exercise in which a rod sweeps over balls for `ticks` ticks.
pub fn record(path: &Path, ticks: u64, key: StationKey, dropped_rows: u64) {
    record_with(path, ticks, key, dropped_rows, |_, _| {});
}

/// The same with another header, and with whatever stands in its log.
pub fn record_with(
    path: &Path,
    ticks: u64,
    key: StationKey,
    dropped_rows: u64,
    change: impl Fn(&mut SessionHeader, &mut Vec<String>),
) {
    let recorder = begun(path, 0..ticks, ticks, key, change);
    let end = SessionEnd {
        ticks,
        dropped_rows,
        ..SessionEnd::default()
    };
    recorder.finish(end).unwrap();
}

/// A part of a session of `whole` ticks, without an end: the hand performs `part` of them.
pub fn begun(
    path: &Path,
    part: std::ops::Range<u64>,
    whole: u64,
    key: StationKey,
    change: impl Fn(&mut SessionHeader, &mut Vec<String>),
) -> Recorder {
    let mut scene = crate::common::scene();
    scene.tools[0].bands = vec![Band {
        from: 0.0,
        to: 1e-3,
        dark: true,
    }];
    let mut exercise = Exercise::built_in().remove(0);
    exercise.duration_s = whole as f64 * 1e-3;
    let mut log = Vec::new();
    let mut header = SessionHeader {
        exercise_name: "crown".into(),
        exercise: exercise.definition(1).unwrap(),
        rubric: Rubric::of(&exercise).unwrap().definition().unwrap(),
        learner_id: "a7f3".into(),
        station: "<b>7</b>".into(),
        started_unix_ns: BEGAN,
        // As before it was said.
        mode: None,
        ..SessionHeader::new(scene.to_bytes().unwrap())
    };
    change(&mut header, &mut log);
    let mut recorder = Recorder::create(path, &header, key).unwrap();
    let (mut state, mut shapes) = (State::new(&scene), Workspace::new(&scene));
    recorder.snapshot(BEGAN, 0, &state.to_bytes()).unwrap();
    for k in part {
        let input = input(k);
        let output = tick(&scene, &mut state, &mut shapes, &input, &mut NoProbe);
        let now = BEGAN + (k + 1) * 1_000_000;
        recorder.push(&Row::new(now, &input, &output)).unwrap();
    }
    for line in log {
        recorder.event(BEGAN, Level::Info, &line).unwrap();
    }
    recorder
}

/// An instructor's word.
pub const REVISE: [&str; 8] = [
    "--revise",
    "81",
    "--by",
    "t04",
    "--at",
    "2026-11-24",
    "--reason",
    "seen",
];

pub struct Place(pub tempfile::TempDir);

impl Place {
    pub fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn session(&self) -> PathBuf {
        let path = self.path("session.mcap");
        record(&path, 3000, key(), 0);
        path
    }

    /// Exit code, standard output, standard error.
    pub fn run(&self, args: &[&str]) -> (i32, String, String) {
        let output = Command::new(env!("CARGO_BIN_EXE_sulcus-sessions"))
            .args(args)
            .current_dir(self.0.path())
            .env("XDG_STATE_HOME", self.0.path())
            .output()
            .unwrap();
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        let code = output.status.code().unwrap();
        (code, text(output.stdout), text(output.stderr))
    }

    pub fn recorded_as(&self, name: &str, mode: Mode) -> PathBuf {
        let path = self.path(name);
        record_with(&path, 3000, key(), 0, |header, _| {
            header.mode = Some(mode);
            header.learner_id = format!("{mode}-1");
        });
        path
    }

    /// What it says where something is wrong with what was asked for.
    pub fn told(&self, args: &[&str]) -> String {
        let (code, out, said) = self.run(args);
        assert_eq!(code, 2, "{out}{said}");
        said
    }

    pub fn json(&self, args: &[&str]) -> Value {
        let (code, out, said) = self.run(args);
        assert_eq!(code, 0, "{said}");
        serde_json::from_str(out.lines().last().unwrap()).unwrap()
    }
}

pub fn of(bytes: Vec<u8>, options: &Options) -> Grade {
    let recording = Recording::from_bytes(bytes).unwrap();
    grade(&recording, options, &mut |_| {}).unwrap().grade
}

pub fn plain(bytes: Vec<u8>) -> Grade {
    of(bytes, &Options::default())
}
