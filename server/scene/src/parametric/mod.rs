//! Shapes from a handful of numbers: a tooth, a probe and a mirror that need no data and no licence.

pub mod arch;
pub(crate) mod blend;
pub mod collar;
pub mod gingiva;
pub mod jaw;
pub mod mirror;
pub mod molar;
pub mod polygonise;
pub mod probe;
pub mod sections;
pub mod tongue;
pub mod tooth;
mod tube;

pub use gingiva::{Collar, Pocket};
pub use mirror::Mirror;
pub use molar::Molar;
pub use probe::Probe;
pub use tongue::Tongue;
pub use tooth::{Furcation, Tooth, ToothSizes};
