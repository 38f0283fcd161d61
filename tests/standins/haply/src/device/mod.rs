//! Simulated devices.

mod arm;
mod config;
mod grip;
mod motion;
mod options;

pub use arm::ArmView;
pub(crate) use arm::{Arm, Claim, Forces};
pub(crate) use config::Config;
pub(crate) use grip::Grip;
pub(crate) use motion::norm;
pub use motion::{Motion, Point, Turn};
pub use options::{
    ArmKind, ArmOptions, ArmStatus, Buttons, GripArray, GripOptions, Handedness, Mechanics,
};
