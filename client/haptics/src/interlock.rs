//! Interlock of a hand: no force before the pose is valid, the tool is free and a button is pressed; no force after a
//! jump or a kick before a button is pressed again.

use std::fmt;
use std::time::Duration;

use sulcus_core::Pose;
use sulcus_core::math::norm;

/// Reason of a device without a valid pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unready {
    /// The device is not connected.
    Absent,
    /// The device must be calibrated.
    Uncalibrated,
    /// The device gives no pose for another reason, for example its grip sleeps.
    NoPose,
}

/// Event that takes the force away until a button is pressed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Trip {
    /// A number of the pose is not finite or farther than [`Interlock::FARTHEST_M`], or its quaternion is none.
    NotFinite,
    /// The pose jumped by more than [`Interlock::JUMP_M`] within [`Interlock::JUMP_WITHIN`].
    Jump,
    /// The hand was faster than [`Interlock::SPEED_M_S`] while a force was displayed.
    Speed,
    /// The driver refused the force.
    Driver,
}

/// Stage of a hand between no device and the whole force.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// No valid pose.
    Unready(Unready),
    /// Valid pose; the tool touches, or no wrench has arrived that says otherwise.
    Touching,
    /// Valid pose of a free tool; the force waits for a button.
    Waiting,
    /// The force rises.
    Rising,
    /// The whole force.
    Live,
    /// The tool is held still while the hand moves back in its workspace; no force.
    Clutched,
    /// No force until a button is pressed while the tool is free.
    Tripped(Trip),
}

impl Stage {
    /// Name in recordings.
    pub fn name(self) -> &'static str {
        match self {
            Self::Unready(Unready::Absent) => "absent",
            Self::Unready(Unready::Uncalibrated) => "uncalibrated",
            Self::Unready(Unready::NoPose) => "no_pose",
            Self::Touching => "touching",
            Self::Waiting => "waiting",
            Self::Rising => "rising",
            Self::Live => "live",
            Self::Clutched => "clutched",
            Self::Tripped(Trip::NotFinite) => "tripped_not_finite",
            Self::Tripped(Trip::Jump) => "tripped_jump",
            Self::Tripped(Trip::Speed) => "tripped_speed",
            Self::Tripped(Trip::Driver) => "tripped_driver",
        }
    }
}

impl fmt::Display for Stage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Unready(Unready::Absent) => "not connected",
            Self::Unready(Unready::Uncalibrated) => "not calibrated: calibrate the device",
            Self::Unready(Unready::NoPose) => "no pose: wake the grip or wait",
            Self::Touching => "no force yet: move the tool away from teeth and tissue",
            Self::Waiting => "no force yet: press a button of the device",
            Self::Rising => "force rises",
            Self::Live => "ready",
            Self::Clutched => "clutch held: no force",
            Self::Tripped(Trip::NotFinite) => "force off after an invalid pose: press a button",
            Self::Tripped(Trip::Jump) => "force off after a jump of the pose: press a button",
            Self::Tripped(Trip::Speed) => "force off after a fast motion: press a button",
            Self::Tripped(Trip::Driver) => "force off by the driver: press a button",
        })
    }
}

/// Observation of one period.
#[derive(Clone, Copy, Debug)]
pub struct Seen<'a> {
    /// Time of the period, nanoseconds.
    pub now_ns: u64,
    /// Pose of the handle, base axes.
    pub pose: Result<&'a Pose, Unready>,
    /// Whether the person pressed a button in this period that may start the force.
    pub pressed: bool,
    /// Whether the person holds the clutch.
    pub clutched: bool,
    /// Whether the tool touches something, or nothing is known about it.
    pub touching: bool,
    /// Force displayed in this period, newtons.
    pub displayed_n: f64,
}

/// State machine of the stages of one hand.
#[derive(Clone, Debug, PartialEq)]
pub struct Interlock {
    stage: Stage,
    /// Duration of the present rise so far.
    risen: Duration,
    /// Newest time of a period.
    stepped_ns: Option<u64>,
    /// Newest valid pose, with its time.
    last: Option<(u64, sulcus_core::Vec3)>,
    /// Speed of the hand, smoothed, m/s.
    speed: f64,
}

impl Interlock {
    /// Duration of the rise.
    pub const RISE: Duration = Duration::from_millis(500);
    /// Largest motion between two poses, metres.
    pub const JUMP_M: f64 = 5e-3;
    /// Time between two poses up to which [`Interlock::JUMP_M`] applies: 2.5 m/s at the longest period of a device.
    pub const JUMP_WITHIN: Duration = Duration::from_micros(2_200);
    /// Largest speed of a hand that feels a force, m/s. A published safety layer uses the same value.
    pub const SPEED_M_S: f64 = 1.0;
    /// Force from which [`Interlock::SPEED_M_S`] applies, newtons.
    pub const SPEED_FROM_N: f64 = 0.1;
    /// Largest distance of a handle from the middle of its workspace, metres. No arm of a device is as long.
    pub const FARTHEST_M: f64 = 10.0;
    /// Longest step of the rise: a late call and a clock that steps forward do not hasten the rise.
    const LONGEST_STEP: Duration = Duration::from_millis(2);
    /// Time constant of the speed, seconds. A step of an encoder is no motion.
    const SPEED_TIME_S: f64 = 5e-3;

