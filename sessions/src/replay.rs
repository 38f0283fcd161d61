//! Running a recorded session again, bit for bit.

use std::time::Instant;

use serde::Serialize;
use sulcus_core::optimise::SolverKind;
use sulcus_core::{NoProbe, Scene, State, TickInput, TickOutput, Workspace, tick};

use crate::audit::{AuditReport, audit_tick};
use crate::key::PublicKey;
use crate::message::Message;
use crate::read::{Ending, ReadError, Recording};
use crate::row::Row;
use crate::verify::{Signature, Verifier};

/// How to replay.
#[derive(Clone, Copy, Debug, Default)]
pub struct ReplayOptions {
    /// Another solver than the scene's: then bits differ, and the forces' deviation is what counts.
    pub solver: Option<SolverKind>,
    /// Let the judge solve every tick's problem again.
    pub audit: bool,
    /// The only key whose signature is accepted; `None`: the one that the recording names.
    pub trust: Option<PublicKey>,
}

/// What differed first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Difference {
    /// The replay came to another tick: rows are missing.
    Tick,
    /// The state's hash (so the input, the state or the program).
    Hash,
    /// The wrench or status in the row, though the state is the same.
    Output,
    /// The recorded snapshot is not the state that the replay came to.
    Snapshot,
}

/// Where and how far a replay differs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Divergence {
    /// What differed first.
    pub what: Difference,
    /// Recorded state hash of that tick, hexadecimal.
    pub hash_recorded: String,
    /// State hash that the replay gave, hexadecimal.
    pub hash_replayed: String,
    /// Ticks that differ. After a snapshot the replay goes on from the recorded state.
    pub ticks: u64,
}

/// What a replay found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ReplayReport {
    /// Ticks run.
    pub ticks: u64,
    /// Whether every tick gave the recorded hash, wrench and status, and every snapshot the state.
    pub identical: bool,
    /// The first tick that did not.
    pub first_divergent_tick: Option<u64>,
    /// More about it.
    pub divergence: Option<Divergence>,
    /// Largest difference between recorded and replayed force over all ticks, newtons.
    pub max_force_deviation_n: f64,
    /// Simulated time over the time that the replay took.
    pub realtime_factor: f64,
    /// What the signatures say.
    pub signature: Signature,
    /// Whether the key was given from outside, rather than taken from the recording.
    pub signer_trusted: bool,
    /// Whether every recorded head of the chain is the one that the messages before it give.
    pub chain_ok: bool,
    /// How the recording ends.
    pub ending: Ending,
    /// Whether a grade may rest on it.
    pub gradable: bool,
    /// Why not.
    pub reason: Option<String>,
    /// The judge's findings, when asked for.
    pub audit: Option<AuditReport>,
}

impl ReplayReport {
    /// Whether there is something to say but "all is well": it differs, a signature does not hold, bytes
    /// are damaged, or it cannot be graded (a recording that was cut off is sound as far as it goes, and
    /// is not the whole session).
    pub fn is_finding(&self) -> bool {
        !self.gradable
            || !self.identical
            || !self.chain_ok
            || matches!(self.signature, Signature::Invalid { .. })
            || matches!(self.ending, Ending::Damaged { .. })
    }
}

/// Why nothing could be replayed.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// The recording cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The state to begin with is not one of the scene.
    #[error("recording's first snapshot cannot be used: {0}")]
    Snapshot(String),
}

/// Ticks between two reports of progress.
const REPORT_EVERY: u64 = 500;

/// Runs all recorded inputs again from the first snapshot and compares everything; `progress` is
/// told the number of ticks done, now and then.
///
/// # Errors
/// When the recording, its scene or its first snapshot cannot be used.
pub fn replay(
    recording: &Recording,
    options: &ReplayOptions,
    progress: &mut dyn FnMut(u64),
) -> Result<ReplayReport, ReplayError> {
    replay_observed(recording, options, progress, &mut |_, _, _, _| {})
}

/// As [`replay`], and `observe` sees every tick as it is run again: what measures a session.
///
/// # Errors
/// As [`replay`].
pub fn replay_observed(
    recording: &Recording,
    options: &ReplayOptions,
    progress: &mut dyn FnMut(u64),
    observe: &mut dyn FnMut(&Scene, &TickInput, &TickOutput, &Workspace),
) -> Result<ReplayReport, ReplayError> {
    let mut scene = recording.scene()?;
    scene.params.solver = options.solver.unwrap_or(scene.params.solver);
    let mut verifier = Verifier::new(recording);
    let mut run = Run::new(&scene, options);
    let began = Instant::now();
    for message in recording.messages() {
        let message = message?;
        verifier.message(&message);
        match &message {
            Message::Row(row) => {
                let output = run.row(row);
                observe(&scene, &row.input, &output, &run.workspace);
            }
            Message::Snapshot { tick, state } => run.snapshot(*tick, state)?,
            Message::Signed(_) | Message::Event(_) => {}
        }
        if run.ticks.is_multiple_of(REPORT_EVERY) {
            progress(run.ticks);
        }
    }
    progress(run.ticks);
    let simulated_s = run.simulated_ticks as f64 * scene.tick_s();
    let realtime_factor = simulated_s / began.elapsed().as_secs_f64().max(1e-9);
    let verdict = verifier.finish(options.trust.as_ref());
    let mut report = ReplayReport {
        ticks: run.ticks,
        identical: run.first.is_none(),
        first_divergent_tick: run.first.as_ref().map(|first| first.0),
        divergence: run.first.map(|(_, divergence)| divergence),
        max_force_deviation_n: run.max_force_deviation_n,
        realtime_factor,
        signature: verdict.signature,
        signer_trusted: options.trust.is_some(),
        chain_ok: verdict.chain_ok,
        ending: recording.ending().clone(),
        gradable: false,
        reason: None,
        audit: run.audit,
    };
    report.reason = why_not_gradable(recording, options, &report);
    report.gradable = report.reason.is_none();
    Ok(report)
}

