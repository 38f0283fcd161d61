use std::time::Duration;

use sulcus_haptics::device::Stop;
use sulcus_haptics::port;
use sulcus_link::clock::monotonic_ns;

use super::device::{Simulated, truth};
use super::person::plan;
use crate::measure::{Answer, Ask, Measurement, Outcome, Part, Plan, Prompt, run};

/// Person who answers each prompt at once and replaces the button by a key.
#[derive(Default)]
struct Quick {
    told: Vec<Prompt>,
    asked: Vec<Prompt>,
}

impl Ask for Quick {
    fn tell(&mut self, prompt: &Prompt) {
        self.told.push(prompt.clone());
    }

    fn ask(&mut self, prompt: &Prompt) -> Answer {
        self.asked.push(prompt.clone());
        Answer::Ready
    }

    fn pressed(&mut self) -> bool {
        self.told.len() > self.asked.len()
    }
}

#[test]
fn the_loop_asks_and_ends_without_force_when_it_is_told_to_stop() {
    let truth = truth(16);
    let plan = Plan {
        parts: vec![Part::Rate, Part::Friction],
        ..plan(&truth)
    };
    let (port, mut end) = port::door(plan.rules());
    let (over, stop) = (Stop::new(), Stop::new());
    let device_over = over.clone();
    let device = std::thread::spawn(move || {
        let mut device = Simulated::new(&truth, port);
        while !device_over.is_asked() {
            // The simulation follows the clock of the machine.
            device.now_ns = monotonic_ns() - truth.period_ns;
            device.period();
            std::thread::sleep(Duration::from_millis(1));
        }
        device
            .port
            .exchange(monotonic_ns(), Err(sulcus_haptics::Unready::Absent), 0)
    });
    let mut person = Quick::default();
    let mut seen = Vec::new();
    let asked = stop.clone();
    let mut progress = |progress: &crate::measure::Progress| {
        seen.push(*progress);
        if progress.share > 0.0 || seen.len() > 300 {
            asked.ask();
        }
    };
    let report = run(
        &mut end,
        Measurement::new(plan),
        &mut person,
        &mut progress,
        &stop,
    );
    assert_eq!(end.sample().displayed.force.norm(), 0.0);
    over.ask();
    device.join().expect("a device");
    assert!(
        person.told.contains(&Prompt::PressButton),
        "{:?}",
        person.told
    );
    assert!(
        person.asked.contains(&Prompt::HoldNothing),
        "{:?}",
        person.asked
    );
    assert!(matches!(report.rate, Outcome::NotMeasured(_)), "{report:?}");
    assert!(
        matches!(report.friction, Outcome::NotMeasured(_)),
        "{report:?}"
    );
}