    /// Creates the interlock of a device that is not connected.
    pub fn new() -> Self {
        Self {
            stage: Stage::Unready(Unready::Absent),
            risen: Duration::ZERO,
            stepped_ns: None,
            last: None,
            speed: 0.0,
        }
    }

    /// Stage of the last period.
    pub fn stage(&self) -> Stage {
        self.stage
    }

    /// Takes the force away until a button is pressed.
    pub fn trip(&mut self, trip: Trip) {
        if !matches!(self.stage, Stage::Unready(_)) {
            self.stage = Stage::Tripped(trip);
        }
    }

    /// Advances the stage by one period.
    pub fn see(&mut self, seen: &Seen<'_>) -> Stage {
        let step_ns = self
            .stepped_ns
            .map_or(0, |last| seen.now_ns.saturating_sub(last));
        self.stepped_ns = self.stepped_ns.max(Some(seen.now_ns));
        let pose = match seen.pose {
            Ok(pose) if is_finite(pose) => pose,
            Ok(_) => {
                (self.last, self.speed) = (None, 0.0);
                self.stage = Stage::Tripped(Trip::NotFinite);
                return self.stage;
            }
            Err(unready) => {
                (self.last, self.speed) = (None, 0.0);
                self.stage = Stage::Unready(unready);
                return self.stage;
            }
        };
        let trip = self.moved(seen, pose);
        self.risen += Duration::from_nanos(step_ns).min(Self::LONGEST_STEP);
        let free = !seen.touching && !seen.clutched;
        self.stage = match self.stage {
            _ if trip.is_some() => trip.map_or(self.stage, Stage::Tripped),
            Stage::Tripped(_) if !(seen.pressed && free) => self.stage,
            Stage::Rising | Stage::Live if seen.clutched => Stage::Clutched,
            Stage::Clutched if seen.clutched => Stage::Clutched,
            Stage::Clutched => self.rise(),
            Stage::Rising if self.risen() < 1.0 => Stage::Rising,
            Stage::Rising | Stage::Live => Stage::Live,
            Stage::Tripped(_) => self.rise(),
            Stage::Unready(_) | Stage::Touching | Stage::Waiting => match (free, seen.pressed) {
                (false, _) => Stage::Touching,
                (true, false) => Stage::Waiting,
                (true, true) => self.rise(),
            },
        };
        self.stage
    }

    /// Share of the force in the last period, 0 to 1. Begin and end of the rise are smooth.
    pub fn share(&self) -> f64 {
        match self.stage {
            Stage::Live => 1.0,
            Stage::Rising => {
                let x = self.risen();
                x * x * (3.0 - 2.0 * x)
            }
            _ => 0.0,
        }
    }

    fn rise(&mut self) -> Stage {
        self.risen = Duration::ZERO;
        Stage::Rising
    }

    /// Linear position in the rise, 0 to 1.
    fn risen(&self) -> f64 {
        (self.risen.as_secs_f64() / Self::RISE.as_secs_f64()).min(1.0)
    }

    /// Accounts for the motion to `pose`, and returns the trip that it causes.
    fn moved(&mut self, seen: &Seen<'_>, pose: &Pose) -> Option<Trip> {
        let last = self.last.replace((seen.now_ns, pose.position));
        let (last_ns, from) = last?;
        let way = norm(&(pose.position - from));
        let time = Duration::from_nanos(seen.now_ns.saturating_sub(last_ns));
        if way > Self::JUMP_M && time <= Self::JUMP_WITHIN {
            self.speed = 0.0;
            return Some(Trip::Jump);
        }
        let seconds = time.as_secs_f64();
        if seconds > 0.0 {
            let share = seconds / (seconds + Self::SPEED_TIME_S);
            self.speed += (way / seconds - self.speed) * share;
        }
        let kicked = self.speed > Self::SPEED_M_S && seen.displayed_n > Self::SPEED_FROM_N;
        kicked.then_some(Trip::Speed)
    }
}

impl Default for Interlock {
    fn default() -> Self {
        Self::new()
    }
}

/// Whether all numbers of `pose` are finite, its quaternion has about unit length and its place is that of a handle.
/// A finite number that is huge would poison the speed and the passivity controller.
fn is_finite(pose: &Pose) -> bool {
    let turn = pose.orientation.as_ref().norm();
    // In this form a NaN is no place.
    norm(&pose.position) <= Interlock::FARTHEST_M && (0.99..1.01).contains(&turn)
}

