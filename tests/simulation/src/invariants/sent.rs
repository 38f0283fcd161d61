//! Wrenches that the ticks send: limits, slew, numbers, silence. Invariants 2, 3, 5, 6 and 15 at the server.

use sulcus_core::{MAX_TOOLS, Wrench};

use crate::seen::Tick;

use super::Found;
use super::bounds::{Bounds, ROUNDING, STALE_NS};
use super::wrench::{ceiling, change, is_felt, is_finite};

/// Judges numbers, limits and changes of the wrenches of a tick. `before`: wrenches of the tick before.
///
/// The slew limit of a tick is that of one period, also behind skipped grid points: a tick never catches up.
pub(super) fn limits(
    bounds: &Bounds,
    before: &[Wrench; MAX_TOOLS],
    tick: &Tick,
    found: &mut Found,
) {
    let number = tick.tick;
    found.must(
        tick.force_limit_n.is_finite() && tick.force_limit_n >= 0.0,
        6,
        || format!("tick {number}: force limit {} N", tick.force_limit_n),
    );
    for (hand, (before, now)) in before.iter().zip(&tick.sent).enumerate() {
        found.must(is_finite(now), 6, || {
            format!("tick {number}: hand {hand} is sent {now:?}")
        });
        if !is_finite(before) || !is_finite(now) {
            continue;
        }
        let limit = ceiling(
            before.force,
            bounds.limit_n(tick.force_limit_n),
            bounds.force_step_n,
        );
        found.must(now.force.norm() <= limit + ROUNDING, 3, || {
            let (force, limit_n) = (now.force.norm(), tick.force_limit_n);
            format!("tick {number}: hand {hand} is sent {force} N; limit {limit_n} N, with slew {limit} N")
        });
        let limit = bounds.facts.max_torque_nm;
        found.must(now.torque.norm() <= limit + ROUNDING, 3, || {
            format!(
                "tick {number}: hand {hand} is sent {} N m; limit {limit} N m",
                now.torque.norm()
            )
        });
        let step = change(before.force, now.force, false);
        found.must(step <= bounds.force_step_n + ROUNDING, 5, || {
            format!(
                "tick {number}: the force of hand {hand} changes by {step} N; limit {} N",
                bounds.force_step_n
            )
        });
        let step = change(before.torque, now.torque, false);
        found.must(step <= bounds.torque_step_nm + ROUNDING, 5, || {
            format!(
                "tick {number}: the torque of hand {hand} changes by {step} N m; limit {}",
                bounds.torque_step_nm
            )
        });
    }
}

/// Number of ticks in a row that have no fresh pose for each hand: the tool is absent, or its pose is stale.
#[derive(Default)]
pub(super) struct Idle([u64; MAX_TOOLS]);

impl Idle {
    /// Judges the forces under a pause and without a fresh pose. `paused_ticks`: ticks under the pause, this included.
    pub(super) fn tick(
        &mut self,
        bounds: &Bounds,
        at_ns: u64,
        tick: &Tick,
        paused_ticks: u64,
        found: &mut Found,
    ) {
        let number = tick.tick;
        let age_ns = tick.used.map(|used| at_ns.saturating_sub(used.arrived_ns));
        let is_stale = age_ns.is_none_or(|age_ns| age_ns > STALE_NS);
        // The server may judge the age at the grid point before.
        let must_say_so = age_ns.is_some_and(|age_ns| age_ns > STALE_NS + bounds.facts.tick_ns);
        for (hand, wrench) in tick.sent.iter().enumerate() {
            let (force_n, present) = (wrench.force.norm(), tick.present[hand]);
            let is_quiet = !is_felt(wrench);
            found.must(is_quiet || paused_ticks <= bounds.quiet_ticks, 2, || {
                format!("tick {number}: hand {hand} is sent {force_n} N in tick {paused_ticks} of a pause")
            });
            found.must(!present || tick.stale[hand] || !must_say_so, 15, || {
                format!(
                    "tick {number}: the pose of tool {hand} came {age_ns:?} ns ago and is not stale"
                )
            });
            let is_idle = is_stale || !present || tick.stale[hand];
            self.0[hand] = if is_idle { self.0[hand] + 1 } else { 0 };
            let ticks = self.0[hand];
            found.must(is_quiet || ticks <= bounds.quiet_ticks, 15, || {
                format!("tick {number}: hand {hand} is sent {force_n} N, {ticks} ticks without a fresh pose, {present}")
            });
        }
    }
}
