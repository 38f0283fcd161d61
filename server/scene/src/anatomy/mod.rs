//! The mouth: teeth, gingivae, jaw and tongue, from a handful of numbers, from a patient's chart or from meshes.

pub mod arch;
pub mod collar;
pub mod first_gingiva;
pub mod first_molar;
pub mod gingiva;
pub mod jaw;
pub mod mouth;
pub mod patient;
pub mod sections;
pub mod sulcus;
pub mod tongue;
pub mod tooth;

pub use first_gingiva::{Collar, Pocket};
pub use first_molar::Molar;
pub use tongue::Tongue;
pub use tooth::{Furcation, Tooth, ToothSizes};
