//! State machine of a measurement.

mod activity;

use sulcus_core::math::fmin;
use sulcus_core::{Vec3, Wrench};
use sulcus_haptics::{Sample, Wanted};

use super::holder::Holder;
use super::plan::{MOST_SCALE_N, Part, Plan};
use super::prompt::{Answer, Progress, Prompt};
use super::report::{Measured, Outcome};
use super::task::{Grip, Task, task};
use super::tip::{Tip, bounded};

/// Order of a measurement to the door, and its wish to the person.
#[derive(Clone, Debug, PartialEq)]
pub struct Order {
    /// Order to the door.
    pub wanted: Wanted,
    /// Prompt to the person; the same prompt again until it is answered.
    pub prompt: Option<Prompt>,
    /// Progress.
    pub progress: Progress,
    /// Whether the measurement is over. The order is then without force.
    pub is_done: bool,
}

/// Measurement of one device.
pub struct Measurement {
    plan: Plan,
    report: Measured,
    tip: Tip,
    holder: Holder,
    /// Index of the present stage.
    at: usize,
    grip: Grip,
    doing: Doing,
    prompt: Option<Prompt>,
    answer: Option<Answer>,
    presses: u32,
    /// Number of steps since the present activity began.
    steps: u32,
    attempts: u32,
    late: u32,
    force: Vec3,
}

enum Doing {
    /// The force waits for a button.
    Arming,
    /// The person changes the grip.
    Gripping(Grip),
    /// A stage.
    Working(Box<dyn Task>),
    /// Nothing.
    Over,
}

impl Measurement {
    /// Creates a measurement that waits for a button.
    pub fn new(plan: Plan) -> Self {
        let tip = Tip::new(2e-3 * plan.model.resolution_mm.value);
        let report = Measured {
            name: plan.model.name.clone(),
            library: plan.model.library.clone(),
            serial: plan.serial.clone(),
            rate: Outcome::nothing(),
            resolution_mm: Outcome::nothing(),
            friction: Outcome::nothing(),
            steps: Outcome::nothing(),
            light_grip: Outcome::nothing(),
            firm_grip: Outcome::nothing(),
            scale: Outcome::nothing(),
        };
        Self {
            holder: Holder::new(&tip, plan.most_n()),
            plan,
            report,
            tip,
            at: 0,
            grip: Grip::Hand,
            doing: Doing::Arming,
            prompt: None,
            answer: None,
            presses: 0,
            steps: 0,
            attempts: 0,
            late: 0,
            force: Vec3::zeros(),
        }
    }

    /// Takes the answer to the prompt of the last order.
    pub fn answer(&mut self, answer: Answer) {
        self.answer = Some(answer);
    }

    /// Takes a press of a key that replaces the device's button.
    pub fn press(&mut self) {
        self.presses = self.presses.wrapping_add(1);
    }

    /// Report so far.
    pub fn report(&self) -> &Measured {
        &self.report
    }

    /// Performs a step at `now_ns` with the newest sample. The loop calls it once per millisecond.
    pub fn step(&mut self, now_ns: u64, sample: &Sample) -> Order {
        if sample.present {
            self.tip.see(sample);
        }
        self.steps = self.steps.saturating_add(1);
        if self.answer == Some(Answer::Stop) {
            self.stop("the measurement was ended");
        }
        let force = match self.doing {
            Doing::Arming => self.arm(now_ns, sample),
            Doing::Gripping(grip) => self.take(grip, now_ns, sample),
            Doing::Working(_) => self.work(now_ns, sample),
            Doing::Over => Vec3::zeros(),
        };
        self.force = bounded(force, self.most_n());
        Order {
            wanted: Wanted {
                wrench: Wrench {
                    force: self.force,
                    torque: Vec3::zeros(),
                },
                heard_ns: Some(now_ns),
                leaving: matches!(self.doing, Doing::Over),
                presses: self.presses,
                ..Wanted::NOTHING
            },
            prompt: self.prompt.clone(),
            progress: self.progress(),
            is_done: matches!(self.doing, Doing::Over),
        }
    }

    /// Limit of the force now, newtons.
    fn most_n(&self) -> f64 {
        match self.part() {
            Some(Part::Scale) => fmin(MOST_SCALE_N, self.plan.continuous_n),
            _ => self.plan.most_n(),
        }
    }

    fn part(&self) -> Option<Part> {
        self.plan.parts.get(self.at).copied()
    }

    fn progress(&self) -> Progress {
        let share = match &self.doing {
            Doing::Working(task) => task.share().clamp(0.0, 1.0),
            _ => 0.0,
        };
        Progress {
            part: self.part(),
            finished: self.at,
            all: self.plan.parts.len(),
            share,
        }
    }

    /// Begins the next activity.
    fn go_on(&mut self) {
        let Some(part) = self.part() else {
            let held = self.grip == Grip::Free;
            self.begin(if held {
                Doing::Gripping(Grip::Hand)
            } else {
                Doing::Over
            });
            return;
        };
        let wanted = Grip::of(part);
        if wanted == self.grip {
            match task(part, &self.plan, &self.report, &self.holder, &self.tip) {
                Ok(task) => self.begin(Doing::Working(task)),
                Err(reason) => {
                    self.skip(&reason);
                    self.go_on();
                }
            }
        } else if self.grip == Grip::Free {
            self.begin(Doing::Gripping(Grip::Hand));
        } else {
            self.begin(Doing::Gripping(wanted));
        }
    }

    fn begin(&mut self, doing: Doing) {
        self.prompt = match &doing {
            Doing::Gripping(grip) => Some(grip.prompt()),
            _ => None,
        };
        if let Doing::Arming | Doing::Gripping(Grip::Light | Grip::Firm | Grip::Scale) = &doing {
            self.force = Vec3::zeros();
        }
        (self.answer, self.steps, self.late) = (None, 0, 0);
        self.doing = doing;
    }

    /// Notes why the present stage has no result, and passes to the next one.
    fn skip(&mut self, reason: &str) {
        self.attempts = 0;
        let Some(part) = self.part() else {
            return;
        };
        self.at += 1;
        let reason = reason.to_string();
        let report = &mut self.report;
        match part {
            Part::Rate => report.rate = Outcome::NotMeasured(reason),
            Part::Resolution => report.resolution_mm = Outcome::NotMeasured(reason),
            Part::Friction => report.friction = Outcome::NotMeasured(reason),
            Part::Steps => report.steps = Outcome::NotMeasured(reason),
            Part::LightGrip => report.light_grip = Outcome::NotMeasured(reason),
            Part::FirmGrip => report.firm_grip = Outcome::NotMeasured(reason),
            Part::Scale => report.scale = Outcome::NotMeasured(reason),
        }
    }

    /// Ends the measurement. Stages without a result get the reason.
    fn stop(&mut self, reason: &str) {
        while self.part().is_some() {
            self.skip(reason);
        }
        self.begin(Doing::Over);
    }
}
