//! Hands without a force device.

pub mod board;
pub mod guide;
pub mod hands;
pub mod keys;
pub mod limits;
pub mod motion;
pub mod one;
pub mod pose;
pub mod smooth;
pub mod spacenav;
