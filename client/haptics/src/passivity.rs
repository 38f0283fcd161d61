//! Passivity in the time domain, at the device: an observer counts the energy that the displayed wrench put out into
//! the hand, and a controller damps the hand when more came out than went in (after Hannaford and Ryu 2002,
//! doi:10.1109/70.988969). Damping that a device can display stably takes a few newtons of a fast hand and next to nothing
//! of a slow one; so a hand that is pushed along slowly is let go of, too, until it has paid.
//!
//! A network's delay and a wrench that is held over a period make a spring give back more than it took. Whatever the
//! cause, the device sees it: the work of what it displayed. Translation and rotation are one budget, because a press
//! may well come back as a turn; each hand has its own.

use sulcus_core::math::{fmax, fmin, log_rotation, norm};
use sulcus_core::scene::params::ParamError;
use sulcus_core::{Pose, Vec3, Wrench};

/// How the controller damps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PassivityParams {
    /// Most damping, N s/m. Default 30, range 0 to 1000; 0 only observes. More takes energy out sooner. A device of mass
    /// `m` displays damping `a` stably while `a T / m` is well under 1 (the speed is that of the period before: the
    /// motion decays without overshoot up to 0.34): 0.3 for 0.1 kg at 1 kHz.
    pub max_damping: f64,
    /// Lever by which turning counts as moving, m. Default 0.04, range 0.001 to 0.2: rotation is damped by `a l^2`. Where
    /// it is the device's radius of gyration (0.045 m for 2e-4 kg m2 and 0.1 kg) the bound above holds for both.
    pub lever: f64,
    /// Most force by which damping may go beyond what the simulation wants, N; torque that times the lever. Default 1,
    /// range 0 to 10. Damping never makes a greater force than this or the simulation's own, whichever is greater.
    pub max_force: f64,
    /// Time in which the wrench falls to a third (1/e) where damping is not enough, s. Default 2e-3, range 1e-4 to 1. Damping brakes a
    /// fast hand; one that is pushed along slowly by a large force is let go of instead. Shorter: less energy comes out.
    pub let_go: f64,
    /// Excess up to which nothing is let go of, J: damping alone answers to it. Default 3e-5, range 0 to 1: under what is felt (1e-4).
    /// Less: a contact that gave back nothing that is felt stays weak for it.
    pub unfelt: f64,
    /// Time in which two thirds (1 - 1/e) of what was let go come back once the excess is paid, s. Default 0.03, range 1e-3 to 10. Shorter: a
    /// contact is as firm as it should be sooner; longer: it does not come back as a blow.
    pub take_up: f64,
    /// Excess that is let be, J. Default 1e-7, range 0 to 1: well under what is felt, well over the rounding of poses
    /// on their way (4 nm at 3 N: 1e-8 J).
    pub slack: f64,
    /// The device's own damping, N s/m: what it takes of an excess while it moves need not be displayed. It pays debts and
    /// saves nothing up. Default 0 (nothing is known of the device; the displayed wrench itself is passive), range 0
    /// to 100. The true value spares the hand a braking that it does not need.
    pub device_damping: f64,
    /// Period of the device, s. Default 1e-3, range 1e-4 to 0.01.
    pub period_s: f64,
    /// Force under which nothing is felt, N. Default 1e-3, range 0 to 0.1; torque that times the lever.
    pub quiet_force: f64,
    /// How long nothing must have been felt until the budget is forgotten, s. Default 0.1, range 0.001 to 10. Longer: what a
    /// contact took in pays for what the next one puts out. Shorter: a tool that bounces has its debt forgotten in the air.
    pub forget_after: f64,
}

impl Default for PassivityParams {
    fn default() -> Self {
        Self {
            max_damping: 30.0,
            lever: 0.04,
            max_force: 1.0,
            let_go: 2e-3,
            unfelt: 3e-5,
            take_up: 0.03,
            slack: 1e-7,
            device_damping: 0.0,
            period_s: 1e-3,
            quiet_force: 1e-3,
            forget_after: 0.1,
        }
    }
}

impl PassivityParams {
    /// Only observes: what is wanted is displayed.
    pub fn observing() -> Self {
        Self {
            max_damping: 0.0,
            ..Self::default()
        }
    }

