//! Passivity control in the time domain, at the device, after Hannaford and Ryu 2002 (doi:10.1109/70.988969).
//!
//! An observer sums the work of the displayed wrench on the hand. A controller damps the hand while more energy has
//! come out than went in. A device displays damping stably up to a limit, which takes a few newtons from a fast hand
//! and almost nothing from a slow hand. For a slowly pushed hand the controller therefore reduces the wrench until
//! the excess is paid.
//!
//! Network delay, and a wrench that is constant over a period, make a spring return more energy than it took. The
//! work of the displayed wrench shows the excess, whatever its cause. Translation and rotation share one budget,
//! because a press may return as a turn. Each hand has a budget of its own.

use sulcus_core::math::{fmax, fmin, log_rotation, norm};
use sulcus_core::scene::params::ParamError;
use sulcus_core::{Pose, Vec3, Wrench};

/// Parameters of the passivity controller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PassivityParams {
    /// Largest damping, N s/m. Default 30, range 0 to 1000; 0 only observes. A larger value removes energy sooner.
    ///
    /// A device of mass `m` displays damping `a` stably while `a T / m` is well under 1. The speed is that of the
    /// period before, so the motion decays without overshoot up to 0.34. The default gives 0.3 for 0.1 kg at 1 kHz.
    pub max_damping: f64,
    /// Lever that converts rotation into motion, m. Default 0.04, range 0.001 to 0.2. Rotation is damped by `a l^2`.
    ///
    /// With the device's radius of gyration (0.045 m for 2e-4 kg m2 and 0.1 kg) one bound on damping holds for both.
    pub lever: f64,
    /// Limit of the damped force where the simulation's force is smaller, N; the limit of the torque is this times the
    /// lever. Default 1, range 0 to 10. A damped force never exceeds the larger of this value and the simulation's
    /// force.
    pub max_force: f64,
    /// Time constant of the reduction of the wrench where damping is not enough, s: a fall to 1/e. Default 2e-3,
    /// range 1e-4 to 1. The reduction serves a hand that a large force pushes along slowly. A shorter time lets less
    /// energy out.
    pub let_go: f64,
    /// Excess up to which the wrench is not reduced, J. Default 3e-5, range 0 to 1; a hand feels about 1e-4. Damping
    /// alone answers to a smaller excess. A smaller value weakens contacts without a felt cause.
    pub unfelt: f64,
    /// Time constant of the return of a reduced wrench once the excess is paid, s: a return of 1 - 1/e. Default 0.03,
    /// range 1e-3 to 10. A shorter time restores a contact sooner; a longer time avoids a blow.
    pub take_up: f64,
    /// Tolerated excess, J. Default 1e-7, range 0 to 1. The default is well under a felt energy and well over the
    /// rounding of poses on the wire (4 nm at 3 N: 1e-8 J).
    pub slack: f64,
    /// Damping of the device itself, N s/m. Default 0 (unknown device), range 0 to 100. It pays an excess while the
    /// device moves, and accumulates no credit. The true value spares the hand an unnecessary braking.
    pub device_damping: f64,
    /// Smallest measured step of the hand's position, m. Default 0, range 0 to 1e-3. The work of a force over two steps
    /// is unknown, so it is no excess: a force that answers to a single step swings with the encoder.
    pub resolution: f64,
    /// Period of the device, s. Default 1e-3, range 1e-4 to 0.01.
    pub period_s: f64,
    /// Force below which a hand feels nothing, N; the torque is this times the lever. Default 1e-3, range 0 to 0.1.
    pub quiet_force: f64,
    /// Time without a felt wrench after which the budget is reset, s. Default 0.1, range 0.001 to 10. With a longer
    /// time the energy of a contact pays for the next contact. With a shorter time a bouncing tool loses its debt in
    /// the air.
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
            resolution: 0.0,
            period_s: 1e-3,
            quiet_force: 1e-3,
            forget_after: 0.1,
        }
    }
}

impl PassivityParams {
    /// Parameters of an observer without a controller.
    pub fn observing() -> Self {
        Self {
            max_damping: 0.0,
            ..Self::default()
        }
    }

