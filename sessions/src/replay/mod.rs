//! Running a recorded session again, bit for bit.

pub mod audit;
pub mod compare;
mod deviation;
mod gradable;
mod run;
mod span;
mod stretch;
pub mod whatif;

use std::time::Instant;

use serde::Serialize;
use sulcus_core::{Scene, TickInput, TickOutput, Workspace};

use crate::record::format::{CLOSE, Migration};
use crate::record::key::PublicKey;
use crate::record::message::Message;
use crate::record::program::Program;
use crate::record::read::{Ending, ReadError, Recording};
use crate::record::verify::{Signature, Verifier};
use crate::record::viewers::Viewers;
use crate::replay::audit::AuditReport;

pub use deviation::Deviation;
pub use span::{Part, Span};
pub use stretch::Stretch;

use run::Run;
pub(crate) use run::recorded as recorded_state;
use stretch::Gaps;

/// How to replay.
#[derive(Clone, Copy, Debug, Default)]
pub struct ReplayOptions {
    /// Let the judge solve every tick's problem again.
    pub audit: bool,
    /// The only key whose signature is accepted; `None`: the one that the recording names.
    pub trust: Option<PublicKey>,
    /// Which part of the session; all of it unless said otherwise.
    pub span: Span,
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
    /// How far the replay was from the record; zero throughout when identical.
    pub deviation: Deviation,
    /// Where the recording is of a former version of the format: a replay of it differs, and a grade may rest on it as long as it stays
    /// close ([`crate::record::format::CLOSE`]).
    pub migration: Option<Migration>,
    /// Simulated time over the time that the replay took.
    pub realtime_factor: f64,
    /// The part that was run, where not all was asked for.
    pub part: Option<Part>,
    /// Where the recording has gaps, the stretches between them; otherwise empty.
    pub stretches: Vec<Stretch>,
    /// The program that recorded.
    pub recorded_by: Program,
    /// The program that replayed: this one.
    pub replayed_by: Program,
    /// What the signatures say.
    pub signature: Signature,
    /// Whether the key was given from outside, rather than taken from the recording.
    pub signer_trusted: bool,
    /// Whether every recorded head of the chain is the one that the messages before it give.
    pub chain_ok: bool,
    /// What viewers read of the file.
    pub viewers: Viewers,
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
    /// is not the whole session). Where only a part was asked for, that part is not graded, and need not be.
    pub fn is_finding(&self) -> bool {
        (!self.gradable && self.part.is_none())
            || !(self.identical || self.is_close())
            || !self.chain_ok
            || matches!(self.signature, Signature::Invalid { .. })
            || matches!(self.ending, Ending::Damaged { .. })
            || self.viewers == Viewers::Changed
    }

    /// What is wrong with the file itself, whatever part of it was run: a signature that does not hold, or an end that is not its
    /// own. What is shown or exported of such a file is to say so.
    pub fn unsound(&self) -> Option<String> {
        if let Signature::Invalid { .. } = &self.signature {
            return Some(format!("signature {}", self.signature));
        }
        if !self.chain_ok {
            return Some("its messages are not those that were signed".to_owned());
        }
        (self.ending != Ending::Finished).then(|| self.ending.to_string())
    }

    /// Whether the recording is of a former version, and the replay as close to it as that explains.
    pub fn is_close(&self) -> bool {
        self.migration.is_some() && CLOSE.holds(&self.deviation)
    }
}

/// Why nothing could be replayed.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// The recording cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The state to begin with is not one of the scene.
    #[error("recording's snapshot to begin with cannot be used: {0}")]
    Snapshot(String),
    /// Two scenes cannot be compared over a gap.
    #[error(
        "recording has a gap ({0}): compare a part of it before or behind the gap, by --from and --to"
    )]
    Gap(crate::record::gap::Gap),
    /// The part asked for is not in the session.
    #[error("{field} is {found}, expected {expected}")]
    Span {
        /// `from` or `to`.
        field: &'static str,
        /// Value found, seconds.
        found: f64,
        /// What it must be.
        expected: String,
    },
}

/// Ticks between two reports of progress.
pub(crate) const REPORT_EVERY: u64 = 500;

/// Runs recorded inputs again, from the first snapshot or the one before the part asked for, and compares
/// everything; `progress` is told the number of ticks done, now and then.
///
/// # Errors
/// When the recording, its scene or its snapshot to begin with cannot be used, or lacks the part asked for.
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
    let scene = recording.scene()?;
    let part = options.span.part(recording, scene.tick_s())?;
    let mut verifier = Verifier::new(recording);
    let mut run = Run::new(&scene, options.audit, recording.migration().is_none());
    let mut gaps = Gaps::new(recording.gaps());
    let began = Instant::now();
    for message in recording.messages() {
        let message = message?;
        if gaps.before(&message) {
            run.gap();
        }
        // The whole chain, whatever the part: a signature is over all of it.
        verifier.message(&message);
        match &message {
            Message::Row(row) if part.runs(row.tick) => {
                let Some(output) = run.row(row) else {
                    continue;
                };
                observe(&scene, &row.input, &output, run.workspace());
                if run.ticks.is_multiple_of(REPORT_EVERY) {
                    progress(run.ticks);
                }
            }
            Message::Snapshot { tick, state } if part.looks_at(*tick) => {
                run.snapshot(*tick, state)?
            }
            _ => {}
        }
    }
    progress(run.ticks);
    if run.ticks == 0 && !recording.gaps().is_empty() {
        return Err(ReplayError::Snapshot(
            "no row follows one in what was recovered".to_owned(),
        ));
    }
    let stretches = run.stretches(verifier.signed());
    let simulated_s = run.simulated_ticks as f64 * scene.tick_s();
    let realtime_factor = simulated_s / began.elapsed().as_secs_f64().max(1e-9);
    let verdict = verifier.finish(options.trust.as_ref());
    let deviation = run.deviation();
    let mut report = ReplayReport {
        ticks: run.ticks,
        identical: run.first.is_none(),
        first_divergent_tick: run.first.as_ref().map(|first| first.0),
        divergence: run.first.map(|(_, divergence)| divergence),
        max_force_deviation_n: deviation.max_force_n,
        deviation,
        migration: recording.migration(),
        realtime_factor,
        part: (!options.span.is_all()).then_some(part),
        stretches: if recording.gaps().is_empty() {
            Vec::new()
        } else {
            stretches
        },
        recorded_by: Program::of(recording.header()),
        replayed_by: Program::this(),
        viewers: recording.viewers_by(&verdict.signature),
        signature: verdict.signature,
        signer_trusted: options.trust.is_some_and(|key| key == recording.signer()),
        chain_ok: verdict.chain_ok,
        ending: recording.ending().clone(),
        gradable: false,
        reason: None,
        audit: run.audit,
    };
    report.reason = gradable::why_not(recording, &report);
    report.gradable = report.reason.is_none();
    Ok(report)
}
