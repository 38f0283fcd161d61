//! The door: the only way of a wrench to a hand.
//!
//! A wrench passes, in this order: interpolation between two wrenches of the link, mapping to the device, watchdog,
//! silence, interlock, clamp to the smallest limit and to the continuous force, passivity, slew, and a last clamp.

mod rules;

pub use rules::{DoorRules, Guard};

use std::time::Duration;

use sulcus_core::math::{fmin, norm};
use sulcus_core::{Pose, Vec3, Wrench};

use crate::continuous::Heat;
use crate::display::Display;
use crate::freshness::Freshness;
use crate::interlock::{Interlock, Seen, Stage, Trip, Unready};
use crate::limits::{Limits, gated};
use crate::passivity::Energy;
use crate::watchdog::Watchdog;

/// Order of the loop of the link to a hand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wanted {
    /// Wrench about the tool's device point, world axes.
    pub wrench: Wrench,
    /// Wrench of a guide, about the same point, added to the wrench. It is no contact: it does not hold the interlock.
    pub guide: Wrench,
    /// Time of arrival of the wrench, nanoseconds; `None` before the first wrench.
    pub heard_ns: Option<u64>,
    /// Whether the session ends: the force falls to zero, and damping ends.
    pub leaving: bool,
    /// Whether the session is paused: damping ends as soon as the wrench of the simulation has fallen to zero.
    pub paused: bool,
    /// Number of presses of a key that replaces the device's button.
    pub presses: u32,
}

impl Wanted {
    /// Order before the first wrench.
    pub const NOTHING: Self = Self {
        wrench: Wrench::ZERO,
        guide: Wrench::ZERO,
        heard_ns: None,
        leaving: false,
        paused: false,
        presses: 0,
    };
}

/// Counters of a door.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Counts {
    /// Number of periods.
    pub periods: u64,
    /// Number of trips.
    pub trips: u64,
    /// Number of periods with a torque that the device cannot display.
    pub dropped: u64,
    /// Largest torque that the device could not display, newton-metres.
    pub most_dropped_nm: f64,
    /// Number of periods in which the continuous limit reduced the force.
    pub limited: u64,
    /// Largest displayed force, newtons.
    pub most_n: f64,
}

/// Force from which a tool counts as touching, newtons; a torque counts at this value times 40 mm.
const TOUCH_N: f64 = 0.02;
/// Longest step of the slew limit while a force is wanted, milliseconds: a late call must not give a blow.
const LONGEST_STEP_MS: f64 = 2.0;
/// Longest step of the slew limit on the way to zero, milliseconds.
const LONGEST_FALL_MS: f64 = 20.0;

/// State of the door of one hand.
#[derive(Clone, Debug)]
pub struct Door {
    rules: DoorRules,
    wanted: Wanted,
    /// Wrench at the beginning of the present interpolation, world axes.
    from: Wrench,
    watchdog: Watchdog,
    guard: Option<Guarding>,
    display: Display,
    /// Time of the last wrench passed.
    passed_ns: Option<u64>,
    gate: f64,
    counts: Counts,
}

/// State of a [`Guard`].
#[derive(Clone, Debug)]
struct Guarding {
    guard: Guard,
    freshness: Freshness,
    interlock: Interlock,
    force: Heat,
    torque: Heat,
    /// Newest valid pose of the handle, base axes.
    hand: Pose,
    /// Position of the handle at the beginning of the clutch, base axes, metres.
    held: Option<Vec3>,
    buttons: u16,
    presses: u32,
    /// Share of the limits that freshness and rise allow in the present period, 0 to 1: the bound of every wrench.
    most: f64,
}

impl Door {
    /// Creates a closed door.
    pub fn new(rules: DoorRules) -> Self {
        let period = Duration::from_nanos(period_ns(&rules));
        let guard = rules
            .guard
            .clone()
            .map(|guard| Guarding::new(guard, period));
        Self {
            wanted: Wanted::NOTHING,
            from: Wrench::ZERO,
            watchdog: Watchdog::new(),
            guard,
            display: Display::new(rules.passivity, rules.slew),
            passed_ns: None,
            gate: 0.0,
            counts: Counts::default(),
            rules,
        }
    }

