//! A patient's lower jaw as a chart: which teeth are there and what is prescribed at each site. A TOML file, written by hand
//! or generated from a seed ([`generate`]).
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
//! A tooth that is not named is there and healthy. Keys that are left out, a side of a tooth among them, have a healthy tooth's
//! values. Third molars may stand in `missing`: the model has none.

mod check;
mod generate;
mod sides;

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::file::FileError;

pub use generate::{Condition, generate};
pub use sides::Sides;

/// FDI numbers of third molars. No mouth of this model has them.
pub const THIRD_MOLARS: [u8; 4] = [18, 28, 38, 48];

/// FDI numbers of the lower teeth that are modelled, from the right second molar round to the left one.
pub const LOWER: [u8; 14] = [47, 46, 45, 44, 43, 42, 41, 31, 32, 33, 34, 35, 36, 37];

/// A patient.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Patient {
    /// What the patient is called. Never a person's name.
    pub name: String,
    /// FDI numbers of the teeth that are missing.
    #[serde(default)]
    pub missing: Vec<u8>,
    /// Teeth that differ from healthy ones.
    #[serde(default, rename = "tooth")]
    pub teeth: Vec<ToothChart>,
}

/// What is charted of one tooth.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ToothChart {
    /// FDI number.
    pub fdi: u8,
    /// Probing depths, mm.
    #[serde(default = "healthy_depth", deserialize_with = "sides::depth")]
    pub depth_mm: Sides<f64>,
    /// How far the margin lies below the cemento-enamel junction, mm; negative above it.
    #[serde(default = "healthy_recession", deserialize_with = "sides::recession")]
    pub recession_mm: Sides<f64>,
    /// Whether a site bleeds after light probing.
    #[serde(default, deserialize_with = "sides::bleeding")]
    pub bleeding: Sides<bool>,
    /// How inflamed the gingiva is, 0 to 1: inflamed tissue is softer.
    #[serde(default)]
    pub inflammation: f64,
    /// Furcation by its entrances; for molars.
    #[serde(default)]
    pub furcation: Furcations,
    /// Mobility by Miller, 0 to 3. For the chart: teeth do not move here.
    #[serde(default)]
    pub mobility: u8,
}

/// Furcation of a lower molar (Hamp 1975): 0 none, 1 under 3 mm in, 2 more but not through, 3 through.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Furcations {
    /// From the cheek's side.
    pub buccal: u8,
    /// From the tongue's side.
    pub lingual: u8,
}

/// Depths of a healthy tooth, mm.
pub fn healthy_depth() -> Sides<f64> {
    let side = [3.0, 2.0, 3.0];
    Sides {
        buccal: side,
        lingual: side,
    }
}

/// Margins of a healthy tooth: about 2 mm above the CEJ mid-facially, more beside a neighbour, mm (Wang 2022, Appl. Sci. 12:7015).
pub fn healthy_recession() -> Sides<f64> {
    let side = [-2.5, -2.0, -2.5];
    Sides {
        buccal: side,
        lingual: side,
    }
}

impl ToothChart {
    /// A healthy tooth.
    pub fn healthy(fdi: u8) -> Self {
        Self {
            fdi,
            depth_mm: healthy_depth(),
            recession_mm: healthy_recession(),
            bleeding: Sides::default(),
            inflammation: 0.0,
            furcation: Furcations::default(),
            mobility: 0,
        }
    }
}

impl Patient {
    /// A patient whose teeth are all there and healthy.
    pub fn healthy(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            missing: Vec::new(),
            teeth: Vec::new(),
        }
    }

    /// The chart of a tooth; none where it is missing or no lower tooth of this model.
    pub fn tooth(&self, fdi: u8) -> Option<ToothChart> {
        if !LOWER.contains(&fdi) || self.missing.contains(&fdi) {
            return None;
        }
        let charted = self.teeth.iter().find(|tooth| tooth.fdi == fdi);
        Some(charted.cloned().unwrap_or_else(|| ToothChart::healthy(fdi)))
    }

    /// Parses and checks the text of a patient file; `file` is how messages call it.
    ///
    /// # Errors
    /// One sentence with file, key, value found and value expected.
    pub fn parse(text: &str, file: &Path) -> Result<Self, FileError> {
        let patient: Self = crate::file::from_toml(text, file)?;
        check::patient(&patient).map_err(|wrong| wrong.in_file(file))?;
        Ok(patient)
    }

    /// Reads and checks a patient file; also gives its text.
    ///
    /// # Errors
    /// As [`Patient::parse`].
    pub fn read(file: &Path) -> Result<(Self, String), FileError> {
        let text = std::fs::read_to_string(file).map_err(|source| FileError::Read {
            file: PathBuf::from(file),
            source,
        })?;
        Ok((Self::parse(&text, file)?, text))
    }

    /// The patient file's text.
    ///
    /// # Panics
    /// Never: a patient's values all have a TOML form.
    pub fn to_toml(&self) -> String {
        toml::to_string(self).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests;
