//! Parametric instruments: periodontal probe and mouth mirror.

pub mod drawn;
pub mod marking;
pub mod mirror;
pub mod probe;
mod tube;

pub use marking::Marking;
pub use mirror::Mirror;
pub use probe::Probe;
