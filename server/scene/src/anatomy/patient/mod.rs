//! A patient's lower jaw as a chart: teeth present, and the prescription of each site.
//!
//! The chart is a TOML file, written by hand or generated from a seed ([`generate`()]).
//!
//! ```toml
//! name = "patient 1"
//! missing = [46]
//!
//! [[tooth]]
//! fdi = 36
//! depth_mm.buccal = [5, 4, 4]          # mesio-, mid-, disto-
//! depth_mm.lingual = [4, 3, 4]
//! recession_mm.buccal = [-1, 0, -1]    # margin below the CEJ; negative above it
//! recession_mm.lingual = [-1, 0, -1]
//! bleeding.buccal = [true, false, false]
//! bleeding.lingual = [false, false, false]
//! inflammation = 0.4
//! furcation.buccal = 1                 # Hamp 1975: 0 to 3
//! ```
//!
//! A tooth without an entry is present and healthy. Omitted keys, also one side of a tooth, have a healthy tooth's
//! values.
//!
//! Third molars may be listed in `missing`; the model has none.

mod chart;
mod check;
mod generate;
mod printed;
mod read;
mod sides;

pub use crate::file::{Condition, LOWER};
pub use chart::{Furcations, Patient, THIRD_MOLARS, ToothChart};
pub use check::{DEPTH_MM, MOST_LOSS_MM, PatientFault, RECESSION_MM};
pub use generate::generate;
pub use printed::as_text;
pub use sides::{Sides, healthy_depth, healthy_recession};

#[cfg(test)]
mod tests;
