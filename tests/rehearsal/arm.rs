//! Haptic device of a student: an arm with a grip, of a stand-in of the Haply service.

use std::cell::Cell;
use std::f64::consts::FRAC_1_SQRT_2;
use std::net::TcpListener;
use std::process::Command;
use std::time::Duration;

use sulcus_standin_haply::{
    ArmOptions, Buttons, GripOptions, Handedness, Log, Motion, Options, Point, Service, Turn,
};

/// Id of the arm.
pub const ARM: &str = "049D";
/// Id of the grip.
const GRIP: &str = "61576";
/// Distance between the port of the simulation channel and that of the events.
const EVENTS: u16 = 19;
/// Way of the hand down to the crown, metres. The tip rests 25 mm above the neck of the tooth.
const DOWN: f64 = 0.022;

/// Arm in the hand of a student.
pub struct Arm {
    service: Service,
    /// Height of the hand, metres.
    height: Cell<f64>,
}

impl Arm {
    /// An arm at rest. The grip holds the probe with its tip down.
    pub fn new() -> Self {
        let port = free();
        let mut arm = ArmOptions::new(ARM, Handedness::Right);
        arm.motion = held(0.0, 0.0);
        let mut grip = GripOptions::wireless(GRIP);
        grip.turn = Turn::Rest {
            at: [FRAC_1_SQRT_2, -FRAC_1_SQRT_2, 0.0, 0.0],
        };
        let options = Options {
            arms: vec![arm],
            grips: vec![grip],
            port: Some(port),
            events_port: Some(port + EVENTS),
            // In a school the service runs on the computer of its station, not on that of the class.
            realtime: true,
            ..Options::default()
        };
        Self {
            service: Service::start(options).expect("a service"),
            height: Cell::new(0.0),
        }
    }

    /// Gives the arm to a client.
    pub fn give(&self, client: &mut Command) {
        client
            .env("SULCUS_HAPLY", format!("127.0.0.1:{}", self.service.port()))
            .args(["--device", &format!("haply:{ARM}=right")]);
    }

    /// Presses and releases the button of the grip.
    fn click(&self) {
        for a in [true, false] {
            let buttons = Buttons {
                a,
                ..Buttons::default()
            };
            self.service.set_buttons(GRIP, buttons).expect("a grip");
            std::thread::sleep(Duration::from_millis(200));
        }
    }

    /// Moves the hand to the crown, or away from it, within two seconds.
    pub fn press(&self, down: bool) {
        let to = if down { -DOWN } else { 0.0 };
        let motion = held(self.height.replace(to), to);
        self.service.set_hand(ARM, motion).expect("an arm");
        std::thread::sleep(Duration::from_millis(2500));
    }

    /// Feels the crown: the button is pressed with the tool away from it. A busy machine can need a second attempt.
    pub fn feel(&self, newtons: f64) {
        for _ in 0..5 {
            self.press(false);
            self.click();
            self.press(true);
            if self.displayed() > newtons {
                return;
            }
        }
        panic!("no force at the arm");
    }

    /// Magnitude of the displayed force, newtons.
    pub fn displayed(&self) -> f64 {
        let arm = self.service.arm(ARM).expect("an arm");
        arm.displayed.iter().map(|x| x * x).sum::<f64>().sqrt()
    }

    /// Ends the service.
    pub fn stop(self) -> Log {
        self.service.stop().expect("a log")
    }
}

/// Port that is free together with that of the events.
fn free() -> u16 {
    let both = || {
        let first = TcpListener::bind("127.0.0.1:0").ok()?;
        let port = first.local_addr().ok()?.port();
        TcpListener::bind(("127.0.0.1", port.checked_add(EVENTS)?)).ok()?;
        Some(port)
    };
    (0..100).find_map(|_| both()).expect("two free ports")
}

/// Hand on a spring that moves between two heights, metres, within two seconds.
fn held(from: f64, to: f64) -> Motion {
    let at = |t_s: f64, up: f64| Point {
        t_s,
        at: [0.0, 0.0, up],
    };
    Motion::Held {
        anchor: Box::new(Motion::Path {
            points: vec![at(0.0, from), at(2.0, to)],
            repeat: false,
        }),
        mass_kg: 0.12,
        stiffness_n_per_m: 300.0,
        damping_n_s_per_m: 8.0,
    }
}
