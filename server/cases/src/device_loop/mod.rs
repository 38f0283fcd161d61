//! Closed loop of a hand, a haptic device with its door, a link and the simulation.
//!
//! The device has an apparent mass, viscous damping, Coulomb friction, encoders with a step, a driver with a latency and
//! a rate of its own. The figures are those of the device's model file, varied by 30 %; [`figures`] names all others.
//! Every wrench passes the real door. The coupling is the softer of scene and device, as client and server choose it.
//!
//! The hand follows the script of a hard case up to a moment in contact and then stays. The hand has no tremor: what
//! swings after a second is a limit cycle of the loop. The criterion is [`LIMIT_N`] above 20 Hz.

pub mod figures;
mod filter;
mod held;
mod machine;
pub mod onset;
mod person;
mod plant;
mod rests;
pub mod sweep;

use sulcus_core::{Coupling, Scene, TickInput};
use sulcus_haptics::model::{LOOP_DELAY_S, shipped_for};
use sulcus_haptics::{DeviceModel, PassivityParams};

use crate::comparison::by_hand;
use crate::table::{Case, Driver};
use figures::{Grip, Variation};
use machine::Machine;
use person::Person;
pub use rests::Rests;

/// Largest limit cycle above 20 Hz, newtons rms.
pub const LIMIT_N: f64 = 0.05;
/// Time from the hand's rest to the window in which the force is judged, seconds.
const SETTLE_S: f64 = 1.0;
/// Length of the window, seconds.
const WINDOW_S: f64 = 0.5;
/// Devices of the closed loop: library, and model as the library reports it.
pub const DEVICES: [(&str, &str); 5] = [
    ("openhaptics", "Touch"),
    ("openhaptics", "Touch X"),
    ("haply", "inverse3"),
    ("openhaptics", "Premium 1.5"),
    ("openhaptics", "Premium 3.0 6DOF"),
];

/// Models of [`DEVICES`].
///
/// # Panics
/// A model is not shipped, which the tests exclude.
pub fn devices() -> Vec<DeviceModel> {
    let shipped = |&(library, model): &(&str, &str)| {
        shipped_for(library, model).unwrap_or_else(|| panic!("no model `{model}` of {library}"))
    };
    DEVICES.iter().map(shipped).collect()
}

/// Loop of a device.
#[derive(Clone, Copy, Debug)]
pub struct Setup<'a> {
    /// Figures of the device.
    pub model: &'a DeviceModel,
    /// Factors of these figures in the loop. The coupling is chosen from the unvaried figures.
    pub variation: Variation,
    /// Grip of the hand.
    pub grip: Grip,
    /// Round-trip delay of the link, ticks. The way to the server takes the larger half.
    pub delay_ticks: u32,
    /// Factor of the chosen coupling; 1 is the choice.
    pub factor: f64,
    /// Passivity controller of the door; `None` for that of the device's model.
    pub passivity: Option<PassivityParams>,
}

impl<'a> Setup<'a> {
    /// Loop of a device with its figures, light grip, a link without delay and the chosen coupling.
    pub fn nominal(model: &'a DeviceModel) -> Self {
        Self {
            model,
            variation: Variation::NOMINAL,
            grip: Grip::Light,
            delay_ticks: 0,
            factor: 1.0,
            passivity: None,
        }
    }
}

/// Result of a loop after the hand's rest, SI units. Two hands give the larger value.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Looped {
    /// Coupling of the first tool in translation, N/m.
    pub n_per_m: f64,
    /// Coupling of the first tool in rotation, N m/rad.
    pub nm_per_rad: f64,
    /// Root mean square of the displayed force above 20 Hz, newtons.
    pub buzz_n: f64,
    /// Root mean square of the displayed force about its mean, newtons: a swing of any frequency, and a drift.
    pub swing_n: f64,
    /// Frequency of the fast part, Hz.
    pub hertz: f64,
    /// Mean displayed force, newtons.
    pub force_n: f64,
    /// Mean force of the simulation within the limits of the door, newtons. The passivity controller takes the
    /// difference.
    pub sent_n: f64,
    /// Largest net energy that the displayed wrench put out since a contact began, in the whole run, joules.
    pub energy: f64,
    /// Share of the device's periods in the window in which the passivity controller acted.
    pub acted: f64,
    /// Share of the device's periods in the window in which the continuous limit reduced the force.
    pub limited: f64,
    /// Whether the door of every hand passed the whole force through the window.
    pub live: bool,
    /// Whether every displayed number was finite.
    pub finite: bool,
}

impl Looped {
    /// Whether the loop swings by more than the criterion allows.
    pub fn buzzes(&self) -> bool {
        // In this form a NaN buzzes.
        !(self.buzz_n <= LIMIT_N && self.finite)
    }
}

/// Coupling of each tool of `scene` in the hand of `model`, times `factor`: the softer of scene and device.
pub fn chosen(scene: &Scene, model: &DeviceModel, factor: f64) -> Vec<Coupling> {
    let device = model.coupling(scene.tick_s(), LOOP_DELAY_S, 1.0);
    let device = Coupling {
        n_per_m: device.n_per_m,
        nm_per_rad: device.nm_per_rad,
    };
    let of = |own: Coupling| {
        let softer = own.softer(device);
        let [least, most] = Coupling::N_PER_M;
        let [least_turning, most_turning] = Coupling::NM_PER_RAD;
        Coupling {
            n_per_m: (softer.n_per_m * factor).clamp(least, most),
            nm_per_rad: (softer.nm_per_rad * factor).clamp(least_turning, most_turning),
        }
    };
    scene.couplings().into_iter().map(of).collect()
}

/// Runs `case` with a device up to `rest_s` of its script, then with a still hand.
///
/// The disturbance of the case ends with the rest, because a disturbed input moves the force by itself.
///
/// # Panics
/// The case's scene takes no coupling of the device.
pub fn run(case: &Case, setup: &Setup<'_>, rest_s: f64) -> Looped {
    let scene = (case.scene)();
    let Driver::Closed(script, _) = by_hand(case).driver else {
        unreachable!("by a hand");
    };
    let mut person = Person::new(script(&scene), rest_s);
    let couplings = chosen(&scene, setup.model, setup.factor);
    let scene = scene
        .with_couplings(&couplings)
        .expect("couplings within their ranges");
    let mut machine = Machine::new(&scene, setup);
    for now in 0.. {
        let t = now as f64 * scene.tick_s();
        let targets = person.targets(t, scene.tick_s(), &machine.felt());
        let since = person.rested_s().map(|from| t - from);
        let disturb: fn(u64, &mut TickInput) = if since.is_none() {
            case.disturb
        } else {
            |_, _| ()
        };
        machine.tick(
            now,
            &targets,
            disturb,
            since.is_some_and(|since| since >= SETTLE_S),
        );
        if since.is_some_and(|since| since >= SETTLE_S + WINDOW_S) {
            break;
        }
    }
    Looped {
        n_per_m: couplings[0].n_per_m,
        nm_per_rad: couplings[0].nm_per_rad,
        ..machine.looped()
    }
}
