//! Silence of a device under a pause and on an old pose: invariants 2 and 16 at the hand.

use crate::seen::Pass;

use super::Found;
use super::bounds::{Bounds, POSE_OLD_NS};
use super::memory::Kept;
use super::wrench::is_felt;

/// Numbers of passes in a row under a condition that forbids force.
#[derive(Default)]
pub(super) struct Quiet {
    paused: u64,
    aged: u64,
}

impl Quiet {
    /// Judges the displayed wrenches of a pass. `behind`: tick of the newest wrench, if known.
    ///
    /// A device obeys a pause through the wrenches alone. The pause therefore counts from the tick on that sends no
    /// force; the silence of a lost datagram is the gate's. The passivity controller has no exception from a pause.
    pub(super) fn pass(
        &mut self,
        bounds: &Bounds,
        at_ns: u64,
        behind: Option<&Kept>,
        pass: &Pass,
        found: &mut Found,
    ) {
        let felt = pass.displayed.iter().any(is_felt);
        let names_pause = pass.newest.is_some_and(|newest| newest.paused);
        let is_paused =
            names_pause && behind.is_some_and(|tick| tick.paused_ticks > bounds.quiet_ticks);
        self.paused = if is_paused { self.paused + 1 } else { 0 };
        found.must(!felt || self.paused <= bounds.slew_passes, 2, || {
            format!(
                "the newest datagram names a pause, pass {}: {:?}",
                self.paused, pass.displayed
            )
        });
        let age_ns = behind
            .and_then(|tick| tick.used)
            .map(|used| at_ns.saturating_sub(used.measured_ns));
        let is_aged = age_ns.is_some_and(|age_ns| age_ns > POSE_OLD_NS);
        self.aged = if is_aged { self.aged + 1 } else { 0 };
        found.must(!felt || self.aged <= bounds.aged_passes, 16, || {
            format!(
                "the pose behind the newest wrench is {age_ns:?} ns old, pass {}: {:?}",
                self.aged, pass.displayed
            )
        });
    }
}