    /// Checks the ranges.
    ///
    /// # Errors
    /// A parameter is outside its range: the first one, with its value and range.
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
            ("resolution", self.resolution, 0.0, 1e-3, "0 to 0.001"),
            ("period_s", self.period_s, 1e-4, 0.01, "0.0001 to 0.01"),
            ("quiet_force", self.quiet_force, 0.0, 0.1, "0 to 0.1"),
            ("forget_after", self.forget_after, 1e-3, 10.0, "0.001 to 10"),
        ];
        for (field, found, low, high, expected) in fields {
            // In this form a NaN is outside.
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

/// Share of [`PassivityParams::unfelt`] up to which an excess counts as paid.
const PAID: f64 = 0.5;

/// Sums of the observer and the controller.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy {
    /// Largest net energy that the displayed wrench has put out since a contact began, joules.
    pub most_out: f64,
    /// Largest unpaid energy of one period, joules: no controller can foresee it.
    pub most_at_once: f64,
    /// Net energy that the controller has taken out, joules.
    ///
    /// The value of a period is the work of the wrench without the controller, less the work of the displayed wrench.
    /// The wrench without the controller is one slew step away, so a reduced wrench saves more than this sum.
    pub taken: f64,
    /// Number of periods in which the controller acted.
    pub acted: u64,
}

/// Wrench of the present period, with the controller and without.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Held {
    displayed: Wrench,
    plain: Wrench,
}

/// Observer and controller of one hand.
#[derive(Clone, Debug, PartialEq)]
pub struct Passivity {
    params: PassivityParams,
    /// Last pose of the hand.
    hand: Option<Pose>,
    velocity: Vec3,
    spin: Vec3,
    held: Held,
    /// Net energy put out since the contact began, joules.
    out: f64,
    /// The same less the energy that the device's own damping has paid, joules.
    debt: f64,
    /// Fraction of the wrench that is not reduced, 0 to 1.
    share: f64,
    /// Number of successive periods without a felt wrench.
    quiet: u64,
    energy: Energy,
}

impl Passivity {
    /// Creates a controller that has seen no pose of a hand yet, with an empty energy budget.
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

    /// Accounts for the work of the displayed wrench over `periods` periods, after which the hand is at `hand`.
    /// `None` ends the contact: no hand, or no valid pose.
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

    /// Returns the wrench to display in place of `wanted`. Damping removes the excess within the next period, up to
    /// its limit; the wrench is reduced where damping is not enough. The damping is times `gate` (0 to 1): a session
    /// that ends must end at zero.
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

    /// Returns the fraction of the next period, with `displayed` as the wrench of this period.
    fn next_share(&self, displayed: &Wrench) -> f64 {
        let p = &self.params;
        let power = displayed.force.dot(&self.velocity) + displayed.torque.dot(&self.spin);
        let share_in = |time: f64| p.period_s / (p.period_s + time);
        if power > 0.0 && self.debt + power * p.period_s > p.unfelt + self.unknown(displayed) {
            return self.share * (1.0 - share_in(p.let_go));
        }
        // The return does work by itself. Without a distance between the two excesses the wrench would fall and return
        // in turn: a swing of 0.09 N at 20 Hz in a firm hand.
        if self.debt > p.unfelt * PAID || self.share == 1.0 {
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
        // Below a nanometre per period the quotient is noise.
        let moves = speed_squared > 1e-12;
        if !moves || excess <= p.slack + self.unknown(wanted) || gate <= 0.0 {
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

    /// Sets the wrench of the next period: `displayed`, and `plain` for the same without the controller.
    pub fn hold(&mut self, displayed: &Wrench, plain: &Wrench) {
        self.held = Held {
            displayed: *displayed,
            plain: *plain,
        };
        self.energy.acted += u64::from(displayed != plain);
    }

    /// Whether this controller continues as `earlier` did, bit for bit except for the budget, for `times` repetitions
    /// of the same hand and wrenches. The budget may differ while the controller has not acted and will not act.
    pub fn repeats(&self, earlier: &Self, times: f64) -> bool {
        // Above the work between two equal moments of a hand at rest: 3 N over 0.3 um.
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

    /// Sums so far.
    pub fn energy(&self) -> Energy {
        self.energy
    }

    /// Work of `wrench` over two steps of the measured position, joules.
    fn unknown(&self, wrench: &Wrench) -> f64 {
        2.0 * self.params.resolution * norm(&wrench.force)
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
