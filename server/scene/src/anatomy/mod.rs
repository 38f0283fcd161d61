//! Anatomy of the mouth: teeth, gingivae, jaw and tongue, from dimensions, from a patient's chart or from meshes.
//!
//! Imports run one way: `compile` knows this folder, and this folder knows `file`, whose entries have the dimensions.

pub mod arch;
pub mod collar;
pub mod first_molar;
pub mod jaw;
pub mod mesh_tissue;
pub mod molar_gingiva;
pub mod mouth;
pub mod patient;
pub mod sections;
pub mod sulcus;
pub mod tongue;
pub mod tooth;

pub use crate::file::{Molar, Pocket, Tongue, ToothSizes};
pub use molar_gingiva::MolarCollar;
pub use tooth::{Furcation, Tooth};
