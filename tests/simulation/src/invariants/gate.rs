//! Watchdog of the wrenches at a device: invariants 1, 4 and 18.

use sulcus_core::{MAX_TOOLS, Wrench};

use crate::seen::Pass;

use super::Found;
use super::bounds::{Bounds, GATE_RISE_NS, GATE_SLOPE, LONG_SILENCE_NS, ROUNDING, SILENT_NS};
use super::wrench::{ceiling, is_felt};

/// State of the gate, as far as the observations prove it.
#[derive(Default)]
enum Opening {
    /// Shut, and to be opened in the long rise: before the first wrench, or after a long silence.
    #[default]
    Shut,
    /// On its long rise since the arrival of a wrench, nanoseconds.
    Since(u64),
    /// Open, or in a state that the observations do not prove.
    Other,
}

/// Arrivals and silence at a device.
#[derive(Default)]
pub(super) struct Gate {
    opening: Opening,
    /// Arrival of the newest wrench of all connections, nanoseconds.
    arrived_ns: Option<u64>,
    /// Number of passes in a row with a silence above [`SILENT_NS`].
    silent_passes: u64,
}

impl Gate {
    /// Judges the displayed wrenches of a pass. `before`: displayed wrenches of the pass before.
    pub(super) fn pass(
        &mut self,
        bounds: &Bounds,
        at_ns: u64,
        before: &[Wrench; MAX_TOOLS],
        pass: &Pass,
        found: &mut Found,
    ) {
        let felt = pass.displayed.iter().any(is_felt);
        if let Some(newest) = pass.newest {
            let before_ns = self.arrived_ns.unwrap_or(newest.arrived_ns);
            if self.arrived_ns.is_none() || newest.arrived_ns > before_ns {
                self.arrived_ns = Some(newest.arrived_ns);
                if matches!(self.opening, Opening::Shut) {
                    self.opening = Opening::Since(newest.arrived_ns);
                } else if newest.arrived_ns - before_ns > SILENT_NS {
                    // A short interruption between two passes, behind which the rise takes 100 ms.
                    self.opening = Opening::Other;
                }
            }
        }
        let Some(arrived_ns) = self.arrived_ns else {
            found.must(!felt, 1, || {
                format!(
                    "before the first wrench the hands feel {:?}",
                    pass.displayed
                )
            });
            return;
        };
        let silence_ns = at_ns.saturating_sub(arrived_ns);
        let is_silent = silence_ns > SILENT_NS;
        self.silent_passes = if is_silent { self.silent_passes + 1 } else { 0 };
        let is_shut = self.silent_passes > bounds.shut_passes;
        found.must(!is_shut || !felt, 4, || {
            let passes = self.silent_passes;
            format!(
                "{silence_ns} ns behind the newest wrench, pass {passes} of the silence: {:?}",
                pass.displayed
            )
        });
        if is_shut && silence_ns > LONG_SILENCE_NS + bounds.facts.tick_ns {
            self.opening = Opening::Shut;
        } else if is_silent {
            // A gate that falls during its rise may rise again in 100 ms.
            self.opening = Opening::Other;
        }
        if let Opening::Since(since_ns) = self.opening {
            self.rise(bounds, at_ns.saturating_sub(since_ns), before, pass, found);
        }
    }

    /// Judges a pass of the long rise, `open_ns` behind its first wrench. Two periods are spare.
    fn rise(
        &mut self,
        bounds: &Bounds,
        open_ns: u64,
        before: &[Wrench; MAX_TOOLS],
        pass: &Pass,
        found: &mut Found,
    ) {
        if open_ns >= GATE_RISE_NS {
            self.opening = Opening::Other;
            return;
        }
        let course = (open_ns + 2 * bounds.facts.tick_ns) as f64 / GATE_RISE_NS as f64;
        let open = (GATE_SLOPE * course).min(1.0);
        for (hand, (before, now)) in before.iter().zip(&pass.displayed).enumerate() {
            let limit = ceiling(
                before.force,
                open * bounds.facts.max_force_n,
                bounds.force_step_n,
            );
            // Damping of the passivity controller comes behind the gate.
            found.must(pass.braked || now.force.norm() <= limit + ROUNDING, 18, || {
                let force = now.force.norm();
                format!("hand {hand} feels {force} N, {open_ns} ns behind the first wrench; at most {limit} N")
            });
            let limit = ceiling(
                before.torque,
                open * bounds.facts.max_torque_nm,
                bounds.torque_step_nm,
            );
            found.must(pass.braked || now.torque.norm() <= limit + ROUNDING, 18, || {
                let torque = now.torque.norm();
                format!("hand {hand} feels {torque} N m, {open_ns} ns behind the first wrench; at most {limit} N m")
            });
        }
    }
}
