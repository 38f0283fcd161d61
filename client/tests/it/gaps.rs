//! A session with a gap of the connection has the grade of the same session without the gap.
//!
//! A simulated hand performs a script in virtual time. The same motion is then run once more with a gap in the middle
//! of a reading. In the gap the hand holds still, and the station goes on without it. A hand that feels the ramp behind
//! the gap may move a little otherwise, so its score alone is compared.
#![allow(clippy::unwrap_used)]

use std::path::{Path, PathBuf};
use std::sync::Arc;

use sulcus_connection::progress::Steps;
use sulcus_core::{NoProbe, State, TickInput, Workspace, tick};
use sulcus_demo::calls::calls;
use sulcus_demo::exercise::{self, Asked, Prepared};
use sulcus_demo::lockstep::as_sent;
use sulcus_operator::Shown;
use sulcus_sessions::exercise::events::call::Call;
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

/// Motion of a hand: input and calls of each of its periods.
struct Motion {
    periods: Vec<(TickInput, Vec<Call>)>,
    /// Periods in which the probe has been on a floor for 0.3 s.
    readings: Vec<u64>,
    /// Periods in which the probe has been in the air for 0.3 s.
    free: Vec<u64>,
}

/// Hand that gives the inputs.
enum Hand<'a> {
    /// The operator, who feels the wrenches.
    Feels(&'a mut Prepared),
    /// A motion, run once more.
    Moves(&'a Prepared, &'a Motion),
}

impl Hand<'_> {
    fn prepared(&self) -> &Prepared {
        match self {
            Self::Feels(prepared) => prepared,
            Self::Moves(prepared, _) => prepared,
        }
    }

    /// Input and calls of period `k`, from 1; `None` behind the last one.
    fn period(&mut self, k: u64, shown: &Shown) -> Option<(TickInput, Vec<Call>)> {
        match self {
            Self::Feels(prepared) => {
                if k > prepared.ticks || (prepared.until_done && prepared.operator.is_done()) {
                    return None;
                }
                let mut input = TickInput::IDLE;
                input.tools = prepared.operator.step(shown);
                Some((input, calls(&mut prepared.operator)))
            }
            Self::Moves(_, motion) => motion.periods.get(k as usize - 1).cloned(),
        }
    }
}

/// Performs a session, perhaps with a gap. Paths of its recordings, and the motion of the hand.
fn perform(
    mut hand: Hand<'_>,
    gap: Option<Gap>,
    clock_runs: bool,
    folder: &Path,
) -> (Vec<PathBuf>, Motion) {
    let prepared = hand.prepared();
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
    let slot = probe(prepared);
    let mut station = Station::begin(prepared, &folder.join("1.mcap"), &header);
    let (mut shown, mut last) = (Shown::NOTHING, TickInput::IDLE);
    let (mut paths, mut ticks, mut on_floor, mut in_air) = (Vec::new(), 0, 0, 0);
    let mut motion = Motion {
        periods: Vec::new(),
        readings: Vec::new(),
        free: Vec::new(),
    };
    for k in 1.. {
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
                station = Station::begin(hand.prepared(), &folder.join("2.mcap"), &header);
                ticks = 0;
            }
            for g in 0..gap.ticks {
                let gone = match gap.cut {
                    Cut::Detached => g >= 500,
                    Cut::Stale => false,
                    Cut::Killed => true,
                };
                let input = if gone {
                    TickInput::IDLE
                } else {
                    aged(&last, g)
                };
                let first = gap.cut == Cut::Detached && g == 500;
                let detached = Occurrence::detached(station.tick + 1, Detached::ConnectionLost);
                let said = first.then_some(detached).into_iter().collect();
                shown = station.run(hand.prepared(), &input, said);
                ticks += 1;
            }
            if gap.cut == Cut::Detached {
                said.push(Occurrence::attached(station.tick + 1, 2, gap.ticks - 500));
            }
        }
        let Some((input, called)) = hand.period(k, &shown) else {
            break;
        };
        last = input;
        said.extend(called.iter().map(|call| call.at(station.tick + 1)));
        shown = station.run(hand.prepared(), &input, said);
        ticks += 1;
        motion.periods.push((input, called));
        let standing = station.events.standing(slot);
        let force = standing.map_or(0.0, |at| at.force);
        on_floor = if force >= 0.1 { on_floor + 1 } else { 0 };
        in_air = if standing.is_none() { in_air + 1 } else { 0 };
        motion.readings.extend((on_floor == 300).then_some(k));
        motion.free.extend((in_air == 300).then_some(k));
    }
    paths.push(station.finish(ticks));
    (paths, motion)
}

/// The last input, `age` ticks later, without a newer pose.
fn aged(last: &TickInput, age: u64) -> TickInput {
    let mut input = *last;
    for tool in input.tools.iter_mut().filter(|tool| tool.present) {
        tool.age_ticks = u16::try_from(age).unwrap_or(u16::MAX);
        tool.stale = age >= 50;
    }
    input
}

