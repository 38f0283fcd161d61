//! Motions of a hand and rotations of a grip.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use crate::{Quaternion, Vector};

/// Motion of the hand at an arm, in the frame of the arm and in m.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Motion {
    /// At rest; a force does not move the hand.
    Rest {
        /// Position.
        at: Vector,
    },
    /// Sine on every axis; a force does not move the hand.
    Sinusoid {
        /// Middle of the motion.
        centre: Vector,
        /// Greatest distance from the middle, by axis.
        amplitude: Vector,
        /// Frequency in Hz.
        hz: f64,
    },
    /// Path through points with least jerk: speed and acceleration are zero at every point.
    Path {
        /// Points in the order of time.
        points: Vec<Point>,
        /// True where the path starts again after its last point.
        repeat: bool,
    },
    /// Jump in no time.
    Jump {
        /// Position before the jump.
        from: Vector,
        /// Position from the jump on.
        to: Vector,
        /// Time of the jump since the start of the motion, in ms.
        after_ms: f64,
    },
    /// Mass on a spring and a damper; the force of the arm acts on the mass.
    Held {
        /// Place that the spring pulls to; `Held` inside of `Held` counts as its own anchor.
        anchor: Box<Motion>,
        /// Mass of the hand, in kg.
        mass_kg: f64,
        /// Stiffness of the spring, in N/m.
        stiffness_n_per_m: f64,
        /// Damping of the hand, in N s/m.
        damping_n_s_per_m: f64,
    },
}

/// A point of a path.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Point {
    /// Time since the start of the path, in s.
    pub t_s: f64,
    /// Position.
    pub at: Vector,
}

impl Motion {
    /// Position in m and velocity in m/s at a time since the start; for `Held` those of its anchor.
    pub(crate) fn sample(&self, t_s: f64) -> (Vector, Vector) {
        match self {
            Self::Rest { at } => (*at, [0.0; 3]),
            Self::Sinusoid {
                centre,
                amplitude,
                hz,
            } => {
                let (sin, cos) = (TAU * hz * t_s).sin_cos();
                let position = std::array::from_fn(|i| centre[i] + amplitude[i] * sin);
                (position, amplitude.map(|a| a * TAU * hz * cos))
            }
            Self::Path { points, repeat } => path(points, *repeat, t_s),
            Self::Jump { from, to, after_ms } => {
                let at = if t_s * 1000.0 < *after_ms { from } else { to };
                (*at, [0.0; 3])
            }
            Self::Held { anchor, .. } => anchor.sample(t_s),
        }
    }
}

fn path(points: &[Point], repeat: bool, t_s: f64) -> (Vector, Vector) {
    let (Some(first), Some(last)) = (points.first(), points.last()) else {
        return ([0.0; 3], [0.0; 3]);
    };
    let length = last.t_s - first.t_s;
    let t = if repeat && length > 0.0 {
        first.t_s + (t_s - first.t_s).rem_euclid(length)
    } else {
        t_s
    };
    for pair in points.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        let span = b.t_s - a.t_s;
        if t >= a.t_s && t < b.t_s && span > 0.0 {
            let s = (t - a.t_s) / span;
            let share = s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
            let slope = 30.0 * s * s * (1.0 - s) * (1.0 - s) / span;
            let position = std::array::from_fn(|i| a.at[i] + (b.at[i] - a.at[i]) * share);
            return (
                position,
                std::array::from_fn(|i| (b.at[i] - a.at[i]) * slope),
            );
        }
    }
    let at = if t < first.t_s { first.at } else { last.at };
    (at, [0.0; 3])
}

/// Rotation of a grip.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Turn {
    /// At rest.
    Rest {
        /// Rotation.
        at: Quaternion,
    },
    /// Rotation about an axis at a constant rate.
    Spin {
        /// Axis; its length does not matter.
        axis: Vector,
        /// Rate in rad/s.
        rad_per_s: f64,
    },
    /// Sine about an axis.
    Rock {
        /// Axis; its length does not matter.
        axis: Vector,
        /// Greatest angle in rad.
        amplitude_rad: f64,
        /// Frequency in Hz.
        hz: f64,
    },
}

impl Turn {
    /// Rotation at a time since the start.
    pub(crate) fn sample(&self, t_s: f64) -> Quaternion {
        match self {
            Self::Rest { at } => *at,
            Self::Spin { axis, rad_per_s } => about(*axis, rad_per_s * t_s),
            Self::Rock {
                axis,
                amplitude_rad,
                hz,
            } => about(*axis, amplitude_rad * (TAU * hz * t_s).sin()),
        }
    }
}

fn about(axis: Vector, angle: f64) -> Quaternion {
    let length = norm(axis);
    if length == 0.0 {
        return [1.0, 0.0, 0.0, 0.0];
    }
    let (sin, cos) = (angle / 2.0).sin_cos();
    [
        cos,
        axis[0] / length * sin,
        axis[1] / length * sin,
        axis[2] / length * sin,
    ]
}

/// Length of a vector.
pub(crate) fn norm(v: Vector) -> f64 {
    (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt()
}
