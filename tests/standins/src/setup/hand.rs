//! The hand of a user at a device.

use crate::pose::Pose;
use serde::{Deserialize, Serialize};

/// A hand: a motion, and how firmly the hand holds the handle.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Hand {
    /// Motion of the hand.
    pub motion: Motion,
    /// Grip of the handle. Without a grip the handle follows the motion exactly, whatever the motors do.
    pub grip: Option<Grip>,
}

/// Motion of a hand; time starts when the controller takes the motion.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub enum Motion {
    /// At rest.
    Rest(Pose),
    /// A smooth path through points with times in s, at rest at both ends.
    Path(Vec<(f64, Pose)>),
    /// A sinusoid about a pose.
    Sine {
        /// Pose in the middle.
        middle: Pose,
        /// Amplitude of the position in m.
        amplitude: [f64; 3],
        /// Amplitude of the rotation vector in rad.
        turn: [f64; 3],
        /// Frequency in Hz.
        hz: f64,
    },
    /// Jumps from pose to pose, again from the first after the last.
    Jumps {
        /// The poses.
        poses: Vec<Pose>,
        /// Time at each pose in s.
        period: f64,
    },
}

/// Grip of a handle: mass, spring and damper towards the motion of the hand. The motors act on the mass.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Grip {
    /// Mass of the hand in kg; the mass of the mechanics adds to it.
    pub mass: f64,
    /// Stiffness in N/m.
    pub stiffness: f64,
    /// Damping in N s/m.
    pub damping: f64,
    /// Inertia in kg m^2.
    pub inertia: f64,
    /// Stiffness of the rotation in N m/rad.
    pub turn_stiffness: f64,
    /// Damping of the rotation in N m s/rad.
    pub turn_damping: f64,
}

impl Grip {
    /// A light grip, as in probing.
    pub fn light() -> Self {
        Self {
            mass: 0.1,
            stiffness: 100.0,
            damping: 3.0,
            inertia: 1e-4,
            turn_stiffness: 0.3,
            turn_damping: 0.005,
        }
    }

    /// A firm grip, as in scaling.
    pub fn firm() -> Self {
        Self {
            mass: 0.3,
            stiffness: 600.0,
            damping: 12.0,
            inertia: 2e-4,
            turn_stiffness: 1.5,
            turn_damping: 0.02,
        }
    }
}

impl Hand {
    /// A hand at rest at `pose`; the handle does not move.
    pub fn rest(pose: Pose) -> Self {
        Self {
            motion: Motion::Rest(pose),
            grip: None,
        }
    }

    /// A hand that moves the handle exactly.
    pub fn exact(motion: Motion) -> Self {
        Self { motion, grip: None }
    }

    /// A hand that holds the handle with `grip`.
    pub fn held(motion: Motion, grip: Grip) -> Self {
        Self {
            motion,
            grip: Some(grip),
        }
    }
}
