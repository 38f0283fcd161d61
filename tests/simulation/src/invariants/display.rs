//! Wrenches that a device displays: limits, slew, numbers. Invariants 3, 5 and 6 at the hand.

use sulcus_core::{MAX_TOOLS, Wrench};

use crate::seen::Pass;

use super::Found;
use super::bounds::{BRAKE_N, Bounds, ROUNDING};
use super::memory::Kept;
use super::wrench::{ceiling, change, is_finite};

/// Judges numbers, limits and changes of the displayed wrenches. `behind`: tick of the newest wrench, if known.
///
/// The contract gives a device one step of the slew limit for a pass, also after overslept periods. A lower limit acts
/// in the tick alone: a device may display the wrench of a tick that is still on its way down to the limit.
pub(super) fn limits(
    bounds: &Bounds,
    behind: Option<&Kept>,
    before: &[Wrench; MAX_TOOLS],
    pass: &Pass,
    found: &mut Found,
) {
    let named_n = pass.newest.map_or(0.0, |newest| newest.force_limit_n);
    found.must(named_n.is_finite() && named_n >= 0.0, 6, || {
        format!("a datagram names the limit {named_n} N")
    });
    for (hand, (before, now)) in before.iter().zip(&pass.displayed).enumerate() {
        found.must(is_finite(now), 6, || format!("hand {hand} feels {now:?}"));
        if !is_finite(before) || !is_finite(now) {
            continue;
        }
        let sent_n = behind.map_or(0.0, |tick| tick.force_n[hand]);
        let brake_n = if pass.braked { BRAKE_N } else { 0.0 };
        let target_n =
            (bounds.limit_n(named_n).max(sent_n) + brake_n).min(bounds.facts.max_force_n);
        let limit = ceiling(before.force, target_n, bounds.force_step_n);
        found.must(now.force.norm() <= limit + ROUNDING, 3, || {
            let force = now.force.norm();
            format!("hand {hand} feels {force} N; limit {named_n} N, sent {sent_n} N, with slew {limit} N")
        });
        let limit = bounds.facts.max_torque_nm;
        found.must(now.torque.norm() <= limit + ROUNDING, 3, || {
            format!(
                "hand {hand} feels {} N m; limit {limit} N m",
                now.torque.norm()
            )
        });
        let (braked, overslept) = (pass.braked, pass.overslept);
        let step = change(before.force, now.force, braked);
        found.must(step <= bounds.force_step_n + ROUNDING, 5, || {
            let limit = bounds.force_step_n;
            format!("the force of hand {hand} changes by {step} N; limit {limit} N, {overslept} overslept, {braked}")
        });
        let step = change(before.torque, now.torque, braked);
        found.must(step <= bounds.torque_step_nm + ROUNDING, 5, || {
            let limit = bounds.torque_step_nm;
            format!("the torque of hand {hand} changes by {step} N m; limit {limit}, {overslept} overslept, {braked}")
        });
    }
}
