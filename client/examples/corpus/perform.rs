//! Performances of an entry: the first finds the part with the most changes of contact, the second records it.

use std::path::Path;

use sulcus_core::{NoProbe, Scene, State, TickInput, TickOutput, Workspace, tick};
use sulcus_demo::calls::calls;
use sulcus_demo::lockstep::as_sent;
use sulcus_operator::{Operator, Shown};
use sulcus_sessions::grade::Rubric;
use sulcus_sessions::{Level, Recorder, Row, SessionEnd, SessionHeader, StationKey};

use crate::entries::Entry;

/// Start of every session in the corpus, nanoseconds since 1970: 1 January 2026, 00:00 UTC.
const BEGAN_UNIX_NS: u64 = 1_767_225_600_000_000_000;
/// Seed of the key that signs the corpus. No station has this key.
const KEY: [u8; 32] = *b"sulcus corpus: nobody's station.";

/// Part of a performance that is recorded.
pub struct Window {
    /// Number of ticks before the part. The part begins with the snapshot after them.
    pub from: u64,
    /// Last tick of the part.
    pub to: u64,
    /// Number of tool-ticks in contact.
    pub contact: usize,
    /// Number of times that a tool's contact began or ended.
    pub changes: usize,
}

/// State of a performance, tick by tick.
struct Performance<'a> {
    entry: &'a Entry,
    scene: &'a Scene,
    operator: Operator,
    state: State,
    workspace: Workspace,
    shown: Shown,
    done: u64,
}

impl<'a> Performance<'a> {
    fn new(entry: &'a Entry, scene: &'a Scene) -> anyhow::Result<Self> {
        Ok(Self {
            entry,
            scene,
            operator: entry.operator(scene)?,
            state: State::new(scene),
            workspace: Workspace::new(scene),
            shown: Shown::NOTHING,
            done: 0,
        })
    }

    fn step(&mut self) -> (TickInput, TickOutput) {
        let mut input = TickInput::IDLE;
        input.tools = self.operator.step(&self.shown);
        self.entry.disturb(self.done, &mut input);
        let (state, ws) = (&mut self.state, &mut self.workspace);
        let output = tick(self.scene, state, ws, &input, &mut NoProbe);
        self.shown = as_sent(&output);
        self.done += 1;
        (input, output)
    }
}

/// Performs the whole entry. Returns the loaded tools of each tick, one bit per tool; the last tool has bit 0.
///
/// # Errors
/// The operator of the entry cannot be made.
pub fn look(entry: &Entry, scene: &Scene) -> anyhow::Result<Vec<u8>> {
    let mut performance = Performance::new(entry, scene)?;
    let ticks = performance.operator.ticks();
    Ok((0..ticks)
        .map(|_| {
            let (_, output) = performance.step();
            let bears = output.tools.iter().map(|tool| u8::from(tool.active > 0));
            bears.fold(0, |bits, bit| bits << 1 | bit)
        })
        .collect())
}

/// Window of at most `length` ticks with the most changes of contact; the first of equal windows.
///
/// Only windows with at least half as much contact as the window with the most contact are considered. `touched` is the
/// result of [`look`].
pub fn window(touched: &[u8], length: u64) -> Window {
    let length = (length as usize).min(touched.len());
    let contact_in = |from: usize| -> usize {
        let bits = touched[from..from + length].iter();
        bits.map(|bits| bits.count_ones() as usize).sum()
    };
    // Successive windows overlap by nine tenths.
    let starts = (0..=touched.len() - length).step_by((length / 10).max(1));
    let starts: Vec<usize> = starts.collect();
    let most = starts
        .iter()
        .map(|from| contact_in(*from))
        .max()
        .unwrap_or_default();
    let changes_in = |from: usize| -> usize {
        let pairs = touched[from..from + length].windows(2);
        pairs
            .map(|pair| (pair[0] ^ pair[1]).count_ones() as usize)
            .sum()
    };
    let busy = starts
        .into_iter()
        .filter(|from| 2 * contact_in(*from) >= most);
    // `max_by_key` returns the last of equal windows. In reverse order this is the first.
    let best = busy
        .rev()
        .max_by_key(|from| changes_in(*from))
        .unwrap_or_default();
    Window {
        from: best as u64,
        to: (best + length) as u64,
        contact: contact_in(best),
        changes: changes_in(best),
    }
}

/// Performs the entry again and records `window` to `path`, with a snapshot at the start and in the middle.
///
/// # Errors
/// The operator cannot be made, or the recording cannot be written.
pub fn record(entry: &Entry, scene: &Scene, window: &Window, path: &Path) -> anyhow::Result<()> {
    let mut performance = Performance::new(entry, scene)?;
    for _ in 0..window.from {
        performance.step();
    }
    // Calls before the window are not recorded.
    drop(calls(&mut performance.operator));
    let mut header = SessionHeader::new(scene.to_bytes()?);
    header.exercise_name = entry.exercise.into();
    let exercise = entry.definition()?;
    header.exercise = exercise.definition(1)?;
    let rubric = Rubric::of(&exercise).map(|rubric| rubric.definition());
    header.rubric = rubric.transpose()?.unwrap_or_default();
    header.seed = 1;
    header.station = "corpus".into();
    header.started_unix_ns = BEGAN_UNIX_NS;
    let time = |tick: u64| BEGAN_UNIX_NS + tick * scene.params.tick_ns();
    let mut recorder = Recorder::create(path, &header, StationKey::from_seed(KEY))?;
    let state = &performance.state;
    let begins = time(state.tick);
    recorder.snapshot(begins, state.tick, &state.to_bytes())?;
    let said = format!(
        "ticks {} to {} of a performance of `{}`",
        window.from, window.to, entry.exercise
    );
    recorder.event(begins, Level::Info, &said)?;
    let length = window.to - window.from;
    for k in 1..=length {
        let (input, output) = performance.step();
        let now = time(output.tick);
        recorder.push(&Row::new(now, &input, &output))?;
        for call in calls(&mut performance.operator) {
            recorder.event(now, Level::Info, &call.at(output.tick).to_string())?;
        }
        if k == length / 2 {
            recorder.snapshot(now, output.tick, &performance.state.to_bytes())?;
        }
    }
    recorder.finish(SessionEnd {
        ticks: length,
        ..SessionEnd::default()
    })?;
    Ok(())
}