    /// # Errors
    /// Names the first parameter outside its range.
    pub fn validate(&self) -> Result<(), ParamError> {
        let fields = [
            ("max_damping", self.max_damping, 0.0, 1e3, "0 to 1000"),
            ("lever", self.lever, 1e-3, 0.2, "0.001 to 0.2"),
            ("max_force", self.max_force, 0.0, 10.0, "0 to 10"),
            ("let_go", self.let_go, 1e-4, 1.0, "0.0001 to 1"),
            ("unfelt", self.unfelt, 0.0, 1.0, "0 to 1"),
            ("take_up", self.take_up, 1e-3, 10.0, "0.001 to 10"),
            ("slack", self.slack, 0.0, 1.0, "0 to 1"),
            (
                "device_damping",
                self.device_damping,
                0.0,
                100.0,
                "0 to 100",
            ),
            ("period_s", self.period_s, 1e-4, 0.01, "0.0001 to 0.01"),
            ("quiet_force", self.quiet_force, 0.0, 0.1, "0 to 0.1"),
            ("forget_after", self.forget_after, 1e-3, 10.0, "0.001 to 10"),
        ];
        for (field, found, low, high, expected) in fields {
            // Written so that a NaN is outside.
            let inside = found >= low && found <= high;
            if !inside {
                return Err(ParamError {
                    field,
                    found,
                    expected,
                });
            }
        }
        Ok(())
    }
}

/// What the observer and the controller came to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy {
    /// Most that the displayed wrench had put out, net, since a contact began, joules.
    pub most_out: f64,
    /// Most that was put out beyond what had been paid for within one period, joules: what no controller foresees.
    pub most_at_once: f64,
    /// What the controller took out, net, joules: period by period the work of what would have been displayed next without it, less that
    /// of what was. (Of a hand that was let go of, the next would be one step of the slew: what it was spared as a whole is more.)
    pub taken: f64,
    /// Periods in which the controller acted.
    pub acted: u64,
}

/// The wrench that is displayed now, and what would be without the controller.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Held {
    displayed: Wrench,
    plain: Wrench,
}

/// Observer and controller of one hand.
#[derive(Clone, Debug, PartialEq)]
pub struct Passivity {
    params: PassivityParams,
    /// Where the hand was last.
    hand: Option<Pose>,
    velocity: Vec3,
    spin: Vec3,
    held: Held,
    /// Put out since contact began, net.
    out: f64,
    /// The same less what the device's own damping took of an excess.
    debt: f64,
    /// Share of the wrench that is not let go, 0 to 1.
    share: f64,
    /// Periods in a row in which nothing was felt.
    quiet: u64,
    energy: Energy,
}

impl Passivity {
    /// Before the hand was seen.
    pub fn new(params: PassivityParams) -> Self {
        Self {
            params,
            hand: None,
            velocity: Vec3::zeros(),
            spin: Vec3::zeros(),
            held: Held {
                displayed: Wrench::ZERO,
                plain: Wrench::ZERO,
            },
            out: 0.0,
            debt: 0.0,
            share: 1.0,
            quiet: 0,
            energy: Energy::default(),
        }
    }

    /// So many periods of the device later its hand is at `hand`: what was displayed did its work on the way. `None` where
    /// no hand holds the tool or its place is not known: the contact is over.
    pub fn moved(&mut self, hand: Option<&Pose>, periods: u64) {
        let before = std::mem::replace(&mut self.hand, hand.copied());
        let (Some(before), Some(now)) = (before, hand) else {
            (self.velocity, self.spin) = (Vec3::zeros(), Vec3::zeros());
            self.forget();
            return;
        };
        let time = self.params.period_s * periods.max(1) as f64;
        let way = now.position - before.position;
        let turn = log_rotation(&(now.orientation * before.orientation.inverse()));
        let work = |wrench: &Wrench| wrench.force.dot(&way) + wrench.torque.dot(&turn);
        let done = work(&self.held.displayed);
        (self.velocity, self.spin) = (way / time, turn / time);
        self.out += done;
        self.debt += done;
        if self.debt > 0.0 {
            let paid = self.params.device_damping * self.speed_squared() * time;
            self.debt = fmax(0.0, self.debt - paid);
        }
        self.energy.most_out = fmax(self.energy.most_out, self.out);
        let unpaid = fmin(done, self.out) / periods.max(1) as f64;
        self.energy.most_at_once = fmax(self.energy.most_at_once, unpaid);
        self.energy.taken += work(&self.held.plain) - done;
        let felt = &self.held.plain;
        let (force, torque) = (norm(&felt.force), norm(&felt.torque));
        let quiet = self.params.quiet_force;
        if force <= quiet && torque <= quiet * self.params.lever {
            self.quiet += periods;
            if self.quiet as f64 * self.params.period_s >= self.params.forget_after {
                self.forget();
            }
        } else {
            self.quiet = 0;
        }
    }