    /// Takes a new order.
    pub fn order(&mut self, wanted: &Wanted) {
        if wanted.heard_ns != self.wanted.heard_ns {
            let from = self.interpolated(wanted.heard_ns.unwrap_or(0));
            // A wrench that is not finite must not stay in the interpolation.
            self.from = if is_finite(&from) { from } else { Wrench::ZERO };
            if let Some(at_ns) = wanted.heard_ns {
                self.watchdog.heard(at_ns);
            }
        }
        self.wanted = *wanted;
    }

    /// Accounts for the hand at `pose` in the axes of the device, `periods` periods later. `None`: no hand, or no valid
    /// pose.
    pub fn moved(&mut self, pose: Option<&Pose>, periods: u64) {
        self.display.moved(pose, periods);
    }

    /// Performs a period of a guarded device: motion of the hand, then the wrench about the centre of the gimbal, base
    /// axes. `pose` is that of the handle, base axes.
    pub fn exchange(&mut self, now_ns: u64, pose: Result<&Pose, Unready>, buttons: u16) -> Wrench {
        let before = self.display.displayed();
        let touching = self.is_touching(now_ns);
        let presses = self.wanted.presses;
        if let Some(guarding) = &mut self.guard {
            let was = guarding.interlock.stage();
            let stage = guarding.see(now_ns, pose, (buttons, presses), touching, &before);
            let tripped = matches!(stage, Stage::Tripped(_)) && stage != was;
            self.counts.trips += u64::from(tripped);
        }
        let periods = self.passed_ns.map_or(1, |last| {
            let period_ns = period_ns(&self.rules);
            now_ns.saturating_sub(last).saturating_add(period_ns / 2) / period_ns
        });
        let valid = !matches!(
            self.stage(),
            Stage::Unready(_) | Stage::Tripped(Trip::NotFinite)
        );
        self.moved(pose.ok().filter(|_| valid), periods.max(1));
        self.pass(now_ns)
    }

    /// Returns the wrench to display from `now_ns` on.
    pub fn pass(&mut self, now_ns: u64) -> Wrench {
        self.counts.periods += 1;
        let period_ms = self.rules.passivity.period_s * 1e3;
        let elapsed_ms = self
            .passed_ns
            .map_or(period_ms, |last| now_ns.saturating_sub(last) as f64 * 1e-6);
        self.passed_ns = Some(now_ns);
        // A clock that stands or steps back must not keep a force: for a fall such a call counts as one period.
        let falling_ms = if elapsed_ms > 0.0 {
            elapsed_ms
        } else {
            period_ms
        };
        self.account(falling_ms * 1e-3);
        self.gate = self.watchdog.gate(now_ns) * self.guarded_share(now_ns);
        let is_over = self.wanted.paused && self.wanted.wrench == Wrench::ZERO;
        let damping = if self.wanted.leaving || is_over {
            0.0
        } else {
            self.gate
        };
        let wanted = if self.wanted.leaving {
            Wrench::ZERO
        } else {
            let sent = with_guide(self.interpolated(now_ns), &self.wanted.guide);
            let (mapped, limits) = self.at_device(&sent);
            gated(&mapped, self.gate, &limits)
        };
        let ms = if self.guard.is_none() {
            period_ms
        } else if wanted == Wrench::ZERO && damping == 0.0 {
            falling_ms.min(LONGEST_FALL_MS)
        } else {
            elapsed_ms.min(LONGEST_STEP_MS)
        };
        let next = self.display.next_in(&wanted, damping, ms);
        let displayed = self.last_clamp(&next);
        self.counts.most_n = self.counts.most_n.max(norm(&displayed.force));
        displayed
    }

    /// Displayed wrench: about the centre of the gimbal, base axes, for a guarded device.
    pub fn displayed(&self) -> Wrench {
        self.display.displayed()
    }

    /// Displayed wrench about the tool's device point, world axes.
    pub fn displayed_in_world(&self) -> Wrench {
        let displayed = self.display.displayed();
        match &self.guard {
            Some(guarding) => guarding.guard.mapping.from_base(&displayed, &guarding.hand),
            None => displayed,
        }
    }

    /// Pose of the tool in the world, for the newest valid pose of a guarded device.
    pub fn tool(&self) -> Option<Pose> {
        let guarding = self.guard.as_ref()?;
        let shown = Pose {
            position: guarding.held.unwrap_or(guarding.hand.position),
            ..guarding.hand
        };
        let has_pose = !matches!(
            guarding.interlock.stage(),
            Stage::Unready(_) | Stage::Tripped(Trip::NotFinite)
        );
        has_pose.then(|| guarding.guard.mapping.to_world(&shown))
    }

