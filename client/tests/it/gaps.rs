//! A session with a gap of the connection has the grade of the same session without the gap.
//!
//! The same hand performs the same script twice in virtual time: once uncut, and once with a gap in the middle of a
//! reading. In the gap the hand holds still, and the station goes on without it.
#![allow(clippy::unwrap_used)]

use std::path::{Path, PathBuf};
use std::sync::Arc;

use sulcus_connection::progress::Steps;
use sulcus_core::{NoProbe, State, TickInput, Workspace, tick};
use sulcus_demo::calls::calls;
use sulcus_demo::exercise::{self, Asked, Prepared};
use sulcus_demo::lockstep::as_sent;
use sulcus_operator::Shown;
use sulcus_sessions::grade::{Grade, Options, grade_session};
use sulcus_sessions::{
    Detached, Events, Occurrence, PlanFacts, Predecessor, RecordedTick, Recorder, Recording,
    ReplayOptions, Row, SessionEnd, SessionHeader, SessionWriter, StationKey, replay_observed,
};

/// Session clock at the first tick, nanoseconds since the Unix epoch.
const BEGAN: u64 = 1_790_000_000_000_000_000;

/// Kind of a gap.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Cut {
    /// The student is detached half a second after the last pose, and attached again.
    Detached,
    /// Poses stop, and the connection stays.
    Stale,
    /// The station's program is killed, and another recording goes on.
    Killed,
}

/// Gap before a period of the hand.
#[derive(Clone, Copy, Debug)]
struct Gap {
    before: u64,
    ticks: u64,
    cut: Cut,
}

fn prepared(name: &str, seed: u64) -> Prepared {
    let asked = Asked {
        hand_seed: seed,
        ..Asked::of(name)
    };
    let mut prepared = exercise::prepare(&asked, &Steps).unwrap();
    // The ramp behind a gap lasts half a second.
    let scene = Arc::make_mut(&mut prepared.scene);
    scene.params.ramp_up_ms = 500;
    prepared.scene_bytes = Arc::new(scene.to_bytes().unwrap());
    prepared
}

/// A recording that is written in virtual time.
struct Station {
    writer: SessionWriter,
    path: PathBuf,
    events: Events,
    state: State,
    shapes: Workspace,
    tick: u64,
}

impl Station {
    fn begin(prepared: &Prepared, path: &Path, header: &SessionHeader) -> Self {
        let scene = &prepared.scene;
        let state = State::new(scene);
        let key = StationKey::from_seed([7; 32]);
        let recorder = Recorder::create(path, header, key).unwrap();
        let writer = SessionWriter::begin(recorder, scene, BEGAN, &state.to_bytes(), None);
        Self {
            writer: writer.unwrap(),
            path: path.to_owned(),
            events: Events::new(scene, &prepared.exercise),
            state,
            shapes: Workspace::new(scene),
            tick: 0,
        }
    }

    /// Runs a tick with its lines of the log; what the hand is shown.
    fn run(&mut self, prepared: &Prepared, input: &TickInput, said: Vec<Occurrence>) -> Shown {
        let scene = &prepared.scene;
        let output = tick(
            scene,
            &mut self.state,
            &mut self.shapes,
            input,
            &mut NoProbe,
        );
        self.tick = output.tick;
        let now = BEGAN + output.tick * scene.params.tick_ns();
        let row = Row::new(now, input, &output);
        let tick = RecordedTick {
            row: &row,
            output: &output,
            cpu_ns: 0,
            shapes: None,
        };
        let found = self.events.observe(scene, &output, &self.shapes);
        let all = found.chain(said);
        self.writer.tick(scene, &tick, all).unwrap();
        as_sent(&output)
    }

    fn finish(self, ticks: u64) -> PathBuf {
        let end = SessionEnd {
            ticks,
            ..SessionEnd::default()
        };
        self.writer.finish(end).unwrap();
        self.path
    }
}