    /// What to display in place of `wanted`: the same, damped so that an excess is gone within the next period, as far
    /// as damping may go, and let go of where that is not enough; of the damping the share `gate` (0: what ends must come to
    /// rest at nothing).
    pub fn damped(&mut self, wanted: &Wrench, gate: f64) -> Wrench {
        if self.params.max_damping == 0.0 {
            return *wanted;
        }
        let kept = Wrench {
            force: wanted.force * self.share,
            torque: wanted.torque * self.share,
        };
        let damped = self.braked(&kept, gate);
        self.share = self.next_share(&damped);
        damped
    }

    /// The share of the next period where `displayed` is what this one displays.
    fn next_share(&self, displayed: &Wrench) -> f64 {
        let p = &self.params;
        let power = displayed.force.dot(&self.velocity) + displayed.torque.dot(&self.spin);
        let share_in = |time: f64| p.period_s / (p.period_s + time);
        if power > 0.0 && self.debt + power * p.period_s > p.unfelt {
            return self.share * (1.0 - share_in(p.let_go));
        }
        if self.debt > p.unfelt || self.share == 1.0 {
            return self.share;
        }
        let next = self.share + (1.0 - self.share) * share_in(p.take_up);
        if next > 0.999 { 1.0 } else { next }
    }

    fn braked(&self, wanted: &Wrench, gate: f64) -> Wrench {
        let p = &self.params;
        let speed_squared = self.speed_squared();
        let ahead = wanted.force.dot(&self.velocity) + wanted.torque.dot(&self.spin);
        let excess = self.debt + ahead * p.period_s;
        let power = excess / p.period_s;
        // (Slower than that the quotient says nothing: a nanometre in a period.)
        let moves = speed_squared > 1e-12;
        if !moves || excess <= p.slack || gate <= 0.0 {
            return *wanted;
        }
        let damping = fmin(power / speed_squared, p.max_damping) * gate;
        let turning = damping * p.lever * p.lever;
        let bounded = |wanted: &Vec3, damped: Vec3, most: f64| {
            let (most, length) = (fmax(norm(wanted), most), norm(&damped));
            if length > most {
                damped * (most / length)
            } else {
                damped
            }
        };
        Wrench {
            force: bounded(
                &wanted.force,
                wanted.force - self.velocity * damping,
                p.max_force,
            ),
            torque: bounded(
                &wanted.torque,
                wanted.torque - self.spin * turning,
                p.max_force * p.lever,
            ),
        }
    }

    /// From now on `displayed` is held, which without the controller would be `plain`.
    pub fn hold(&mut self, displayed: &Wrench, plain: &Wrench) {
        self.held = Held {
            displayed: *displayed,
            plain: *plain,
        };
        self.energy.acted += u64::from(displayed != plain);
    }

    /// Whether from here all goes on as it did from `earlier`, bit for bit but for the budget, for as many `times` as it
    /// takes, as long as the hand and what is wanted do. The budget may move if the controller did not act since, and will not
    /// come to.
    pub fn repeats(&self, earlier: &Self, times: f64) -> bool {
        // More than the work between two like moments of a hand at rest: 3 N over 0.3 um.
        const SWAY: f64 = 1e-6;
        let grown = self.debt - earlier.debt;
        let never_acts = self.energy.acted == earlier.energy.acted
            && (grown < 0.0 || self.debt + grown * times < -SWAY);
        self.params == earlier.params
            && self.hand == earlier.hand
            && (self.velocity, self.spin) == (earlier.velocity, earlier.spin)
            && self.held == earlier.held
            && self.share == earlier.share
            && self.quiet == earlier.quiet
            && (self.debt == earlier.debt || never_acts)
    }

    /// What came of it so far.
    pub fn energy(&self) -> Energy {
        self.energy
    }

    fn speed_squared(&self) -> f64 {
        let lever = self.params.lever;
        self.velocity.dot(&self.velocity) + lever * lever * self.spin.dot(&self.spin)
    }

    fn forget(&mut self) {
        (self.out, self.debt, self.quiet) = (0.0, 0.0, 0);
        self.share = 1.0;
    }
}

#[cfg(test)]
mod tests;