/// Slot of the probe.
fn probe(prepared: &Prepared) -> usize {
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

/// Differences of the measures of two sessions with the same motion.
fn differences(cut: &Grade, whole: &Grade) -> Vec<String> {
    let mut found = Vec::new();
    for (ours, theirs) in cut.metrics.iter().zip(&whole.metrics) {
        let (a, b) = (ours.score.unwrap_or(-1.0), theirs.score.unwrap_or(-1.0));
        if (a - b).abs() > 2.0 {
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
        let near = depth.is_none_or(|(a, b)| (a - b).abs() <= 0.05);
        if !(same && near) {
            found.push(format!("{ours:?}, uncut {theirs:?}"));
        }
    }
    found
}

/// Uncut session of an exercise, with its motion.
fn uncut(name: &str, clock_runs: bool) -> (Grade, Motion) {
    let folder = tempfile::tempdir().unwrap();
    let mut prepared = prepared(name, 1);
    let hand = Hand::Feels(&mut prepared);
    let (paths, motion) = perform(hand, None, clock_runs, folder.path());
    let grade = graded(&paths);
    assert!(grade.gaps.is_none());
    (grade, motion)
}

/// Grade of the motion with a gap.
fn with_gap(name: &str, motion: &Motion, gap: Gap, clock_runs: bool) -> Grade {
    let folder = tempfile::tempdir().unwrap();
    let prepared = prepared(name, 1);
    let hand = Hand::Moves(&prepared, motion);
    let (paths, _) = perform(hand, Some(gap), clock_runs, folder.path());
    let grade = graded(&paths);
    let (seconds, gone) = (grade.gaps.unwrap().seconds, gap.ticks as f64 * 1e-3);
    assert!(
        (gone - 0.2..gone + 2.1).contains(&seconds),
        "{seconds} {gap:?}"
    );
    grade
}

/// Asserts that gaps change no measure.
fn gaps_do_not_punish(name: &str, gaps: &[(u64, Cut)]) {
    let (whole, motion) = uncut(name, false);
    assert!(motion.readings.len() >= 2, "{:?}", motion.readings);
    let mut failed = Vec::new();
    for (k, (ticks, cut)) in gaps.iter().enumerate() {
        let before = match cut {
            // A tool that begins outside of everything cannot be put into a pocket.
            Cut::Killed => *motion.free.last().unwrap(),
            _ => motion.readings[(k + 1) % motion.readings.len()],
        };
        let gap = Gap {
            before,
            ticks: *ticks,
            cut: *cut,
        };
        let cut = with_gap(name, &motion, gap, false);
        let lost = whole.score.unwrap() - cut.score.unwrap();
        let found = differences(&cut, &whole);
        if lost.abs() > 1.0 || !found.is_empty() {
            failed.push(format!("{gap:?}: {lost} points\n{found:#?}"));
        }
    }
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}

#[test]
fn a_probing_that_is_cut_in_a_reading_has_the_grade_of_the_uncut_one() {
    gaps_do_not_punish("probing", &[(1000, Cut::Stale), (5000, Cut::Detached)]);
}

mod long {
    use sulcus_support::long;

    use super::{Cut, gaps_do_not_punish};

    #[test]
    fn gaps_of_every_length_and_kind_have_the_grade_of_the_uncut_session() {
        if !long::selected("gaps-of-every-length") {
            return;
        }
        let gaps = [
            (1000, Cut::Detached),
            (20_000, Cut::Detached),
            (2000, Cut::Killed),
        ];
        gaps_do_not_punish("probing", &gaps);
        gaps_do_not_punish("bimanual", &[(5000, Cut::Detached)]);
    }
}

/// A hand without a force for half a second behind the gap presses deeper, and nothing of it counts.
#[test]
fn a_hand_that_feels_the_ramp_behind_the_gap_keeps_its_score() {
    let (whole, motion) = uncut("probing", false);
    let folder = tempfile::tempdir().unwrap();
    let gap = Gap {
        before: motion.readings[1],
        ticks: 5000,
        cut: Cut::Detached,
    };
    let mut prepared = prepared("probing", 1);
    let hand = Hand::Feels(&mut prepared);
    let (paths, _) = perform(hand, Some(gap), false, folder.path());
    let cut = graded(&paths);
    let lost = whole.score.unwrap() - cut.score.unwrap();
    assert!(
        lost.abs() <= 1.0,
        "{lost}: {:#?}",
        differences(&cut, &whole)
    );
}

/// The clock of an exam may run in a gap: the working time has the gap, and nothing else changes.
#[test]
fn a_clock_that_runs_counts_the_gap_as_time_only() {
    let (whole, motion) = uncut("probing", true);
    let gap = Gap {
        before: motion.readings[1],
        ticks: 5000,
        cut: Cut::Detached,
    };
    let cut = with_gap("probing", &motion, gap, true);
    assert!(cut.gaps.unwrap().clock_ran);
    let time = |grade: &Grade| grade.metric("time").map(|metric| metric.value.unwrap());
    if let Some((cut, whole)) = time(&cut).zip(time(&whole)) {
        assert!((4.5..6.5).contains(&(cut - whole)), "{cut} {whole}");
    }
    let found = differences(&cut, &whole);
    let others = found.iter().filter(|said| !said.starts_with("time:"));
    assert_eq!(others.count(), 0, "{found:#?}");
}
