//! Inputs of a random sequence: clock, link, hand, device, operator.

use sulcus_core::math::exp_rotation;
use sulcus_core::{Pose, Quat, Vec3, Wrench};
use sulcus_haptics::{Unready, Wanted};

use crate::dice::Dice;
use crate::world::{World, odd};

/// A clock that may stand still and step.
pub struct Clock {
    /// True time, nanoseconds.
    pub true_ns: u64,
    offset_ns: i64,
    stands: u64,
    shown_ns: u64,
    faulty: bool,
}

impl Clock {
    pub fn new(dice: &mut Dice) -> Self {
        let start = dice.pick(&[0, 1, 5_000_000_000, 1 << 62]);
        Self {
            true_ns: start,
            offset_ns: 0,
            stands: 0,
            shown_ns: start,
            faulty: dice.chance(0.3),
        }
    }

    /// Advances by one period with jitter, or by a stall.
    pub fn advance(&mut self, dice: &mut Dice, world: &World, calm: bool) -> u64 {
        let mut ns = (world.period_ns as f64 * dice.between(0.7, 1.3)) as u64;
        if !calm && dice.chance(0.01) {
            ns = dice.scaled(1e6, 3e8) as u64;
        }
        self.true_ns += ns;
        if !calm && self.faulty && dice.chance(0.01) {
            match dice.below(4) {
                0 => self.stands = dice.below(60),
                1 => self.offset_ns -= dice.scaled(1e3, 2e9) as i64,
                2 => self.offset_ns += dice.scaled(1e3, 2e9) as i64,
                _ => self.offset_ns = 0,
            }
        }
        if self.stands > 0 {
            self.stands -= 1;
        } else {
            self.shown_ns = self.true_ns.saturating_add_signed(self.offset_ns);
        }
        self.shown_ns
    }
}

/// Present behaviour of the loop of the link.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Loop {
    Normal,
    Stopped,
    Flood,
    /// Orders go on, and the wrench is that of an old datagram.
    Stale,
    Odd,
    Leaving,
}

/// Loop of the link.
pub struct Link {
    state: Loop,
    next_ns: u64,
    pub order: Wanted,
    wrench: Wrench,
    free: bool,
}

impl Link {
    pub fn new() -> Self {
        Self {
            state: Loop::Normal,
            next_ns: 0,
            order: Wanted::NOTHING,
            wrench: Wrench::ZERO,
            free: true,
        }
    }

    /// Orders up to the present call, each passed to `give`.
    pub fn run(
        &mut self,
        dice: &mut Dice,
        world: &World,
        clock: (u64, u64),
        calm: bool,
        give: &mut dyn FnMut(&Wanted),
    ) {
        let (true_ns, shown_ns) = clock;
        if calm {
            // Most tools touch at the end of the calm start.
            (self.state, self.free, self.wrench) = (Loop::Normal, dice.chance(0.2), Wrench::ZERO);
        } else if dice.chance(0.02) {
            const ALL: [Loop; 10] = [
                Loop::Normal,
                Loop::Normal,
                Loop::Normal,
                Loop::Normal,
                Loop::Normal,
                Loop::Stopped,
                Loop::Flood,
                Loop::Stale,
                Loop::Odd,
                Loop::Leaving,
            ];
            self.state = dice.pick(&ALL);
        }
        let orders = match self.state {
            Loop::Stopped => 0,
            Loop::Flood => dice.below(20),
            _ => u64::from(true_ns >= self.next_ns),
        };
        if self.next_ns <= true_ns {
            self.next_ns = true_ns + (world.link_ns as f64 * dice.between(0.5, 1.5)) as u64;
        }
        for _ in 0..orders {
            self.felt(dice, world, calm);
            if self.state != Loop::Stale {
                let early = dice.below(world.link_ns);
                self.order.heard_ns = Some(shown_ns.saturating_sub(if calm { 0 } else { early }));
            }
            self.order.wrench = self.wrench;
            self.order.leaving = self.state == Loop::Leaving;
            give(&self.order);
        }
    }

