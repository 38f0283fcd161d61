//! The displayed wrench of one hand: passivity control, then the slew limit.

use sulcus_core::math::{fmin, norm};
use sulcus_core::{Pose, Vec3, Wrench};

use crate::limits::SlewLimits;
use crate::passivity::{Energy, Passivity, PassivityParams};

/// Display of one hand: displayed wrench, passivity controller and slew limits.
#[derive(Clone, Debug, PartialEq)]
pub struct Display {
    displayed: Wrench,
    /// Period of the device, milliseconds.
    period_ms: f64,
    slew: SlewLimits,
    passivity: Passivity,
}

impl Display {
    /// Creates a display with zero wrench, a passivity controller and slew limits.
    pub fn new(params: PassivityParams, slew: SlewLimits) -> Self {
        Self {
            displayed: Wrench::ZERO,
            period_ms: params.period_s * 1e3,
            slew,
            passivity: Passivity::new(params),
        }
    }

    /// Returns the wrench to display in the next period for the wanted wrench `wanted`. `wanted` already contains the
    /// factor `gate` (0 to 1).
    pub fn next(&mut self, wanted: &Wrench, gate: f64) -> Wrench {
        self.next_in(wanted, gate, self.period_ms)
    }

    /// Returns the wrench to display as by [`Display::next`], with a slew limit for `ms` milliseconds.
    pub fn next_in(&mut self, wanted: &Wrench, gate: f64, ms: f64) -> Wrench {
        let plain = slewed(&self.displayed, wanted, &self.slew, ms);
        let damped = self.passivity.damped(wanted, gate);
        // The slew limit comes last, because the damping force must not arrive as a blow either. A wrench that only
        // decreases is no blow, and a slow decrease would push a fast hand along: a decrease passes at once.
        let from = if damped == *wanted {
            self.displayed
        } else {
            let_go(&self.displayed, &damped)
        };
        let displayed = slewed(&from, &damped, &self.slew, ms);
        self.passivity.hold(&displayed, &plain);
        self.displayed = displayed;
        displayed
    }

    /// Replaces the displayed wrench by `displayed`, which a later limit has reduced.
    pub fn set(&mut self, displayed: &Wrench) {
        self.passivity.hold(displayed, displayed);
        self.displayed = *displayed;
    }

    /// Accounts for the work of the displayed wrench up to the hand pose `hand`, `periods` device periods later. `None`
    /// stands for an unknown pose.
    pub fn moved(&mut self, hand: Option<&Pose>, periods: u64) {
        self.passivity.moved(hand, periods);
    }

    /// Whether this display continues as `earlier` did, for `times` repetitions of the same hand poses and wrenches.
    pub fn repeats(&self, earlier: &Self, times: f64) -> bool {
        self.displayed == earlier.displayed && self.passivity.repeats(&earlier.passivity, times)
    }

    /// Returns the displayed wrench.
    pub fn displayed(&self) -> Wrench {
        self.displayed
    }

    /// Returns the sums of the energy observer and controller.
    pub fn energy(&self) -> Energy {
        self.passivity.energy()
    }
}

/// Returns the point nearest to `wanted` on the segment from zero to `displayed`, separately for force and torque.
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

/// Returns the step from `before` towards `wanted`, limited to `slew` times `ms` milliseconds.
pub fn slewed(before: &Wrench, wanted: &Wrench, slew: &SlewLimits, ms: f64) -> Wrench {
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
        force: step(before.force, wanted.force, slew.force_n_per_ms * ms),
        torque: step(before.torque, wanted.torque, slew.torque_nm_per_ms * ms),
    }
}

#[cfg(test)]
mod tests {
    use sulcus_core::Params;

    use super::*;

    fn slew() -> SlewLimits {
        SlewLimits::from(&Params::default())
    }

    #[test]
    fn a_force_on_credit_is_let_go_at_once_and_a_braking_one_comes_step_by_step() {
        let mut display = Display::new(PassivityParams::default(), slew());
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
        // 1 mm in one millisecond under 3 N: an unpaid output of 3 mJ.
        display.moved(Some(&at(1e-3)), 1);
        let after = display.next(&push, 1.0).force.x;
        assert!((after + slew().force_n_per_ms).abs() < 1e-12, "{after} N");
        display.moved(Some(&at(2e-3)), 1);
        let after = display.next(&push, 1.0).force.x;
        assert!(
            (after + 2.0 * slew().force_n_per_ms).abs() < 1e-12,
            "{after} N"
        );
    }

    #[test]
    fn wrenches_lost_for_a_while_do_not_come_back_as_a_jolt() {
        let wanted = Wrench {
            force: Vec3::new(3.3, 0.0, 0.0),
            torque: Vec3::new(0.0, 0.2, 0.0),
        };
        let mut displayed = Wrench::ZERO;
        for _ in 0..7 {
            let next = slewed(&displayed, &wanted, &slew(), 1.0);
            assert!(norm(&(next.force - displayed.force)) <= slew().force_n_per_ms + 1e-12);
            assert!(norm(&(next.torque - displayed.torque)) <= slew().torque_nm_per_ms + 1e-12);
            displayed = next;
        }
        assert_eq!(displayed, wanted);
    }

    /// Regression test: a copied default once displayed a scene with another limit at 0.5 N per millisecond.
    #[test]
    fn the_slew_limit_is_the_one_given_not_a_default() {
        let slew = SlewLimits {
            force_n_per_ms: 0.1,
            torque_nm_per_ms: 0.004,
        };
        let mut display = Display::new(PassivityParams::observing(), slew);
        let wanted = Wrench {
            force: Vec3::new(0.0, 0.0, 2.0),
            torque: Vec3::new(0.1, 0.0, 0.0),
        };
        for k in 1..=10 {
            let next = display.next(&wanted, 1.0);
            assert!(
                (next.force.z - 0.1 * f64::from(k)).abs() < 1e-12,
                "{next:?}"
            );
            assert!(
                (next.torque.x - 0.004 * f64::from(k)).abs() < 1e-12,
                "{next:?}"
            );
        }
    }
}