/// Performs an exercise, perhaps with a gap. Paths of the recordings, and the periods of the hand in which its probe has
/// been on a floor for 0.3 s.
fn perform(
    prepared: &mut Prepared,
    gap: Option<Gap>,
    clock_runs: bool,
    folder: &Path,
) -> (Vec<PathBuf>, Vec<u64>) {
    let mut header = SessionHeader::new(prepared.scene_bytes.as_ref().clone());
    header.exercise_name = prepared.exercise.name.clone();
    header.exercise = prepared.definition(1).unwrap();
    header.patient.clone_from(&prepared.patient);
    header.rubric = prepared.rubric().unwrap();
    header.started_unix_ns = BEGAN;
    header.plan = Some(PlanFacts {
        name: "a".into(),
        revision: "1".into(),
        resume_within_s: 30.0,
        clock_runs_in_gaps: clock_runs,
        changed: None,
    });
    let mut station = Station::begin(prepared, &folder.join("1.mcap"), &header);
    let (mut paths, mut reading) = (Vec::new(), Vec::new());
    let (mut shown, mut last) = (Shown::NOTHING, TickInput::IDLE);
    let (mut ticks, mut on_floor) = (0, 0);
    for k in 1..=prepared.ticks {
        if prepared.until_done && prepared.operator.is_done() {
            break;
        }
        let mut said = Vec::new();
        if let Some(gap) = gap.filter(|gap| gap.before == k) {
            if gap.cut == Cut::Killed {
                // Without an end, as a kill leaves it.
                let Station {
                    mut writer, path, ..
                } = station;
                writer.flush().unwrap();
                drop(writer);
                header.predecessor = Some(Predecessor::of(&path).unwrap());
                paths.push(path);
                station = Station::begin(prepared, &folder.join("2.mcap"), &header);
                ticks = 0;
            }
            for g in 0..gap.ticks {
                let mut input = last;
                for tool in input.tools.iter_mut().filter(|tool| tool.present) {
                    tool.age_ticks = u16::try_from(g).unwrap_or(u16::MAX);
                    tool.stale = g >= 50;
                }
                let gone = match gap.cut {
                    Cut::Detached => g >= 500,
                    Cut::Stale => false,
                    Cut::Killed => true,
                };
                if gone {
                    input = TickInput::IDLE;
                }
                let first = gap.cut == Cut::Detached && g == 500;
                let detached = Occurrence::detached(station.tick + 1, Detached::ConnectionLost);
                shown = station.run(
                    prepared,
                    &input,
                    first.then_some(detached).into_iter().collect(),
                );
                ticks += 1;
            }
            if gap.cut == Cut::Detached {
                let back = Occurrence::attached(station.tick + 1, 2, gap.ticks - 500);
                said.push(back);
            }
        }
        let mut input = TickInput::IDLE;
        input.tools = prepared.operator.step(&shown);
        last = input;
        let called = calls(&mut prepared.operator);
        said.extend(called.iter().map(|call| call.at(station.tick + 1)));
        shown = station.run(prepared, &input, said);
        ticks += 1;
        let force = station
            .events
            .standing(prepared_probe(prepared))
            .map_or(0.0, |at| at.force);
        on_floor = if force >= 0.1 { on_floor + 1 } else { 0 };
        if on_floor == 300 {
            reading.push(k);
        }
    }
    paths.push(station.finish(ticks));
    (paths, reading)
}

/// Slot of the probe.
fn prepared_probe(prepared: &Prepared) -> usize {
    let tools = &prepared.scene.tools;
    tools
        .iter()
        .position(|tool| !tool.bands.is_empty())
        .unwrap()
}

/// Grade of a session, each of whose recordings replays bit for bit.
fn graded(paths: &[PathBuf]) -> Grade {
    let parts: Vec<_> = paths
        .iter()
        .map(|path| Recording::open(path).unwrap())
        .collect();
    for part in &parts {
        let ignore = &mut |_: &_, _: &_, _: &_, _: &_| {};
        let report = replay_observed(part, &ReplayOptions::default(), &mut |_| {}, ignore);
        assert!(report.unwrap().identical);
    }
    let (last, before) = parts.split_last().unwrap();
    let before: Vec<&Recording> = before.iter().collect();
    let graded = grade_session(last, &before, &Options::default(), &mut |_| {});
    let grade = graded.unwrap().grade;
    assert!(grade.gradable, "{:?}", grade.reason);
    grade
}

