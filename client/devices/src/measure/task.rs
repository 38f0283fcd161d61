//! Stage of a measurement as a task, and its construction.

use sulcus_core::Vec3;
use sulcus_core::math::fmax;

use super::friction::Friction;
use super::holder::Holder;
use super::plan::{Part, Plan};
use super::prompt::{Answer, Prompt};
use super::rate::Rate;
use super::report::Measured;
use super::resolution::Resolution;
use super::scale::Scale;
use super::steps::Steps;
use super::stiffness::Stiffness;
use super::tip::Tip;

/// Wish of a task after a sample.
pub(super) enum Next {
    /// This force until the next sample, newtons.
    Force(Vec3),
    /// This force, and a prompt with an answer.
    Ask(Prompt, Vec3),
    /// The stage is done.
    Done,
    /// The stage ends without a result: the reason.
    Fail(String),
}

/// Stage at work.
pub(super) trait Task: Send {
    /// Accounts for a new sample. The force of a task is clamped by the measurement.
    fn step(&mut self, tip: &Tip) -> Next;

    /// Takes the answer to a prompt of the task. The default ignores it.
    fn answer(&mut self, _answer: Answer) {}

    /// Share that is done, 0 to 1.
    fn share(&self) -> f64;

    /// Writes the result into `report`.
    fn finish(self: Box<Self>, report: &mut Measured);
}

/// Lengths by which motion is judged, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Steplength {
    /// Smallest step of the position.
    pub step: f64,
    /// Noise of the position at rest.
    pub noise: f64,
}

impl Steplength {
    /// Lengths of `report`; a length that was not measured is that of the model.
    pub fn of(report: &Measured, plan: &Plan) -> Self {
        let model = plan.model.resolution_mm.value;
        let step = report
            .resolution_mm
            .measured()
            .map_or(model, |step| step.value);
        let noise = report.rate.measured().map_or(0.0, |rate| rate.noise_mm);
        Self {
            step: step * 1e-3,
            noise: noise * 1e-3,
        }
    }

    /// Distance from which a tip has moved for certain: three steps.
    pub fn moved(&self) -> f64 {
        3.0 * fmax(self.step, self.noise)
    }

    /// Distance up to which a tip rests.
    pub fn rests(&self) -> f64 {
        fmax(0.5 * self.step, self.noise) + 5e-8
    }
}

/// Way in which a stage wants the handle held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Grip {
    /// By the person, in any way.
    Hand,
    /// By the device alone.
    Free,
    /// Lightly.
    Light,
    /// Firmly.
    Firm,
    /// On a scale.
    Scale,
}

impl Grip {
    /// Grip of a stage.
    pub fn of(part: Part) -> Self {
        match part {
            Part::Rate | Part::Resolution | Part::Friction | Part::Steps => Self::Free,
            Part::LightGrip => Self::Light,
            Part::FirmGrip => Self::Firm,
            Part::Scale => Self::Scale,
        }
    }

    /// Prompt for the grip.
    pub fn prompt(self) -> Prompt {
        match self {
            Self::Hand => Prompt::TakeHandle,
            Self::Free => Prompt::HoldNothing,
            Self::Light => Prompt::HoldLightly,
            Self::Firm => Prompt::HoldFirmly,
            Self::Scale => Prompt::PutOnScale,
        }
    }
}

/// Creates the task of `part`.
///
/// # Errors
/// A result of an earlier stage is missing: the reason.
pub(super) fn task(
    part: Part,
    plan: &Plan,
    report: &Measured,
    holder: &Holder,
    tip: &Tip,
) -> Result<Box<dyn Task>, String> {
    let lengths = Steplength::of(report, plan);
    let holder = holder.clone();
    Ok(match part {
        Part::Rate => Box::new(Rate::new(holder)),
        Part::Resolution => Box::new(Resolution::new(holder)),
        Part::Friction => Box::new(Friction::new(holder, lengths, plan)),
        Part::Steps => {
            let friction = report
                .friction
                .measured()
                .ok_or("the friction is not known")?;
            Box::new(Steps::new(holder, lengths, plan, friction)?)
        }
        Part::LightGrip | Part::FirmGrip => Box::new(Stiffness::new(part, plan, tip)),
        Part::Scale => Box::new(Scale::new(plan, tip)),
    })
}
