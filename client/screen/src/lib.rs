//! The student's screen.

pub mod readings;
pub mod text;
pub mod trainer;
