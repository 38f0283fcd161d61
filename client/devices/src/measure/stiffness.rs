//! Largest stable stiffness, by a virtual floor whose stiffness rises until the handle shakes.
//!
//! The floor rises under the handle until it carries [`PRELOAD_N`]. A push upwards and the loss of the force after it
//! then make the handle fall on the floor, against its friction. The stiffness is stable if the force becomes quiet.
//! The force ends at the first sign of a shake.

use sulcus_core::Vec3;
use sulcus_core::math::{fclamp, fmax};

use super::plan::{Part, Plan};
use super::report::{Measured, Outcome, StiffnessFigures};
use super::shake::{Shake, Verdict};
use super::task::{Next, Task};
use super::tip::Tip;

/// Step of the stiffness, N/m; above 1 N/mm the step is 5 %.
const STEP: f64 = 50.0;
/// Force that the floor carries before the push, newtons.
const PRELOAD_N: f64 = 0.4;
/// Time constant with which the floor takes its load, seconds.
const LOAD_S: f64 = 0.1;
/// Largest speed of the floor, m/s.
const FLOOR_SPEED: f64 = 0.01;
/// Time in which the load of the floor must be right, seconds.
const LOADING_S: f64 = 6.0;
/// Distance by which a hand may give way, metres.
const YIELD: f64 = 0.04;
/// Time of the push upwards, and of the loss of the force after it, seconds.
const PUSH_S: f64 = 0.015;
/// Number of times that a stiffness is tried again after the hand left the floor.
const TRIALS: u32 = 4;

/// Stage of the stiffness.
pub(super) struct Stiffness {
    part: Part,
    most_n: f64,
    most: f64,
    /// Present stiffness, N/m.
    stiffness: f64,
    /// Height of the floor, base axes, metres.
    floor: f64,
    from: f64,
    phase: Phase,
    trials: u32,
    last: Option<(f64, f64)>,
    count: usize,
    unstable: Option<f64>,
}

enum Phase {
    /// The floor takes its load. Seconds so far, and seconds with the right load.
    Loading(f64, f64),
    /// The floor stands. Seconds so far, seconds without contact or at the limit, and judgement.
    Standing(f64, f64, Shake),
}

impl Stiffness {
    /// Creates the stage of a grip.
    pub fn new(part: Part, plan: &Plan, tip: &Tip) -> Self {
        let height = tip.position.y;
        Self {
            part,
            most_n: plan.most_n(),
            most: plan.most_stiffness,
            stiffness: STEP,
            floor: height - 1e-3,
            from: height,
            phase: Phase::Loading(0.0, 0.0),
            trials: 0,
            last: None,
            count: 0,
            unstable: None,
        }
    }

    fn carried(&self, tip: &Tip) -> f64 {
        fclamp(
            (self.floor - tip.position.y) * self.stiffness,
            0.0,
            self.most_n,
        )
    }

    fn load(&mut self, tip: &Tip, seconds: f64, right: f64) -> Next {
        let force = self.carried(tip);
        let target = PRELOAD_N.min(0.5 * self.most_n);
        // Above the surface the missing load is a distance, too.
        let missing = (target - (self.floor - tip.position.y) * self.stiffness) / self.stiffness;
        let speed = fclamp(missing / LOAD_S, -FLOOR_SPEED, FLOOR_SPEED);
        self.floor += speed * tip.seconds;
        let is_right = (force - target).abs() < 0.1 * target + 0.03;
        let right = if is_right { right + tip.seconds } else { 0.0 };
        let seconds = seconds + tip.seconds;
        if (tip.position.y - self.from).abs() > YIELD || seconds > LOADING_S {
            return Next::Fail("the hand did not keep its place against the floor".into());
        }
        self.phase = if right > 0.2 {
            Phase::Standing(0.0, 0.0, Shake::new())
        } else {
            Phase::Loading(seconds, right)
        };
        Next::Force(Vec3::new(0.0, force, 0.0))
    }

    /// Ends the present stiffness and begins the next one; `None` after the last one.
    fn passed(&mut self, rms_n: f64) -> Option<()> {
        self.last = Some((self.stiffness, rms_n));
        self.count += 1;
        self.trials = 0;
        let next = self.stiffness + fmax(STEP, 0.05 * self.stiffness);
        if next > self.most * (1.0 + 1e-9) {
            return None;
        }
        // The force stays while the stiffness changes.
        self.floor -= PRELOAD_N.min(0.5 * self.most_n) * (1.0 / self.stiffness - 1.0 / next);
        self.stiffness = next;
        self.phase = Phase::Loading(0.0, 0.0);
        Some(())
    }
}

impl Task for Stiffness {
    fn step(&mut self, tip: &Tip) -> Next {
        let (seconds, astray, mut shake) = match &self.phase {
            &Phase::Loading(seconds, right) => return self.load(tip, seconds, right),
            Phase::Standing(seconds, astray, shake) => (*seconds, *astray, shake.clone()),
        };
        let force = self.carried(tip);
        match shake.see(tip.displayed.y, tip.seconds) {
            Verdict::Shakes => {
                self.unstable = Some(self.stiffness);
                return Next::Done;
            }
            Verdict::Quiet(rms_n) if 4.0 * astray < seconds => {
                if self.passed(rms_n).is_none() {
                    return Next::Done;
                }
                return Next::Force(Vec3::new(0.0, force, 0.0));
            }
            Verdict::Quiet(_) => {
                self.trials += 1;
                if self.trials > TRIALS {
                    return Next::Fail("the hand did not stay on the floor".into());
                }
                self.phase = Phase::Loading(0.0, 0.0);
                return Next::Force(Vec3::new(0.0, force, 0.0));
            }
            Verdict::Open => {}
        }
        let is_astray = force <= 0.0 || force >= self.most_n;
        let astray = if is_astray {
            astray + tip.seconds
        } else {
            astray
        };
        self.phase = Phase::Standing(seconds + tip.seconds, astray, shake);
        let pushed = if seconds < PUSH_S {
            self.most_n
        } else if seconds < 2.0 * PUSH_S {
            0.0
        } else {
            force
        };
        Next::Force(Vec3::new(0.0, pushed, 0.0))
    }

    fn share(&self) -> f64 {
        self.stiffness / self.most
    }

    fn finish(self: Box<Self>, report: &mut Measured) {
        let outcome = match self.last {
            Some((stable, rms_n)) => Outcome::Measured(StiffnessFigures {
                stable_n_per_mm: stable * 1e-3,
                unstable_n_per_mm: self.unstable.map(|unstable| unstable * 1e-3),
                rms_n,
                count: self.count,
            }),
            None => Outcome::NotMeasured("the handle shook at the smallest stiffness".into()),
        };
        match self.part {
            Part::LightGrip => report.light_grip = outcome,
            _ => report.firm_grip = outcome,
        }
    }
}
