//! Exercise, the task of a session: a TOML file. A recording contains the same text, with seed and length, so that a
//! replay knows the task.
//!
//! ```toml
//! name = "probing"                # letters, digits, - _ /
//! kind = "probing"                # crown, probing, retraction, bimanual, free
//! about = "short description"
//! task = "text for the student"
//! scene = "pocket"                # name of a built-in scene
//! duration_s = 20.0
//!
//! [[zone]]                        # zones to visit, in order
//! tooth = 36                      # FDI
//! sites = ["distobuccal", "buccal", "mesiobuccal"]
//!
//! [probing]                       # may be left out
//! force_n = [0.2, 0.25]           # force on the floor at which a depth is read
//! proximal_tilt_deg = [10, 25]    # tilt into the col at proximal sites
//! mid_tilt_deg = 15               # largest tilt in the middle of a side
//! step_mm = 1                     # distance between two touches of the floor
//!
//! [target]                        # to be seen past the tongue
//! tooth = 36
//! eye_mm = [250, -120, 260]       # world axes: x anterior, y patient's left, z up
//! visible = 0.7                   # least free share
//! ```

mod check;
pub mod events;
mod fields;

use crate::record::written::{Written, WrittenError};
use serde::{Deserialize, Serialize};
use sulcus_core::tissue::gingiva::Site;

/// Kind of an exercise.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// The probe follows the circumference of a crown.
    Crown,
    /// Pockets are probed.
    Probing,
    /// The tongue is held aside.
    Retraction,
    /// Probing and retraction at once, with a hand each.
    Bimanual,
    /// Free exploration.
    #[default]
    Free,
}

/// Zones of one tooth, in the order of the visit.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Zones {
    /// FDI number of the tooth.
    pub tooth: u8,
    /// Sites of the tooth.
    #[serde(with = "fields::site_names")]
    pub sites: Vec<Site>,
}

/// Prescription of probing.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ProbingTask {
    /// Least and greatest force on the floor at which a depth is read, N. Default 0.2 to 0.25, range 0.01 to 5. Source:
    /// clinical studies (Karayiannis 1992, Lang 1991).
    pub force_n: [f64; 2],
    /// Least and greatest tilt at proximal sites, degrees: of the working end against the tooth's axis, into the col
    /// under the contact. Default 10 to 25, range 0 to 60. Source: 10 to 15 degrees are taught; wider for the teeth's
    /// own shape.
    pub proximal_tilt_deg: [f64; 2],
    /// Largest tilt in the middle of a side in any direction, degrees, and largest tilt out of the col at proximal
    /// sites. Default 15, range 1 to 60; chosen.
    pub mid_tilt_deg: f64,
    /// Distance along the tooth between two touches of the floor, mm. Default 1, range 0.1 to 5. Source: 1 mm steps are
    /// taught.
    pub step_mm: f64,
}

impl Default for ProbingTask {
    fn default() -> Self {
        Self {
            force_n: [0.2, 0.25],
            proximal_tilt_deg: [10.0, 25.0],
            mid_tilt_deg: 15.0,
            step_mm: 1.0,
        }
    }
}

/// Target of retraction, to be seen past the tongue: the tongue's side of a crown, just above the gingival margin.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Target {
    /// FDI number of the tooth.
    pub tooth: u8,
    /// Operator's eye, world axes, mm.
    pub eye_mm: [f64; 3],
    /// Least free share of the target, 0.05 to 1.
    pub visible: f64,
}

/// Exercise: the task of a session.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Exercise {
    /// Name: letters, digits, `-`, `_`, `/`; part of a recording's file name.
    pub name: String,
    /// Kind of the exercise.
    pub kind: Kind,
    /// Short description, for lists.
    pub about: String,
    /// Text of the task for the student.
    pub task: String,
    /// Name of a built-in scene.
    pub scene: String,
    /// Length, seconds.
    pub duration_s: f64,
    /// Seed of all random numbers, in a recording.
    #[serde(
        default,
        skip_serializing_if = "Option::is_none",
        with = "fields::seed"
    )]
    pub seed: Option<u64>,
    /// Zones to visit, in order.
    #[serde(default, rename = "zone", skip_serializing_if = "Vec::is_empty")]
    pub zones: Vec<Zones>,
    /// Prescription of probing.
    #[serde(default)]
    pub probing: ProbingTask,
    /// Target of retraction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub target: Option<Target>,
}

const BUILT_IN: [&str; 4] = [
    include_str!("../../exercises/crown.toml"),
    include_str!("../../exercises/probing.toml"),
    include_str!("../../exercises/retraction.toml"),
    include_str!("../../exercises/bimanual.toml"),
];

impl Exercise {
    /// Exercise from its text.
    ///
    /// # Errors
    /// A key is unknown, missing or out of range: the key, the value found and the values expected.
    pub fn parse(text: &str) -> Result<Self, WrittenError> {
        Self::parsed(text)
    }

    /// Exercise from its file.
    ///
    /// # Errors
    /// The errors of [`Exercise::parse`], or the file cannot be read.
    pub fn open(path: &std::path::Path) -> Result<Self, WrittenError> {
        Self::opened(path)
    }

    /// Built-in exercises in the order of lists.
    pub fn built_in() -> Vec<Self> {
        // A test parses each exercise.
        BUILT_IN
            .iter()
            .filter_map(|text| Self::parse(text).ok())
            .collect()
    }

    /// Exercise without a task, for a hard case or free exploration.
    pub fn free(name: &str, duration_s: f64) -> Self {
        Self {
            name: name.into(),
            kind: Kind::Free,
            about: String::new(),
            task: String::new(),
            scene: String::new(),
            duration_s,
            seed: None,
            zones: Vec::new(),
            probing: ProbingTask::default(),
            target: None,
        }
    }

    /// Exercise of a recording, from its attachment. An invalid text gives free exploration, whose events any session
    /// has.
    pub fn recorded(text: &str) -> Self {
        Self::parse(text).unwrap_or_else(|_| Self::free("free", 1.0))
    }

    /// Text for a recording: all values, also the default ones, and the seed.
    ///
    /// # Errors
    /// Never for a valid exercise.
    pub fn definition(&self, seed: u64) -> Result<String, WrittenError> {
        let with_seed = Self {
            seed: Some(seed),
            ..self.clone()
        };
        toml::to_string(&with_seed).map_err(|error| Self::syntax(&error))
    }

    /// Zones of the tour, in order.
    pub fn tour(&self) -> impl Iterator<Item = (u8, Site)> + '_ {
        let of = |zones: &'_ Zones| zones.tooth;
        self.zones
            .iter()
            .flat_map(move |zones| zones.sites.iter().map(move |site| (of(zones), *site)))
    }
}