    fn felt(&mut self, dice: &mut Dice, world: &World, calm: bool) {
        if calm {
            return;
        }
        let (peak, most) = (world.terms.force.peak, world.terms.torque.peak);
        if dice.chance(0.02) {
            self.free = dice.chance(0.2);
        }
        if self.free {
            self.wrench = Wrench::ZERO;
        } else if dice.chance(0.1) || self.wrench == Wrench::ZERO {
            let strength = dice.pick(&[0.3, 1.0, 1.0, 3.0, 1e3]);
            self.wrench.force = dice.vector(peak * strength);
            self.wrench.torque = dice.vector(most * strength);
        }
        if self.state == Loop::Odd && dice.chance(0.5) {
            self.wrench.force = odd(dice, self.wrench.force);
            self.wrench.torque = odd(dice, self.wrench.torque);
        } else if !self
            .wrench
            .force
            .iter()
            .chain(self.wrench.torque.iter())
            .all(|x| x.abs() < 1e8)
        {
            self.wrench = Wrench::ZERO;
        }
    }
}

/// Hand, device and operator.
pub struct Hand {
    pose: Pose,
    velocity: Vec3,
    spin: Vec3,
    /// Number of further calls without a pose, and why.
    gone: (u64, Unready),
    pub buttons: u16,
    bad: bool,
}

impl Hand {
    pub fn new(dice: &mut Dice) -> Self {
        let why = dice.pick(&[Unready::Absent, Unready::Uncalibrated, Unready::NoPose]);
        Self {
            pose: Pose::new(dice.vector(0.1), exp_rotation(&dice.vector(1.0))),
            velocity: Vec3::zeros(),
            spin: Vec3::zeros(),
            gone: (dice.below(5), why),
            buttons: dice.pick(&[0, 0, 1]),
            bad: dice.chance(0.5),
        }
    }

    /// Pose of the next call, `seconds` later.
    pub fn step(&mut self, dice: &mut Dice, seconds: f64, calm: bool) -> Result<Pose, Unready> {
        if dice.chance(0.02) {
            let most = dice.pick(&[0.01, 0.1, 0.1, 0.4]);
            (self.velocity, self.spin) = (dice.vector(most), dice.vector(most * 10.0));
        }
        if self.pose.position.norm() > 0.2 {
            self.velocity = self.pose.position * -1.0;
        }
        // A stall is no reason for a jump of the hand.
        let seconds = seconds.min(0.01);
        self.pose.position += self.velocity * seconds;
        self.pose.orientation = exp_rotation(&(self.spin * seconds)) * self.pose.orientation;
        if calm {
            self.gone.0 = 0;
        } else if dice.chance(0.001) {
            let why = dice.pick(&[Unready::Absent, Unready::Uncalibrated, Unready::NoPose]);
            self.gone = (1 + dice.below(30), why);
        }
        if self.gone.0 > 0 {
            self.gone.0 -= 1;
            return Err(self.gone.1);
        }
        let mut shown = self.pose;
        if !calm && self.bad && dice.chance(0.002) {
            match dice.below(4) {
                0 => shown.position = odd(dice, shown.position),
                1 => shown.position += dice.vector(0.3),
                2 => {
                    let bad = dice.pick(&[f64::NAN, 0.0, f64::INFINITY, 2.0]);
                    let q = self.pose.orientation.into_inner() * bad;
                    shown.orientation = Quat::new_unchecked(q);
                }
                _ => self.pose.position += dice.vector(0.1),
            }
        }
        Ok(shown)
    }

    /// Buttons of the next call.
    pub fn press(&mut self, dice: &mut Dice, calm: bool) -> u16 {
        if calm {
            // A press now and then, never the clutch.
            self.buttons = u16::from(dice.chance(0.1));
        } else if dice.chance(0.01) {
            self.buttons = dice.pick(&[0, 0, 1, 1, 2, 4, 9, u16::MAX]);
        }
        self.buttons
    }
}
