//! Tools without a force device: mouse and keyboard, a 3D mouse or a gamepad move them in six degrees of freedom.
//!
//! Everything works except the feeling, and the screen says so ([`crate::panel::Warning::NoForce`],
//! [`crate::strings::HandWords`]). No module opens a window or reads a clock.
//!
//! | step | type | thread |
//! |---|---|---|
//! | keys, counts, deflections | [`Board`], [`spacenav`], [`Sticks`] | window |
//! | axes of the picture, scale, precision, clutch, choice of the hand | [`Hands`] | window |
//! | workspace, speed, backlog | [`Hand`] | device loop |
//! | lead over the graphic tool | [`Guide`] | device loop |
//! | smooth pose at the rate of the loop | [`Smoother`] | device loop |
//!
//! [`Shared`] joins the threads, [`HandsOnScreen`] is the device.

mod board;
mod device;
mod guide;
mod hands;
pub mod keys;
mod limits;
mod motion;
mod one;
pub mod pad;
mod pose;
mod shared;
mod smooth;
pub mod spacenav;
mod sticks;
#[cfg(test)]
mod tests;

pub use board::Board;
pub use device::{Felt, HandsOnScreen, Held};
pub use guide::{Coupling, Guide, Lead};
pub use hands::{Hands, Scales, Steady};
pub use limits::Limits;
pub use motion::{Frame, Motion};
pub use one::Hand;
pub use pose::HandPose;
pub use shared::Shared;
pub use smooth::{Smoother, SmootherRule};
pub use sticks::Sticks;
