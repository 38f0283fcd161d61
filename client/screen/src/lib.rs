//! The student's screen.

pub mod panel;
pub mod readings;
pub mod strings;
pub mod text;
pub mod trainer;
