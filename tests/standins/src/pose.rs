//! Poses of a handle: position and rotation in the device's own frame.

use serde::{Deserialize, Serialize};

/// A vector of three numbers.
pub type V3 = [f64; 3];

/// A rotation matrix, rows first.
pub type M3 = [[f64; 3]; 3];

/// A pose of the handle in the device's own frame, as the vendor defines the axes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    /// Position of the gimbal centre in m.
    pub position: V3,
    /// Rotation as a unit quaternion w, x, y, z.
    pub rotation: [f64; 4],
}

impl Default for Pose {
    fn default() -> Self {
        Self::at([0.0; 3])
    }
}

impl Pose {
    /// A pose at `position` in m without rotation.
    pub fn at(position: V3) -> Self {
        Self {
            position,
            rotation: [1.0, 0.0, 0.0, 0.0],
        }
    }

    /// The same position, turned by `angle` rad about `axis`.
    pub fn turned(self, axis: V3, angle: f64) -> Self {
        let length = norm(axis).max(1e-12);
        let (s, c) = (angle / 2.0).sin_cos();
        let turn = [
            c,
            axis[0] / length * s,
            axis[1] / length * s,
            axis[2] / length * s,
        ];
        Self {
            rotation: multiply(turn, self.rotation),
            ..self
        }
    }

    /// The rotation as a matrix, rows first; it turns vectors of the handle into the device's frame.
    pub fn matrix(&self) -> M3 {
        let [w, x, y, z] = self.rotation;
        [
            [
                1.0 - 2.0 * (y * y + z * z),
                2.0 * (x * y - w * z),
                2.0 * (x * z + w * y),
            ],
            [
                2.0 * (x * y + w * z),
                1.0 - 2.0 * (x * x + z * z),
                2.0 * (y * z - w * x),
            ],
            [
                2.0 * (x * z - w * y),
                2.0 * (y * z + w * x),
                1.0 - 2.0 * (x * x + y * y),
            ],
        ]
    }
}

/// Length of a vector.
pub fn norm(v: V3) -> f64 {
    (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt()
}

/// Sum of `a` and `b` times `s`.
pub fn add(a: V3, b: V3, s: f64) -> V3 {
    [a[0] + b[0] * s, a[1] + b[1] * s, a[2] + b[2] * s]
}

/// Difference of `a` and `b`.
pub fn sub(a: V3, b: V3) -> V3 {
    add(a, b, -1.0)
}

/// `v` times `s`.
pub fn scale(v: V3, s: f64) -> V3 {
    [v[0] * s, v[1] * s, v[2] * s]
}

/// `v`, shortened to the length `limit`.
pub fn clamp(v: V3, limit: f64) -> V3 {
    let length = norm(v);
    if length > limit {
        scale(v, limit / length)
    } else {
        v
    }
}

/// Product of two quaternions w, x, y, z.
pub fn multiply(a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
    [
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    ]
}

/// Quaternion of length one; no rotation for a quaternion of length zero.
pub fn unit(q: [f64; 4]) -> [f64; 4] {
    let length = q.iter().map(|c| c * c).sum::<f64>().sqrt();
    if length < 1e-12 {
        return [1.0, 0.0, 0.0, 0.0];
    }
    q.map(|c| c / length)
}

/// Rotation vector in rad that turns `from` into `to` on the shorter way.
pub fn turn_between(from: [f64; 4], to: [f64; 4]) -> V3 {
    let back = [from[0], -from[1], -from[2], -from[3]];
    let mut d = multiply(to, back);
    if d[0] < 0.0 {
        d = d.map(|c| -c);
    }
    let axis = [d[1], d[2], d[3]];
    let s = norm(axis);
    if s < 1e-12 {
        return [0.0; 3];
    }
    scale(axis, 2.0 * s.atan2(d[0]) / s)
}