    /// Share of the force that watchdog, silence and interlock let pass, 0 to 1.
    pub fn gate(&self) -> f64 {
        self.gate
    }

    /// Stage of the interlock; [`Stage::Live`] without a guard.
    pub fn stage(&self) -> Stage {
        self.guard
            .as_ref()
            .map_or(Stage::Live, |guarding| guarding.interlock.stage())
    }

    /// Takes the force away until a button is pressed.
    pub fn trip(&mut self, trip: Trip) {
        if let Some(guarding) = &mut self.guard {
            let was = guarding.interlock.stage();
            guarding.interlock.trip(trip);
            self.counts.trips += u64::from(guarding.interlock.stage() != was);
        }
    }

    /// Counters so far.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// Sums of the passivity controller.
    pub fn energy(&self) -> Energy {
        self.display.energy()
    }

    /// Accounts for the heat of the displayed wrench, which the device has held for the last `seconds`.
    fn account(&mut self, seconds: f64) {
        let displayed = self.display.displayed();
        if let Some(guarding) = &mut self.guard {
            guarding.force.displayed(norm(&displayed.force), seconds);
            guarding.torque.displayed(norm(&displayed.torque), seconds);
        }
    }

    /// Whether the simulation's wrench is felt, or unknown. A tool without contact has no wrench. A wrench that is too
    /// old to be displayed tells nothing about the tool.
    fn is_touching(&self, now_ns: u64) -> bool {
        let Wrench { force, torque } = &self.wanted.wrench;
        let touches = norm(force) >= TOUCH_N || norm(torque) >= TOUCH_N * 0.04;
        // In this form a NaN touches.
        let is_free = norm(force) < TOUCH_N && norm(torque) < TOUCH_N * 0.04;
        let heard_ns = self.wanted.heard_ns;
        let is_silent = |guarding: &Guarding| guarding.freshness.is_silent(heard_ns, now_ns);
        heard_ns.is_none() || touches || !is_free || self.guard.as_ref().is_some_and(is_silent)
    }

    fn guarded_share(&mut self, now_ns: u64) -> f64 {
        let heard_ns = self.wanted.heard_ns;
        self.guard.as_mut().map_or(1.0, |guarding| {
            let fresh = guarding.freshness.share(heard_ns, now_ns);
            let share = guarding.interlock.share();
            guarding.most = match guarding.interlock.stage() {
                Stage::Rising => fresh * share,
                _ => fresh,
            };
            fresh * share
        })
    }

    /// Wrench of the link at `now_ns`: from the last to the newest wrench within a period of the link, for a device
    /// that is faster than the link.
    fn interpolated(&self, now_ns: u64) -> Wrench {
        let (Some(guarding), Some(heard_ns)) = (&self.guard, self.wanted.heard_ns) else {
            return self.wanted.wrench;
        };
        let over_ns = guarding.guard.blend_ns;
        let since_ns = now_ns.saturating_sub(heard_ns);
        if since_ns >= over_ns {
            return self.wanted.wrench;
        }
        let x = since_ns as f64 / over_ns as f64;
        let between = |a: &Vec3, b: &Vec3| a + (b - a) * x;
        Wrench {
            force: between(&self.from.force, &self.wanted.wrench.force),
            torque: between(&self.from.torque, &self.wanted.wrench.torque),
        }
    }

    /// Wrench at the device and its present limits. Counts what the device cannot display.
    fn at_device(&mut self, sent: &Wrench) -> (Wrench, Limits) {
        let Some(guarding) = &self.guard else {
            return (*sent, self.rules.limits);
        };
        let mut wrench = guarding.guard.mapping.to_base(sent, &guarding.hand);
        let limits = Limits {
            force_n: fmin(self.rules.limits.force_n, guarding.force.cap()),
            torque_nm: fmin(self.rules.limits.torque_nm, guarding.torque.cap()),
        };
        self.counts.limited += u64::from(norm(&wrench.force) > limits.force_n);
        if !guarding.guard.has_torque {
            // The torque about the gimbal includes the lever of the force, which a device without torque loses too.
            let lost = norm(&wrench.torque);
            if lost > 0.0 {
                self.counts.dropped += 1;
                self.counts.most_dropped_nm = self.counts.most_dropped_nm.max(lost);
            }
            wrench.torque = Vec3::zeros();
        }
        (wrench, limits)
    }

