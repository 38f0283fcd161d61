//! The last door before the hand: what was sent is damped where the loop puts out energy, and changes by no more than a
//! period's limits.

use sulcus_core::math::{fmin, norm};
use sulcus_core::{Pose, Vec3, Wrench};

use crate::passivity::{Energy, Passivity, PassivityParams};

/// Most that the force displayed changes per millisecond, newtons: what the server's own slew limit allows at its default. Where wrenches were lost the newest may differ by many ticks' worth.
pub const MAX_FORCE_STEP_N: f64 = 0.5;
/// The same for the torque, newton-metres.
pub const MAX_TORQUE_STEP_NM: f64 = 0.03;

/// What one hand's device displays.
#[derive(Clone, Debug, PartialEq)]
pub struct Display {
    displayed: Wrench,
    /// Period of the device, milliseconds.
    period_ms: f64,
    passivity: Passivity,
}

impl Display {
    /// Nothing displayed yet.
    pub fn new(params: PassivityParams) -> Self {
        Self {
            displayed: Wrench::ZERO,
            period_ms: params.period_s * 1e3,
            passivity: Passivity::new(params),
        }
    }

    /// What is displayed over the next period where `wanted` was sent, already times `gate`: the share of the force that
    /// may be displayed at all.
    pub fn next(&mut self, wanted: &Wrench, gate: f64) -> Wrench {
        let plain = slewed(&self.displayed, wanted, self.period_ms);
        let damped = self.passivity.damped(wanted, gate);
        // The slew comes last: damping, too, is not to be felt as a blow. What is only let go cannot be one, and would
        // push a fast hand along for as many periods as it takes.
        let from = if damped == *wanted {
            self.displayed
        } else {
            let_go(&self.displayed, &damped)
        };
        let displayed = slewed(&from, &damped, self.period_ms);
        self.passivity.hold(&displayed, &plain);
        self.displayed = displayed;
        displayed
    }

    /// Where the hand came to be after so many periods of that; `None` where it is not known.
    pub fn moved(&mut self, hand: Option<&Pose>, periods: u64) {
        self.passivity.moved(hand, periods);
    }

    /// Whether from here all goes on as it did from `earlier`, so many `times`, as long as the hand and what is sent do.
    pub fn repeats(&self, earlier: &Self, times: f64) -> bool {
        self.displayed == earlier.displayed && self.passivity.repeats(&earlier.passivity, times)
    }

    /// What is displayed.
    pub fn displayed(&self) -> Wrench {
        self.displayed
    }

    /// What the energy observer and controller came to.
    pub fn energy(&self) -> Energy {
        self.passivity.energy()
    }
}

/// The wrench between `displayed` and nothing that is nearest to `wanted`, force and torque each.
fn let_go(displayed: &Wrench, wanted: &Wrench) -> Wrench {
    let part = |from: Vec3, to: &Vec3| {
        let along = from.dot(to) / from.norm_squared();
        if along > 0.0 {
            from * fmin(along, 1.0)
        } else {
            Vec3::zeros()
        }
    };
    Wrench {
        force: part(displayed.force, &wanted.force),
        torque: part(displayed.torque, &wanted.torque),
    }
}

/// `wanted`, as far as the limits of `ms` milliseconds allow from `before`.
pub fn slewed(before: &Wrench, wanted: &Wrench, ms: f64) -> Wrench {
    let step = |from: Vec3, to: Vec3, most: f64| {
        let change = to - from;
        let length = norm(&change);
        if length > most {
            from + change * (most / length)
        } else {
            to
        }
    };
    Wrench {
        force: step(before.force, wanted.force, MAX_FORCE_STEP_N * ms),
        torque: step(before.torque, wanted.torque, MAX_TORQUE_STEP_NM * ms),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_force_on_credit_is_let_go_at_once_and_a_braking_one_comes_step_by_step() {
        let mut display = Display::new(PassivityParams::default());
        let at = |x: f64| Pose::new(Vec3::new(x, 0.0, 0.0), sulcus_core::Quat::identity());
        let push = Wrench {
            force: Vec3::new(3.0, 0.0, 0.0),
            torque: Vec3::zeros(),
        };
        display.moved(Some(&at(0.0)), 1);
        for _ in 0..6 {
            display.next(&push, 1.0);
        }
        assert_eq!(display.displayed(), push);
        // A millimetre in a millisecond under 3 N: 3 mJ that nobody paid for.
        display.moved(Some(&at(1e-3)), 1);
        let after = display.next(&push, 1.0).force.x;
        assert!((after + MAX_FORCE_STEP_N).abs() < 1e-12, "{after} N");
        display.moved(Some(&at(2e-3)), 1);
        let after = display.next(&push, 1.0).force.x;
        assert!((after + 2.0 * MAX_FORCE_STEP_N).abs() < 1e-12, "{after} N");
    }

    #[test]
    fn wrenches_lost_for_a_while_do_not_come_back_as_a_jolt() {
        let wanted = Wrench {
            force: Vec3::new(3.3, 0.0, 0.0),
            torque: Vec3::new(0.0, 0.2, 0.0),
        };
        let mut displayed = Wrench::ZERO;
        for _ in 0..7 {
            let next = slewed(&displayed, &wanted, 1.0);
            assert!(norm(&(next.force - displayed.force)) <= MAX_FORCE_STEP_N + 1e-12);
            assert!(norm(&(next.torque - displayed.torque)) <= MAX_TORQUE_STEP_NM + 1e-12);
            displayed = next;
        }
        assert_eq!(displayed, wanted);
    }
}
