//! Comparison of a recorded session with the same session in a changed scene. Both run the same inputs, tick by tick.
//!
//! The motion of the hand is the recorded one and does not answer to changed forces. So a comparison shows the effect
//! of another solver, tissue or level on the same motion. It does not show how a student would behave in that scene.

mod side;

use serde::Serialize;
use sulcus_core::{MAX_TOOLS, TickOutput};

use super::error::ReplayError;
use super::report::ReplayOptions;
use super::run::{REPORT_EVERY, recorded as recorded_state};
use super::span::Part;
use super::whatif::{WhatIf, WhatIfError};
use crate::record::format::Migration;
use crate::record::gap::Gap;
use crate::record::message::Message;
use crate::record::read::{Ending, ReadError, Recording};
use crate::record::signature::Signature;
use crate::record::verify::Verifier;

pub use side::Side;

use side::Running;

/// Differences between the two sides.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Apart {
    /// Largest difference of a tool's force, newtons.
    pub max_force_n: f64,
    /// Root mean square of the force difference over the ticks in which a tool touches on either side, newtons.
    pub rms_force_n: f64,
    /// Tick of the largest force difference.
    pub max_force_tick: Option<u64>,
    /// Largest difference of a tool's torque, newton metres.
    pub max_torque_nm: f64,
    /// Largest distance between the tips of a graphic tool, millimetres.
    pub max_tip_mm: f64,
    /// Root mean square of the distance over the ticks in which a tool touches on either side, millimetres.
    pub rms_tip_mm: f64,
}

/// Result of a comparison.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ComparisonReport {
    /// Always true: a comparison is no replay.
    pub comparison: bool,
    /// Always false, also for two equal scenes.
    pub identical: bool,
    /// Changes of the scene, as text.
    pub changed: Vec<String>,
    /// Ticks run.
    pub ticks: u64,
    /// First tick whose state differs from the recorded state.
    pub first_divergent_tick: Option<u64>,
    /// Whether the recorded side gave all recorded hashes. Otherwise the change is not the only difference.
    pub recorded_side_identical: bool,
    /// Migration of a recording of a former version, whose recorded side may give other hashes.
    pub migration: Option<Migration>,
    /// Simulated time divided by the time of the changed side's ticks.
    pub realtime_factor: f64,
    /// Differences within the requested part.
    pub apart: Apart,
    /// Side of the recorded scene.
    pub recorded: Side,
    /// Side of the changed scene.
    pub what_if: Side,
    /// Part that was run; `None` for the whole session.
    pub part: Option<Part>,
    /// Tick of the snapshot from which the changed side starts. Changes of geometry or tissue start from the
    /// recording's first snapshot ([`WhatIf::keeps_states`]), other changes from that of the part.
    pub what_if_snapshot_tick: u64,
    /// Result of the recording's signatures.
    pub signature: Signature,
    /// Ending of the recording's file.
    pub ending: Ending,
}

impl ComparisonReport {
    /// Whether the recording has a fault. A difference between the sides is no fault.
    pub fn is_finding(&self) -> bool {
        !(self.recorded_side_identical || self.migration.is_some())
            || matches!(self.signature, Signature::Invalid { .. })
            || matches!(self.ending, Ending::Damaged { .. })
    }
}

