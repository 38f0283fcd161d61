//! Replay of a recorded session, bit for bit.

pub mod audit;
mod close;
pub mod compare;
mod deviation;
mod error;
mod gradable;
mod report;
mod run;
mod span;
mod stretch;
pub mod viewers;
pub mod whatif;

use std::time::Instant;

use sulcus_core::{Scene, TickInput, TickOutput, Workspace};

use crate::record::message::Message;
use crate::record::program::Program;
use crate::record::read::Recording;
use crate::record::verify::Verifier;

pub use close::{CLOSE, Close};
pub use deviation::Deviation;
pub use error::ReplayError;
pub use gradable::why_not_continued;
pub use report::{Difference, Divergence, ReplayOptions, ReplayReport};
pub use span::{Part, Span};
pub use stretch::Stretch;

use run::{REPORT_EVERY, Run};
use stretch::Gaps;

/// Runs the recorded inputs from the first snapshot, or from the last snapshot before the requested part, and compares
/// everything. `progress` gets the number of finished ticks from time to time.
///
/// # Errors
/// The recording, its scene or its starting snapshot is invalid, or the requested part is not in the recording.
pub fn replay(
    recording: &Recording,
    options: &ReplayOptions,
    progress: &mut dyn FnMut(u64),
) -> Result<ReplayReport, ReplayError> {
    replay_observed(recording, options, progress, &mut |_, _, _, _| {})
}

/// Replay with `observe`, which gets every tick, for measurements.
///
/// # Errors
/// The errors of [`replay`].
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
        // A signature covers the whole chain, so all messages are checked, whatever the part.
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
            "no row follows a snapshot in the recovered recording".to_owned(),
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