fn why_not_gradable(
    recording: &Recording,
    options: &ReplayOptions,
    report: &ReplayReport,
) -> Option<String> {
    if let Some(tick) = report.first_divergent_tick {
        return Some(if options.solver.is_some() {
            format!("replayed with another solver, which differs from tick {tick}")
        } else {
            format!("the replay differs from tick {tick}")
        });
    }
    let end = match (&report.signature, recording.facts().end) {
        (Signature::Valid { .. }, Some(end)) => end,
        (Signature::Invalid { reason, .. }, _) => return Some(reason.clone()),
        _ => return Some(format!("the recording is {}", report.ending)),
    };
    if end.dropped_rows > 0 {
        return Some(format!(
            "{} rows were dropped while recording",
            end.dropped_rows
        ));
    }
    (end.ticks != report.ticks).then(|| {
        format!(
            "the session ran {} ticks, the recording has {}",
            end.ticks, report.ticks
        )
    })
}

/// A replay under way.
struct Run<'a> {
    scene: &'a Scene,
    workspace: Workspace,
    state: State,
    started: bool,
    /// A different solver goes its own way; it is not led back at snapshots.
    free: bool,
    ticks: u64,
    simulated_ticks: u64,
    first: Option<(u64, Divergence)>,
    max_force_deviation_n: f64,
    audit: Option<AuditReport>,
}

impl<'a> Run<'a> {
    fn new(scene: &'a Scene, options: &ReplayOptions) -> Self {
        Self {
            scene,
            workspace: Workspace::new(scene),
            state: State::new(scene),
            started: false,
            free: options.solver.is_some(),
            ticks: 0,
            simulated_ticks: 0,
            first: None,
            max_force_deviation_n: 0.0,
            audit: options.audit.then(AuditReport::default),
        }
    }

    fn row(&mut self, row: &Row) -> TickOutput {
        let output = tick(
            self.scene,
            &mut self.state,
            &mut self.workspace,
            &row.input,
            &mut NoProbe,
        );
        self.ticks += 1;
        self.simulated_ticks += 1 + u64::from(row.input.skipped);
        let again = Row::new(row.time_unix_ns, &row.input, &output);
        for (a, b) in row.wrench.iter().zip(&again.wrench) {
            let square = |k: usize| (f64::from(a[k]) - f64::from(b[k])).powi(2);
            let deviation = (square(0) + square(1) + square(2)).sqrt();
            // A row may claim anything; what is no number is as far off as can be said.
            let deviation = if deviation.is_finite() {
                deviation
            } else {
                f64::MAX
            };
            self.max_force_deviation_n = self.max_force_deviation_n.max(deviation);
        }
        let what = if again.tick != row.tick {
            Some(Difference::Tick)
        } else if again.hash != row.hash {
            Some(Difference::Hash)
        } else if again.to_bytes() != row.to_bytes() {
            Some(Difference::Output)
        } else {
            None
        };
        if let Some(what) = what {
            self.differs(row.tick, what, row.hash, again.hash);
        }
        if let Some(audit) = &mut self.audit
            && let Some(found) = audit_tick(self.scene, &self.workspace)
        {
            audit.add(row.tick, &found);
        }
        output
    }

    fn snapshot(&mut self, of: u64, bytes: &[u8]) -> Result<(), ReplayError> {
        if self.started && self.state.to_bytes() == bytes {
            return Ok(());
        }
        let recorded = State::from_bytes(self.scene, bytes)
            .map_err(|error| error.to_string())
            .and_then(|state| match state.tick {
                tick if tick == of => Ok(state),
                tick => Err(format!("it says tick {of}, and holds tick {tick}")),
            });
        match recorded {
            Ok(state) if !self.started => {
                self.state = state;
                self.started = true;
            }
            Err(what) if !self.started => return Err(ReplayError::Snapshot(what)),
            recorded => {
                let hash = recorded.as_ref().map_or(0, |state| state.hash);
                // Where the rows differed before, the snapshot adds nothing.
                if self.first.is_none() {
                    self.differs(of, Difference::Snapshot, hash, self.state.hash);
                }
                if let (Ok(state), false) = (recorded, self.free) {
                    self.state = state;
                }
            }
        }
        Ok(())
    }

    fn differs(&mut self, tick: u64, what: Difference, recorded: u64, replayed: u64) {
        let (_, divergence) = self.first.get_or_insert_with(|| {
            let divergence = Divergence {
                what,
                hash_recorded: format!("{recorded:016x}"),
                hash_replayed: format!("{replayed:016x}"),
                ticks: 0,
            };
            (tick, divergence)
        });
        divergence.ticks += 1;
    }
}
