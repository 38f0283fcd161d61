//! Entry of a whole mouth: `[mouth]`.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::file::gingiva::GingivaEntry;

/// FDI numbers of the modelled lower teeth, from the right second molar round to the left one.
pub const LOWER: [u8; 14] = [47, 46, 45, 44, 43, 42, 41, 31, 32, 33, 34, 35, 36, 37];

/// `[mouth]`: a patient's teeth with their gingivae.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct MouthEntry {
    /// Patient file, relative to the scene file. Without it a patient is generated.
    pub patient: Option<PathBuf>,
    /// Condition of a generated patient.
    pub condition: Condition,
    /// Seed of a generated patient.
    pub seed: u64,
    /// FDI numbers of the modelled teeth. Default: all teeth of the patient.
    pub teeth: Option<Vec<u8>>,
    /// Level of the teeth in contact.
    pub tooth_level: u8,
    /// Finest level of the teeth that is built.
    pub tooth_levels: u8,
    /// Width of the pockets at rest, mm. A real width is about 0.4; a probe's tip has 0.5.
    pub width_mm: f64,
    /// Thickness of the free margin, mm.
    pub crest_mm: f64,
    /// Thickness of the gingiva further down, mm.
    pub wall_mm: f64,
    /// Parameters of all gingivae that differ from the defaults. The patient gives the inflammation of each.
    pub gingiva: GingivaEntry,
}

impl Default for MouthEntry {
    fn default() -> Self {
        Self {
            patient: None,
            condition: Condition::default(),
            seed: 1,
            teeth: None,
            tooth_level: 3,
            tooth_levels: 4,
            width_mm: 0.4,
            crest_mm: 0.7,
            wall_mm: 1.3,
            gingiva: GingivaEntry::default(),
        }
    }
}

/// Condition of a generated patient. Depths are whole millimetres, as in a chart.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Condition {
    /// Depths of 1 to 3 mm, few sites bleed.
    Healthy,
    /// Swollen margins, depths of 2 to 4 mm, every other site bleeds, no attachment loss.
    Gingivitis,
    /// Attachment loss at several teeth: depths up to 7 mm, recession, furcations, sometimes a missing tooth.
    #[default]
    Periodontitis,
}

impl Condition {
    /// All conditions.
    pub const ALL: [Condition; 3] = [
        Condition::Healthy,
        Condition::Gingivitis,
        Condition::Periodontitis,
    ];

    /// Returns the name in files and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Condition::Healthy => "healthy",
            Condition::Gingivitis => "gingivitis",
            Condition::Periodontitis => "periodontitis",
        }
    }
}

impl std::str::FromStr for Condition {
    type Err = String;
    fn from_str(name: &str) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|c| c.name() == name);
        found.ok_or_else(|| {
            format!("condition is `{name}`, expected healthy, gingivitis or periodontitis")
        })
    }
}