    /// Returns `next` within the limits of the device, and displays that. The damping of the passivity controller is
    /// bounded by another limit; this clamp holds for every wrench. It includes freshness and rise, because the slew
    /// limit would otherwise keep a force after the silence, and damping would come before the rise.
    fn last_clamp(&mut self, next: &Wrench) -> Wrench {
        let Some(guarding) = &self.guard else {
            return *next;
        };
        let limits = Limits {
            force_n: fmin(self.rules.limits.force_n, guarding.force.cap()),
            torque_nm: fmin(self.rules.limits.torque_nm, guarding.torque.cap()),
        };
        let limits = Limits {
            force_n: limits.force_n * guarding.most,
            torque_nm: limits.torque_nm * guarding.most,
        };
        let mut clamped = gated(next, 1.0, &limits);
        if !guarding.guard.has_torque {
            clamped.torque = Vec3::zeros();
        }
        if clamped != *next {
            self.display.set(&clamped);
        }
        clamped
    }
}

/// Period of the device, nanoseconds, at least 1.
fn period_ns(rules: &DoorRules) -> u64 {
    (rules.passivity.period_s * 1e9).max(1.0) as u64
}

fn is_finite(wrench: &Wrench) -> bool {
    let Wrench { force, torque } = wrench;
    force.iter().chain(torque.iter()).all(|x| x.is_finite())
}

/// Returns `wrench` with the wrench of a guide. Without a guide the bits stay, those of a negative zero included.
fn with_guide(wrench: Wrench, guide: &Wrench) -> Wrench {
    if *guide == Wrench::ZERO {
        return wrench;
    }
    Wrench {
        force: wrench.force + guide.force,
        torque: wrench.torque + guide.torque,
    }
}

impl Guarding {
    fn new(guard: Guard, period: Duration) -> Self {
        Self {
            freshness: Freshness::new(guard.silence, period),
            interlock: Interlock::new(),
            force: Heat::new(guard.force),
            torque: Heat::new(guard.torque),
            hand: Pose::identity(),
            held: None,
            buttons: 0,
            presses: 0,
            most: 0.0,
            guard,
        }
    }

    /// Accounts for pose and buttons of one period.
    fn see(
        &mut self,
        now_ns: u64,
        pose: Result<&Pose, Unready>,
        (buttons, presses): (u16, u32),
        touching: bool,
        displayed: &Wrench,
    ) -> Stage {
        let newly = buttons & !self.buttons;
        // A number that falls is that of another session, not of a press.
        let more = (1..1 << 31).contains(&presses.wrapping_sub(self.presses));
        // A button that is held while the device comes back was not pressed. A rise begins without a force.
        let was_ready = !matches!(self.interlock.stage(), Stage::Unready(_));
        let rests = *displayed == Wrench::ZERO;
        let pressed = (newly & !self.guard.clutch != 0 || more) && was_ready && rests;
        let held = self.interlock.stage() == Stage::Clutched && !rests;
        let clutched = buttons & self.guard.clutch != 0 || held;
        (self.buttons, self.presses) = (buttons, presses);
        let stage = self.interlock.see(&Seen {
            now_ns,
            pose,
            pressed,
            clutched,
            touching,
            displayed_n: norm(&displayed.force),
        });
        let has_pose = !matches!(stage, Stage::Unready(_) | Stage::Tripped(Trip::NotFinite));
        if let (Ok(pose), true) = (pose, has_pose) {
            self.hand = *pose;
            self.hold(stage == Stage::Clutched);
        }
        stage
    }

    /// Holds the tool still while `clutched`. At the end the place of the tool in the world stays, and the base moves.
    fn hold(&mut self, clutched: bool) {
        match (clutched, self.held) {
            (true, None) => self.held = Some(self.hand.position),
            (false, Some(held)) => {
                let mapping = &mut self.guard.mapping;
                let moved = mapping.world_from_base * ((held - self.hand.position) * mapping.scale);
                mapping.origin += moved;
                self.held = None;
            }
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests;
