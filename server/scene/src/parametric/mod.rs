//! Shapes from a handful of numbers: a tooth and a probe that need no data and no licence.

mod blend;
pub mod molar;
pub mod polygonise;
pub mod probe;
mod tube;

pub use molar::Molar;
pub use probe::Probe;
