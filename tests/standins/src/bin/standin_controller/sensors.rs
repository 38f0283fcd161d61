//! What a device measures of its handle.

use sulcus_standins::board::Traits;
use sulcus_standins::pose::{M3, Pose, V3, add, scale, sub};
use sulcus_standins::setup::DeviceSetup;

/// Steps of 1 ms in the velocity window.
const WINDOW: usize = 20;

/// Sensors of a device, and the faults of them.
#[derive(Default)]
pub struct Sensors {
    /// Offset of the measured position in m after jumps.
    pub jump: V3,
    /// True: measured positions are NaN.
    pub nan: bool,
    past: [V3; WINDOW],
    /// Steps in the window so far.
    pub filled: usize,
    /// Velocity over the window in m/s.
    pub velocity: V3,
}

impl Sensors {
    /// Measured position of a handle at `position`, with a further offset.
    pub fn position(&self, device: &DeviceSetup, position: V3, offset: V3) -> V3 {
        if self.nan {
            return [f64::NAN; 3];
        }
        let moved = add(add(position, self.jump, 1.0), offset, 1.0);
        moved.map(|c| quantise(c, device.step))
    }

    /// Takes a measured position, once per ms.
    pub fn record(&mut self, position: V3) {
        if self.filled > 0 {
            let oldest = self.past[if self.filled < WINDOW {
                0
            } else {
                self.filled % WINDOW
            }];
            let span = self.filled.min(WINDOW) as f64 * 1e-3;
            self.velocity = scale(sub(position, oldest), 1.0 / span);
        }
        self.past[self.filled % WINDOW] = position;
        self.filled += 1;
    }

    /// Forgets the window.
    pub fn restart(&mut self) {
        self.filled = 0;
        self.velocity = [0.0; 3];
    }

    /// Measured rotation. A device without a wrist measures none.
    pub fn rotation(&self, device: &DeviceSetup, pose: &Pose) -> M3 {
        if device.traits.wrist == 0.0 {
            return Pose::default().matrix();
        }
        if self.nan {
            return [[f64::NAN; 3]; 3];
        }
        let angles = angles(&pose.matrix()).map(|a| quantise(a, device.angle_step));
        if device.angle_step == 0.0 {
            pose.matrix()
        } else {
            matrix(angles)
        }
    }
}

fn quantise(value: f64, step: f64) -> f64 {
    if step > 0.0 {
        (value / step).round() * step
    } else {
        value
    }
}

/// Angles about z, y, x whose rotations in this order make the matrix.
pub fn angles(r: &M3) -> V3 {
    let y = (-r[2][0]).clamp(-1.0, 1.0).asin();
    [r[1][0].atan2(r[0][0]), y, r[2][1].atan2(r[2][2])]
}

/// The matrix of [`angles`].
fn matrix([z, y, x]: V3) -> M3 {
    Pose::default()
        .turned([1.0, 0.0, 0.0], x)
        .turned([0.0, 1.0, 0.0], y)
        .turned([0.0, 0.0, 1.0], z)
        .matrix()
}

/// Joint angles of a simple arm: turret, thigh, shin, with its base behind the workspace.
pub fn joints(position: V3, traits: &Traits) -> V3 {
    let back = 0.1 + traits.reach[5] - traits.reach[2];
    let [x, y, z] = position;
    [x.atan2(back + z), y.atan2(back + z), (z / back).atan()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use sulcus_standins::pose::norm;

    #[test]
    fn angles_and_matrix_are_inverse() {
        let pose = Pose::default().turned([1.0, 2.0, -0.5], 0.9);
        let r = pose.matrix();
        let back = matrix(angles(&r));
        for i in 0..3 {
            assert!(norm(sub(r[i], back[i])) < 1e-12);
        }
    }

    #[test]
    fn the_velocity_of_a_steady_motion_is_right() {
        let mut sensors = Sensors::default();
        for i in 0..100 {
            sensors.record([0.0, 0.0, f64::from(i) * 1e-4]);
        }
        assert!(
            (sensors.velocity[2] - 0.1).abs() < 1e-9,
            "{:?}",
            sensors.velocity
        );
    }
}
