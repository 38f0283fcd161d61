//! Static force, by the readings of a scale.

use sulcus_core::Vec3;
use sulcus_core::math::{fclamp, norm};

use super::plan::Plan;
use super::prompt::{Answer, Prompt};
use super::report::{Measured, Outcome, ScalePoint};
use super::task::{Next, Task};
use super::tip::Tip;

/// Change of the force, newtons per second.
const RAMP: f64 = 0.5;
/// Number of samples at a force before the question.
const SETTLING: u32 = 1000;
/// Distance at which the tip counts as off the scale, metres.
const OFF: f64 = 0.01;
/// Newtons per gram.
const N_PER_G: f64 = 9.806_65e-3;

/// Stage of the scale.
pub(super) struct Scale {
    /// Forces, newtons; the first is zero.
    forces: Vec<f64>,
    readings: Vec<f64>,
    force: f64,
    waited: u32,
    from: Vec3,
    bad: Option<String>,
}

impl Scale {
    /// Creates the stage, with the tip on the scale.
    pub fn new(plan: &Plan, tip: &Tip) -> Self {
        let mut forces = vec![0.0];
        forces.extend(plan.scale_n());
        Self {
            forces,
            readings: Vec::new(),
            force: 0.0,
            waited: 0,
            from: tip.position,
            bad: None,
        }
    }
}

impl Task for Scale {
    fn step(&mut self, tip: &Tip) -> Next {
        if let Some(reason) = self.bad.take() {
            return Next::Fail(reason);
        }
        // In this form a NaN is off.
        let is_on = norm(&(tip.position - self.from)) < OFF;
        if !is_on {
            return Next::Fail("the tip left the scale".into());
        }
        let Some(&newtons) = self.forces.get(self.readings.len()) else {
            return Next::Done;
        };
        let change = RAMP * tip.seconds;
        self.force += fclamp(newtons - self.force, -change, change);
        let down = Vec3::new(0.0, -self.force, 0.0);
        if self.force != newtons {
            self.waited = 0;
            return Next::Force(down);
        }
        self.waited = self.waited.saturating_add(1);
        if self.waited < SETTLING {
            Next::Force(down)
        } else {
            Next::Ask(Prompt::ReadScale { newtons }, down)
        }
    }

    fn answer(&mut self, answer: Answer) {
        match answer {
            Answer::Grams(grams) if (-5000.0..=5000.0).contains(&grams) => {
                self.readings.push(grams);
                self.waited = 0;
            }
            Answer::Grams(grams) => {
                self.bad = Some(format!("the reading is {grams} g, expected -5000 to 5000"));
            }
            _ => self.bad = Some("no reading".into()),
        }
    }

    fn share(&self) -> f64 {
        self.readings.len() as f64 / self.forces.len() as f64
    }

    fn finish(self: Box<Self>, report: &mut Measured) {
        let zero = self.readings.first().copied().unwrap_or(0.0);
        let points = self.forces.iter().zip(&self.readings).skip(1);
        let points = points.map(|(&asked_n, grams)| {
            let found_n = (grams - zero) * N_PER_G;
            ScalePoint {
                asked_n,
                found_n,
                error_n: found_n - asked_n,
            }
        });
        report.scale = Outcome::Measured(points.collect());
    }
}
