//! Types of a patient file.

use serde::{Deserialize, Serialize};

use super::sides;
use super::sides::{Sides, healthy_depth, healthy_recession};
use crate::file::LOWER;

/// FDI numbers of third molars. No mouth of this model has them.
pub const THIRD_MOLARS: [u8; 4] = [18, 28, 38, 48];

/// A patient.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Patient {
    /// Label of the patient. Never a person's name.
    pub name: String,
    /// FDI numbers of the teeth that are missing.
    #[serde(default)]
    pub missing: Vec<u8>,
    /// Teeth that differ from healthy ones.
    #[serde(default, rename = "tooth")]
    pub teeth: Vec<ToothChart>,
}

/// Chart of one tooth.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ToothChart {
    /// FDI number.
    pub fdi: u8,
    /// Probing depths, mm.
    #[serde(default = "healthy_depth", deserialize_with = "sides::depth")]
    pub depth_mm: Sides<f64>,
    /// Distance of the margin below the cemento-enamel junction, mm; negative above it.
    #[serde(default = "healthy_recession", deserialize_with = "sides::recession")]
    pub recession_mm: Sides<f64>,
    /// Whether a site bleeds after light probing.
    #[serde(default, deserialize_with = "sides::bleeding")]
    pub bleeding: Sides<bool>,
    /// Inflammation of the gingiva, 0 to 1. Inflamed tissue is softer.
    #[serde(default)]
    pub inflammation: f64,
    /// Degrees of furcation by entrance; for molars.
    #[serde(default)]
    pub furcation: Furcations,
    /// Mobility by Miller, 0 to 3. It is charted only: teeth do not move in this model.
    #[serde(default)]
    pub mobility: u8,
}

/// Furcation of a lower molar (Hamp 1975). 0: none; 1: less than 3 mm in; 2: further but not through; 3: through.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Furcations {
    /// Entrance at the cheek's side.
    pub buccal: u8,
    /// Entrance at the tongue's side.
    pub lingual: u8,
}

impl ToothChart {
    /// Returns a healthy tooth.
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
    /// Returns a patient with all teeth, all of them healthy.
    pub fn healthy(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            missing: Vec::new(),
            teeth: Vec::new(),
        }
    }

    /// Returns the chart of a tooth; `None` if it is missing or no lower tooth of this model.
    pub fn tooth(&self, fdi: u8) -> Option<ToothChart> {
        if !LOWER.contains(&fdi) || self.missing.contains(&fdi) {
            return None;
        }
        let charted = self.teeth.iter().find(|tooth| tooth.fdi == fdi);
        Some(charted.cloned().unwrap_or_else(|| ToothChart::healthy(fdi)))
    }

    /// Returns the text of the patient file.
    ///
    /// # Panics
    /// Never: all values of a patient have a TOML form.
    pub fn to_toml(&self) -> String {
        toml::to_string(self).unwrap_or_default()
    }
}