/// Reason why nothing was compared.
#[derive(Debug, thiserror::Error)]
pub enum CompareError {
    /// The recording cannot be replayed.
    #[error(transparent)]
    Replay(#[from] ReplayError),
    /// The scene cannot be changed.
    #[error(transparent)]
    WhatIf(#[from] WhatIfError),
}

impl From<ReadError> for CompareError {
    fn from(error: ReadError) -> Self {
        Self::Replay(error.into())
    }
}

/// Runs the recorded inputs in the recorded scene and in the changed scene. No later snapshot resets a side. The
/// recorded side starts from the last snapshot before the part. The changed side starts from the same snapshot if that
/// state is valid for it, otherwise from the session's first snapshot. Both are compared from the part's snapshot on.
///
/// # Errors
/// The errors of [`crate::replay()`], or the scene cannot be changed.
pub fn compare(
    recording: &Recording,
    what_if: &WhatIf,
    options: &ReplayOptions,
    progress: &mut dyn FnMut(u64),
) -> Result<ComparisonReport, CompareError> {
    let scene = recording.scene()?;
    let part = options.span.part(recording, scene.tick_s())?;
    let (other_scene, changed) = what_if.applied_to(&scene)?;
    let from_part = what_if.keeps_states();
    if let Some(gap) = gap_within(recording, &part, from_part) {
        return Err(ReplayError::Gap(gap.clone()).into());
    }
    let mut verifier = Verifier::new(recording);
    let (mut recorded, mut other) = (Running::new(&scene), Running::new(&other_scene));
    let mut report = ComparisonReport {
        comparison: true,
        identical: false,
        changed,
        ticks: 0,
        first_divergent_tick: None,
        recorded_side_identical: true,
        migration: recording.migration(),
        realtime_factor: 0.0,
        apart: Apart::default(),
        recorded: Side::default(),
        what_if: Side::default(),
        part: (!options.span.is_all()).then_some(part),
        what_if_snapshot_tick: part.snapshot_tick,
        signature: Signature::Unsigned {
            fingerprint: String::new(),
            last_valid_tick: None,
        },
        ending: recording.ending().clone(),
    };
    let mut sums = Sums::default();
    let (mut ran, mut simulated_ticks) = (0, 0_u64);
    let (mut started, mut other_started) = (false, false);
    for message in recording.messages() {
        let message = message?;
        verifier.message(&message);
        match &message {
            Message::Snapshot { tick, state } => {
                let begins = !started && part.looks_at(*tick);
                let other_begins = !other_started && (begins || !from_part);
                if !(begins || other_begins) {
                    continue;
                }
                let state = recorded_state(&scene, *tick, state).map_err(ReplayError::Snapshot)?;
                if other_begins {
                    other.begin_like(&state);
                    other_started = true;
                    report.what_if_snapshot_tick = *tick;
                }
                if begins {
                    recorded.begin_with(state);
                    started = true;
                }
            }
            Message::Row(row)
                if part.runs(row.tick) || (!from_part && row.tick <= part.to_tick) =>
            {
                // Between the snapshot and the part only the recorded hashes are compared.
                let counts = part.contains(row.tick);
                let theirs = other.tick(&what_if.input(&row.input), counts);
                ran += 1;
                simulated_ticks += 1 + u64::from(row.input.skipped);
                if ran % REPORT_EVERY == 0 {
                    progress(ran);
                }
                if !part.runs(row.tick) {
                    continue;
                }
                let ours = recorded.tick(&row.input, counts);
                report.ticks += 1;
                report.recorded_side_identical &= ours.hash == row.hash;
                if theirs.hash != row.hash {
                    report.first_divergent_tick.get_or_insert(row.tick);
                }
                if counts {
                    sums.add(&scene, row.tick, &ours, &theirs, &mut report.apart);
                }
            }
            _ => {}
        }
    }
    progress(ran);
    sums.finish(&mut report.apart);
    let simulated_s = simulated_ticks as f64 * scene.tick_s();
    report.realtime_factor = simulated_s / other.seconds().max(1e-9);
    (report.recorded, report.what_if) = (recorded.side(), other.side());
    report.signature = verifier.finish(options.trust.as_ref()).signature;
    Ok(report)
}

/// First gap between the start of the comparison and the end of the part.
fn gap_within<'a>(recording: &'a Recording, part: &Part, from_part: bool) -> Option<&'a Gap> {
    recording.gaps().iter().find(|gap| {
        let ends_before = gap.to_tick.is_some_and(|to| to <= part.snapshot_tick);
        let begins_behind = gap.from_tick.is_some_and(|from| from > part.to_tick);
        !(begins_behind || from_part && ends_before)
    })
}

/// Sums of squares over the contacts of a tool in a tick, on either side.
#[derive(Default)]
struct Sums {
    contacts: u64,
    force: f64,
    tip: f64,
}

impl Sums {
    fn add(
        &mut self,
        scene: &sulcus_core::Scene,
        tick: u64,
        ours: &TickOutput,
        theirs: &TickOutput,
        apart: &mut Apart,
    ) {
        for t in 0..scene.tools.len().min(MAX_TOOLS) {
            let (a, b) = (&ours.tools[t], &theirs.tools[t]);
            let force = (a.wrench.force - b.wrench.force).norm();
            let torque = (a.wrench.torque - b.wrench.torque).norm();
            let tip = &scene.tools[t].tip;
            let off = (a.graphic.transform(tip) - b.graphic.transform(tip)).norm() * 1e3;
            if force > apart.max_force_n {
                apart.max_force_n = force;
                apart.max_force_tick = Some(tick);
            }
            apart.max_torque_nm = apart.max_torque_nm.max(torque);
            apart.max_tip_mm = apart.max_tip_mm.max(off);
            if a.active > 0 || b.active > 0 {
                self.contacts += 1;
                self.force += force * force;
                self.tip += off * off;
            }
        }
    }

    fn finish(&self, apart: &mut Apart) {
        let n = self.contacts.max(1) as f64;
        apart.rms_force_n = (self.force / n).sqrt();
        apart.rms_tip_mm = (self.tip / n).sqrt();
    }
}