/// Differences of the measures of two sessions beyond the tremor of a hand.
fn differences(cut: &Grade, whole: &Grade) -> Vec<String> {
    let mut found = Vec::new();
    for (ours, theirs) in cut.metrics.iter().zip(&whole.metrics) {
        let (a, b) = (ours.score.unwrap_or(-1.0), theirs.score.unwrap_or(-1.0));
        if (a - b).abs() > 5.0 {
            found.push(format!(
                "{}: {:?} ({a}), uncut {:?} ({b})",
                ours.name, ours.value, theirs.value
            ));
        }
    }
    for (ours, theirs) in cut.sites.iter().zip(&whole.sites) {
        let same = (ours.called_mm, ours.finding, ours.bled, ours.probed)
            == (theirs.called_mm, theirs.finding, theirs.bled, theirs.probed);
        let depth = ours.measured_mm.zip(theirs.measured_mm);
        let near = depth.is_none_or(|(a, b)| (a - b).abs() <= 0.1);
        if !(same && near) {
            found.push(format!("{ours:?}, uncut {theirs:?}"));
        }
    }
    found
}

/// Asserts that gaps in the middle of the session's reading change no measure.
fn gaps_do_not_punish(name: &str, seed: u64, gaps: &[(u64, Cut)]) {
    let folder = tempfile::tempdir().unwrap();
    let (paths, readings) = perform(&mut prepared(name, seed), None, false, folder.path());
    let whole = graded(&paths);
    assert!(whole.gaps.is_none() && readings.len() >= 2, "{readings:?}");
    for (k, (ticks, cut)) in gaps.iter().enumerate() {
        let folder = tempfile::tempdir().unwrap();
        let before = readings[(k + 1) % readings.len()];
        let gap = Gap {
            before,
            ticks: *ticks,
            cut: *cut,
        };
        let (paths, _) = perform(&mut prepared(name, seed), Some(gap), false, folder.path());
        let cut = graded(&paths);
        let seconds = cut.gaps.unwrap().seconds;
        let expected = *ticks as f64 * 1e-3;
        assert!(
            (expected - 0.2..expected + 2.1).contains(&seconds),
            "{seconds} {gap:?}"
        );
        let lost = whole.score.unwrap() - cut.score.unwrap();
        let found = differences(&cut, &whole);
        assert!(
            lost.abs() <= 1.0 && found.is_empty(),
            "{gap:?}: {lost} points\n{found:#?}"
        );
        for harm in ["trauma", "damage"] {
            let of = |grade: &Grade| {
                grade
                    .metrics
                    .iter()
                    .find(|m| m.name.contains(harm))
                    .and_then(|m| m.value)
            };
            assert_eq!(of(&cut), of(&whole), "{gap:?}");
        }
    }
}

#[test]
fn a_probing_that_is_cut_in_a_reading_has_the_grade_of_the_uncut_one() {
    let gaps = [
        (1000, Cut::Stale),
        (1000, Cut::Detached),
        (5000, Cut::Detached),
        (20_000, Cut::Detached),
        (2000, Cut::Killed),
    ];
    gaps_do_not_punish("probing", 1, &gaps);
}

#[test]
fn both_hands_that_are_cut_in_a_reading_have_the_grade_of_the_uncut_ones() {
    gaps_do_not_punish("bimanual", 1, &[(5000, Cut::Detached), (2000, Cut::Killed)]);
}

/// The clock of an exam may run in a gap: the working time has the gap, and nothing else changes.
#[test]
fn a_clock_that_runs_counts_the_gap_as_time_only() {
    let folder = tempfile::tempdir().unwrap();
    let (paths, readings) = perform(&mut prepared("probing", 1), None, true, folder.path());
    let whole = graded(&paths);
    let folder = tempfile::tempdir().unwrap();
    let gap = Gap {
        before: readings[1],
        ticks: 5000,
        cut: Cut::Detached,
    };
    let (paths, _) = perform(&mut prepared("probing", 1), Some(gap), true, folder.path());
    let cut = graded(&paths);
    assert!(cut.gaps.unwrap().clock_ran);
    let time = |grade: &Grade| grade.metric("time").unwrap().value.unwrap();
    let longer = time(&cut) - time(&whole);
    assert!((4.5..6.5).contains(&longer), "{longer}");
    let found = differences(&cut, &whole);
    assert!(
        found.iter().all(|said| said.starts_with("time")),
        "{found:#?}"
    );
}
