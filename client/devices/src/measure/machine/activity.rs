//! Activities of a measurement: waiting for a button, change of the grip, a stage.

use sulcus_core::Vec3;
use sulcus_haptics::{Sample, Stage};

use super::{Doing, Measurement};
use crate::measure::holder::Holder;
use crate::measure::prompt::{Answer, Prompt};
use crate::measure::task::{Grip, Next};
use crate::measure::tip::unfit;

/// Number of steps for which a prompt waits: 3 minutes.
const PATIENCE: u32 = 180_000;
/// Number of times that a stage is prepared again after a trip.
const ATTEMPTS: u32 = 5;
/// Share of the force that a running stage needs.
const LEAST_GATE: f64 = 0.9;
/// Number of steps below [`LEAST_GATE`] that ends a stage.
const MOST_LATE: u32 = 100;
/// Largest number of steps of a stage: 30 minutes.
const LONGEST: u32 = 1_800_000;

impl Measurement {
    /// Waits for the whole force.
    pub(super) fn arm(&mut self, now_ns: u64, sample: &Sample) -> Vec3 {
        self.prompt = Some(Prompt::PressButton);
        let waits = matches!(sample.stage, Stage::Rising | Stage::Live);
        if waits {
            self.prompt = None;
        }
        if unfit(sample, now_ns).is_none() && sample.gate > 0.999 {
            self.holder = Holder::new(&self.tip, self.plan.most_n());
            self.grip = Grip::Hand;
            self.go_on();
        } else if self.steps > PATIENCE {
            let reason = unfit(sample, now_ns).unwrap_or_else(|| "the loop is late".into());
            self.stop(&reason);
        }
        Vec3::zeros()
    }

    /// Waits for the person's grip. A handle without a hand is held.
    pub(super) fn take(&mut self, grip: Grip, now_ns: u64, sample: &Sample) -> Vec3 {
        if unfit(sample, now_ns).is_some() {
            self.attempts += 1;
            if self.attempts > ATTEMPTS {
                self.skip("the force tripped too often");
            }
            self.begin(Doing::Arming);
            return Vec3::zeros();
        }
        match self.answer.take() {
            Some(Answer::Skip) if grip != Grip::Hand => {
                self.skip("the stage was left out");
                self.go_on();
            }
            Some(_) => {
                self.grip = grip;
                self.go_on();
            }
            None if self.steps > PATIENCE => {
                self.grip = Grip::Hand;
                self.skip("no answer within 3 minutes");
                self.go_on();
            }
            None => {}
        }
        let is_held = self.grip == Grip::Free || grip == Grip::Free;
        if is_held && !self.tip.is_new() {
            return self.force;
        }
        if is_held {
            self.holder.force(&self.tip)
        } else {
            Vec3::zeros()
        }
    }

    /// Performs a step of the present stage.
    pub(super) fn work(&mut self, now_ns: u64, sample: &Sample) -> Vec3 {
        self.late = if sample.gate < LEAST_GATE {
            self.late + 1
        } else {
            0
        };
        let stopped = unfit(sample, now_ns)
            .or_else(|| (self.late > MOST_LATE).then(|| "the loop was late".into()))
            .or_else(|| (self.steps > LONGEST).then(|| "the stage lasted too long".into()));
        if let Some(reason) = stopped {
            self.skip(&reason);
            self.go_on();
            return Vec3::zeros();
        }
        let Doing::Working(task) = &mut self.doing else {
            return Vec3::zeros();
        };
        if let (Some(_), Some(answer)) = (&self.prompt, self.answer.take()) {
            self.prompt = None;
            self.steps = 0;
            task.answer(answer);
        }
        if self.prompt.is_some() && self.steps > PATIENCE {
            task.answer(Answer::Skip);
        }
        if !self.tip.is_new() {
            return self.force;
        }
        match task.step(&self.tip) {
            Next::Force(force) => {
                self.prompt = None;
                force
            }
            Next::Ask(prompt, force) => {
                if self.prompt.is_none() {
                    (self.prompt, self.answer, self.steps) = (Some(prompt), None, 0);
                }
                force
            }
            Next::Done => self.end(None),
            Next::Fail(reason) => self.end(Some(&reason)),
        }
    }

    /// Ends the present stage. The force of a free handle goes on.
    fn end(&mut self, reason: Option<&str>) -> Vec3 {
        match (std::mem::replace(&mut self.doing, Doing::Arming), reason) {
            (Doing::Working(task), None) => {
                task.finish(&mut self.report);
                self.at += 1;
            }
            (_, reason) => self.skip(reason.unwrap_or("no stage")),
        }
        self.learn();
        self.go_on();
        if self.grip == Grip::Free {
            self.force
        } else {
            Vec3::zeros()
        }
    }

    /// Uses the results so far for the rest of the tip and for the weight of the handle.
    fn learn(&mut self) {
        let noise = self
            .report
            .rate
            .measured()
            .map_or(0.0, |rate| rate.noise_mm);
        if let Some(step) = self.report.resolution_mm.measured() {
            self.tip.threshold = 1.5e-3 * step.value.max(noise) + 1e-7;
        }
        if let Some(friction) = self.report.friction.measured() {
            self.holder.bias = Vec3::from(friction.bias_n.map(|bias| bias.value));
        }
    }
}