#[cfg(test)]
mod tests {
    use super::*;
    use sulcus_core::{Quat, Vec3};

    const MS: u64 = 1_000_000;

    /// Hand that moves along x by `way` metres a millisecond.
    struct Hand {
        lock: Interlock,
        ms: u64,
        x: f64,
    }

    impl Hand {
        fn new() -> Self {
            Self {
                lock: Interlock::new(),
                ms: 0,
                x: 0.0,
            }
        }

        fn step(&mut self, way: f64, change: impl Fn(&mut Seen<'_>)) -> Stage {
            self.ms += 1;
            self.x += way;
            let pose = Pose::new(Vec3::new(self.x, 0.0, 0.0), Quat::identity());
            let mut seen = Seen {
                now_ns: self.ms * MS,
                pose: Ok(&pose),
                pressed: false,
                clutched: false,
                touching: false,
                displayed_n: 0.0,
            };
            change(&mut seen);
            self.lock.see(&seen)
        }

        fn share(&self) -> f64 {
            self.lock.share()
        }

        fn live() -> Self {
            let mut hand = Self::new();
            hand.step(0.0, |seen| seen.pressed = true);
            (0..500).for_each(|_| {
                hand.step(0.0, |_| ());
            });
            assert_eq!(hand.lock.stage(), Stage::Live);
            hand
        }
    }

    #[test]
    fn the_force_waits_for_a_free_tool_and_a_button() {
        let mut hand = Hand::new();
        assert_eq!(
            hand.step(0.0, |seen| seen.pose = Err(Unready::Uncalibrated)),
            Stage::Unready(Unready::Uncalibrated)
        );
        // A button beside a tooth starts nothing.
        assert_eq!(
            hand.step(0.0, |seen| (seen.touching, seen.pressed) = (true, true)),
            Stage::Touching
        );
        assert_eq!(hand.step(0.0, |_| ()), Stage::Waiting);
        assert_eq!(hand.share(), 0.0);
        assert_eq!(hand.step(0.0, |seen| seen.pressed = true), Stage::Rising);
        let mut before = 0.0;
        for _ in 0..499 {
            assert_eq!(hand.step(0.0, |seen| seen.touching = true), Stage::Rising);
            assert!(hand.share() > before && hand.share() - before < 0.0031);
            before = hand.share();
        }
        assert_eq!(hand.step(0.0, |_| ()), Stage::Live);
    }

    #[test]
    fn a_lost_device_starts_again_from_the_beginning() {
        let mut hand = Hand::live();
        hand.step(0.0, |seen| seen.pose = Err(Unready::Absent));
        assert_eq!(hand.share(), 0.0);
        assert_eq!(hand.step(0.5, |_| ()), Stage::Waiting);
        assert_eq!(hand.share(), 0.0);
    }

    #[test]
    fn a_jump_an_invalid_number_and_a_kick_need_a_button() {
        let nan = Pose::new(Vec3::repeat(f64::NAN), Quat::identity());
        for (trip, way, displayed_n) in [
            (Trip::Jump, 6e-3, 0.0),
            (Trip::NotFinite, 0.0, 0.0),
            (Trip::Speed, 2e-3, 0.2),
        ] {
            let mut hand = Hand::live();
            for _ in 0..10 {
                hand.step(way, |seen| seen.displayed_n = displayed_n);
            }
            if trip == Trip::NotFinite {
                hand.ms += 1;
                hand.lock.see(&Seen {
                    now_ns: hand.ms * MS,
                    pose: Ok(&nan),
                    pressed: true,
                    clutched: false,
                    touching: false,
                    displayed_n,
                });
            }
            assert_eq!(hand.lock.stage(), Stage::Tripped(trip));
            (0..2000).for_each(|_| {
                hand.step(0.0, |_| ());
            });
            assert_eq!(
                (hand.lock.stage(), hand.share()),
                (Stage::Tripped(trip), 0.0)
            );
            hand.step(0.0, |seen| (seen.pressed, seen.touching) = (true, true));
            assert_eq!(hand.lock.stage(), Stage::Tripped(trip));
            assert_eq!(hand.step(0.0, |seen| seen.pressed = true), Stage::Rising);
        }
    }

    #[test]
    fn a_fast_hand_in_the_air_keeps_its_force() {
        let mut hand = Hand::live();
        assert!((0..100).all(|_| hand.step(2e-3, |_| ()) == Stage::Live));
    }

    #[test]
    fn a_clutch_takes_the_force_and_returns_it_slowly() {
        let mut hand = Hand::live();
        assert_eq!(hand.step(0.0, |seen| seen.clutched = true), Stage::Clutched);
        assert_eq!(hand.share(), 0.0);
        assert_eq!(hand.step(0.0, |_| ()), Stage::Rising);
        assert!(hand.share() < 0.001);
    }
}
