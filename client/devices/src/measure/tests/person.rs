//! Person in front of a simulated device, and the lock-step of device, loop and person.

use sulcus_core::math::norm;
use sulcus_haptics::device::{HandInfo, Reported};
use sulcus_haptics::model::shipped_for;
use sulcus_haptics::{HandEnd, port};

use super::device::{Hand, Simulated, Truth};
use crate::measure::{Answer, LOOP_NS, Measured, Measurement, Order, Part, Plan, Prompt};

/// Number of steps of the loop after which the person answers.
const THINKS: u32 = 400;

/// Plan for a device, with limits that no test device reaches.
pub fn plan(truth: &Truth) -> Plan {
    let info = HandInfo {
        library: "openhaptics",
        model: "Touch".into(),
        serial: "TEST-7".into(),
        motion_dof: 6,
        force_axes: 3,
        torque_axes: 0,
        period_ns: truth.period_ns,
        reported: Reported {
            continuous_n: Some(3.0),
            ..Reported::default()
        },
    };
    let mut model = shipped_for("openhaptics", "Touch").expect("a Touch");
    model.continuous_force_n.value = 2.5;
    Plan {
        most_stiffness: 8000.0,
        ..Plan::new(&info, &model)
    }
}

/// Device, loop and person.
pub struct Bench {
    pub device: Simulated,
    pub end: HandEnd,
    pub measurement: Measurement,
    /// Prompts in their order.
    pub prompts: Vec<Prompt>,
    /// Largest force outside of the stage with the scale.
    pub most_n: f64,
    pub refuses: Option<Part>,
    waited: u32,
    pub steps: u64,
}

impl Bench {
    pub fn new(truth: &Truth, plan: Plan) -> Self {
        let (port, end) = port::door(plan.rules());
        let mut device = Simulated::new(truth, port);
        device.plant.hand = Some(Hand::light(device.plant.x));
        Self {
            device,
            end,
            measurement: Measurement::new(plan),
            prompts: Vec::new(),
            most_n: 0.0,
            refuses: None,
            waited: 0,
            steps: 0,
        }
    }

    /// One step of the loop, with all periods of the device in it.
    pub fn step(&mut self) -> Order {
        for _ in 0..LOOP_NS / self.device.plant.truth.period_ns {
            self.device.period();
        }
        let order = self
            .measurement
            .step(self.device.now_ns + 20_000, &self.end.sample());
        self.end.order(&order.wanted);
        if order.progress.part != Some(Part::Scale) {
            self.most_n = self.most_n.max(norm(&order.wanted.wrench.force));
        }
        self.device.buttons = 0;
        match &order.prompt {
            Some(prompt) => self.prompted(prompt, &order),
            None => self.waited = 0,
        }
        self.steps += 1;
        order
    }

    fn prompted(&mut self, prompt: &Prompt, order: &Order) {
        if self.waited == 0 {
            self.prompts.push(prompt.clone());
        }
        self.waited += 1;
        if self.waited < THINKS {
            return;
        }
        self.waited = 0;
        let plant = &mut self.device.plant;
        let answer = match prompt {
            Prompt::PressButton => {
                self.device.buttons = 1;
                return;
            }
            _ if order.progress.part.is_some() && order.progress.part == self.refuses => {
                Answer::Skip
            }
            Prompt::HoldNothing => {
                plant.hand = None;
                Answer::Ready
            }
            Prompt::TakeHandle | Prompt::HoldLightly => {
                plant.hand = Some(Hand::light(plant.x));
                Answer::Ready
            }
            Prompt::HoldFirmly => {
                plant.hand = Some(Hand::firm(plant.x));
                Answer::Ready
            }
            Prompt::PutOnScale => {
                plant.hand = None;
                plant.scale = Some(plant.x.y + 1e-4);
                Answer::Ready
            }
            Prompt::ReadScale { .. } => Answer::Grams(plant.on_scale() / 9.80665e-3),
        };
        self.measurement.answer(answer);
    }

    /// Runs to the end.
    pub fn run(&mut self) -> Measured {
        for _ in 0..3_000_000 {
            if self.step().is_done {
                return self.measurement.report().clone();
            }
        }
        panic!("no end: {:?}", self.measurement.report());
    }
}
