//! Devices of both hands, and their motions.

use std::f64::consts::FRAC_PI_2;

use sulcus_standins::pose::Pose;
use sulcus_standins::setup::{DeviceSetup, Grip, Hand, Motion, Setup};

use crate::messages::DEVICES;

/// Slot of the probe, in the hand of the omega.6.
pub const PROBE: usize = 0;
/// Slot of the mirror, in the hand of the Touch.
pub const TOUCH: usize = 1;

/// Device box of a hand.
pub struct DeviceBox {
    /// Name on the command line.
    pub name: &'static str,
    /// Number in the controller's settings.
    pub device: usize,
    /// Period, microseconds.
    pub period_us: f64,
    /// Axes of the driver that are x, y and z of the base.
    pub axes: [usize; 3],
}

/// Device boxes by the slots of their tools.
pub const BOXES: [DeviceBox; 2] = [
    DeviceBox {
        name: DEVICES[PROBE],
        device: 1,
        period_us: 250.0,
        // The driver's x is toward the person, y to the right, z up.
        axes: [1, 2, 0],
    },
    DeviceBox {
        name: DEVICES[TOUCH],
        device: 0,
        period_us: 1000.0,
        axes: [0, 1, 2],
    },
];

/// Length of a cycle of both hands, seconds.
const CYCLE_S: f64 = 4.0;
/// Way past the first contact, metres.
const BEYOND: f64 = 3e-3;

/// Pose of a hand at `height` above the middle of the workspace. The tip of the tool points down.
fn held(of_box: &DeviceBox, height: f64) -> Pose {
    let along = |axis: usize| {
        let mut v = [0.0; 3];
        v[of_box.axes[axis]] = 1.0;
        v
    };
    Pose::at(along(1).map(|x| x * height)).turned(along(0), -FRAC_PI_2)
}

/// Both devices at rest.
pub fn at_rest() -> Setup {
    let rest = |tool: usize| Hand::rest(held(&BOXES[tool], 0.0));
    Setup::new(vec![
        DeviceSetup::touch("Left Device", "L1").with_hand(rest(TOUCH)),
        DeviceSetup::omega6(1234).with_hand(rest(PROBE)),
    ])
}

/// Motions of both hands, which touch after `drops` metres. In a cycle of 4 s the probe presses alone, both press, and
/// the mirror presses alone.
pub fn pressing(drops: &[f64; 2], seconds: u64) -> [Hand; 2] {
    std::array::from_fn(|tool| {
        let of_box = &BOXES[tool];
        let depth = -(drops[tool] + BEYOND);
        let mut points = vec![(0.0, held(of_box, 0.0))];
        let mut from_s = 0.2 + 1.5 * tool as f64;
        while from_s < seconds as f64 {
            for (after_s, height) in [(0.0, 0.0), (0.7, depth), (2.1, depth), (2.4, 0.0)] {
                points.push((from_s + after_s, held(of_box, height)));
            }
            from_s += CYCLE_S;
        }
        let grip = Grip {
            stiffness: 300.0,
            damping: 8.0,
            turn_stiffness: 3.0,
            turn_damping: 0.04,
            ..Grip::light()
        };
        Hand::held(Motion::Path(points), grip)
    })
}
