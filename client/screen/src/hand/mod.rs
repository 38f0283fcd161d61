//! Hands without a force device.

pub mod guide;
pub mod hands;
pub mod limits;
pub mod motion;
pub mod one;
pub mod pose;
pub mod smooth;
