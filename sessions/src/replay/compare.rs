//! A recorded session beside itself in a changed scene: the same inputs, both run tick by tick.
//!
//! The hand does what it did: it does not answer to forces that it never felt. So this shows what another solver, tissue or
//! level says about the same motion, and not what a student would have done with it.

mod side;

use std::time::Instant;

use serde::Serialize;
use sulcus_core::{MAX_TOOLS, TickOutput};

use crate::record::format::Migration;
use crate::record::gap::Gap;
use crate::record::message::Message;
use crate::record::read::{Ending, Recording};
use crate::record::verify::{Signature, Verifier};
use crate::replay::whatif::{WhatIf, WhatIfError};
use crate::replay::{Part, REPORT_EVERY, ReplayError, ReplayOptions};

pub use side::Side;

use side::Running;

/// How far the two are apart.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Apart {
    /// Largest difference of a tool's force, newtons.
    pub max_force_n: f64,
    /// Root mean square of it over a tool's ticks in which it touches on either side.
    pub rms_force_n: f64,
    /// The tick of the largest.
    pub max_force_tick: Option<u64>,
    /// Largest difference of a tool's torque, newton metres.
    pub max_torque_nm: f64,
    /// Largest distance between the tips of a graphic tool, millimetres.
    pub max_tip_mm: f64,
    /// Root mean square of it over a tool's ticks in which it touches on either side.
    pub rms_tip_mm: f64,
}

/// What a comparison found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ComparisonReport {
    /// Always true: this is no replay.
    pub comparison: bool,
    /// Always false: two scenes are compared, whether they differ or not.
    pub identical: bool,
    /// What was changed, in words.
    pub changed: Vec<String>,
    /// Ticks run.
    pub ticks: u64,
    /// First tick whose state was another than the recorded one.
    pub first_divergent_tick: Option<u64>,
    /// Whether the unchanged side gave the recorded hashes throughout: else the difference is not the change's alone.
    pub recorded_side_identical: bool,
    /// Where the recording is of a former version of the format, so that the unchanged side need not give the recorded hashes.
    pub migration: Option<Migration>,
    /// Simulated time over the time that the changed side's ticks took.
    pub realtime_factor: f64,
    /// How far the two are apart, within the part that was asked for.
    pub apart: Apart,
    /// As recorded.
    pub recorded: Side,
    /// As changed.
    pub what_if: Side,
    /// The part that was run, where not all was asked for.
    pub part: Option<Part>,
    /// Tick of the snapshot that the changed side began with: the recording's first where the change is one of geometry or tissue
    /// ([`WhatIf::keeps_states`]), otherwise the part's own.
    pub what_if_snapshot_tick: u64,
    /// What the signatures say of the recording.
    pub signature: Signature,
    /// How the recording ends.
    pub ending: Ending,
}

impl ComparisonReport {
    /// Whether something is wrong with what it rests on: that the sides differ is no finding.
    pub fn is_finding(&self) -> bool {
        !(self.recorded_side_identical || self.migration.is_some())
            || matches!(self.signature, Signature::Invalid { .. })
            || matches!(self.ending, Ending::Damaged { .. })
    }
}

/// Why nothing could be compared.
#[derive(Debug, thiserror::Error)]
pub enum CompareError {
    /// The recording cannot be replayed.
    #[error(transparent)]
    Replay(#[from] ReplayError),
    /// The scene cannot be changed so.
    #[error(transparent)]
    WhatIf(#[from] WhatIfError),
}

impl From<crate::record::read::ReadError> for CompareError {
    fn from(error: crate::record::read::ReadError) -> Self {
        Self::Replay(error.into())
    }
}

/// Runs the recorded inputs in the recorded scene and in the changed one; neither is led back to a snapshot later. The recorded side begins
/// with the last snapshot before the part, and so does the changed one where that is a state of its own; otherwise it comes to the part
/// from the session's beginning. They are compared from the part's snapshot on.
///
/// # Errors
/// As [`crate::replay()`], or when the scene cannot be changed so.
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
                let state = crate::replay::recorded_state(&scene, *tick, state)
                    .map_err(ReplayError::Snapshot)?;
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
                // On the way from the snapshot to the part only what must be the same is looked at.
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

/// The first gap between what the comparison begins with and the end of the part.
fn gap_within<'a>(recording: &'a Recording, part: &Part, from_part: bool) -> Option<&'a Gap> {
    recording.gaps().iter().find(|gap| {
        let ends_before = gap.to_tick.is_some_and(|to| to <= part.snapshot_tick);
        let begins_behind = gap.from_tick.is_some_and(|from| from > part.to_tick);
        !(begins_behind || from_part && ends_before)
    })
}

/// Sums of squares over the contacts: of a tool, in a tick, on either side.
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

/// Wall time of one call, seconds.
fn timed<T>(f: impl FnOnce() -> T) -> (T, f64) {
    let began = Instant::now();
    let value = f();
    (value, began.elapsed().as_secs_f64())
}
