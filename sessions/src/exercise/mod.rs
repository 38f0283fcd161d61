//! What a student is asked to do, as data: a TOML file. The same text, with seed and length, goes into the recording, so
//! that whoever replays it knows what was asked.
//!
//! ```toml
//! name = "probing"                # letters, digits, - _ /
//! kind = "probing"                # crown, probing, retraction, bimanual, free
//! about = "for lists"
//! task = "what the student is told"
//! scene = "pocket"                # name of a scene that the programs bring along
//! duration_s = 20.0
//!
//! [[zone]]                        # zones to visit, in order
//! tooth = 36                      # FDI
//! sites = ["distobuccal", "buccal", "mesiobuccal"]
//!
//! [probing]                       # may be left out
//! force_n = [0.2, 0.25]           # force on the floor at which a depth is read
//! proximal_tilt_deg = [10, 25]    # tilt into the col at proximal sites
//! mid_tilt_deg = 15               # most tilt in the middle of a side
//! step_mm = 1                     # between two touches of the floor while walking
//!
//! [target]                        # what has to be seen past the tongue
//! tooth = 36
//! eye_mm = [250, -120, 260]       # world axes: x anterior, y patient's left, z up
//! visible = 0.7                   # share of it that must be free
//! ```

mod check;
pub mod events;
mod fields;

use crate::record::written::{Written, WrittenError};
use serde::{Deserialize, Serialize};
use sulcus_core::tissue::gingiva::Site;

/// What kind of task it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// The probe is led round a crown.
    Crown,
    /// Pockets are probed.
    Probing,
    /// The tongue is held aside.
    Retraction,
    /// Both at once, a hand each.
    Bimanual,
    /// Nothing in particular.
    #[default]
    Free,
}

/// Zones of one tooth, in the order of the visit.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Zones {
    /// FDI number of the tooth.
    pub tooth: u8,
    /// Its sites.
    #[serde(with = "fields::site_names")]
    pub sites: Vec<Site>,
}

/// How pockets are to be probed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ProbingTask {
    /// Least and greatest force on the floor at which a depth is read, N. Default 0.2 to 0.25, range 0.01 to 5. Source:
    /// clinical studies (Karayiannis 1992, Lang 1991).
    pub force_n: [f64; 2],
    /// Least and greatest tilt at proximal sites, degrees: of the working end against the tooth's axis, into the col
    /// under the contact. Default 10 to 25, range 0 to 60. Source: 10 to 15 degrees are taught; wider for the teeth's own shape.
    pub proximal_tilt_deg: [f64; 2],
    /// Largest tilt in the middle of a side, any way, degrees; at proximal sites the largest out of the col. Default 15,
    /// range 1 to 60; chosen.
    pub mid_tilt_deg: f64,
    /// Way along the tooth between two touches of the floor, mm. Default 1, range 0.1 to 5. Source: 1 mm steps are taught.
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

/// What has to be seen past the tongue: the tongue's side of a crown, just above the gingival margin.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Target {
    /// FDI number of the tooth.
    pub tooth: u8,
    /// The operator's eye, world axes, mm.
    pub eye_mm: [f64; 3],
    /// Share of the target that must be free, 0.05 to 1.
    pub visible: f64,
}

/// An exercise.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Exercise {
    /// Name: letters, digits, `-`, `_`, `/`; part of a recording's file name.
    pub name: String,
    /// What kind of task it is.
    pub kind: Kind,
    /// What it is about, for lists.
    pub about: String,
    /// What the student is told.
    pub task: String,
    /// Name of the scene it is performed in, of those that the programs bring along.
    pub scene: String,
    /// Length, seconds.
    pub duration_s: f64,
    /// Seed of whatever is random, in a recording.
    #[serde(
        default,
        skip_serializing_if = "Option::is_none",
        with = "fields::seed"
    )]
    pub seed: Option<u64>,
    /// Zones to visit, in order.
    #[serde(default, rename = "zone", skip_serializing_if = "Vec::is_empty")]
    pub zones: Vec<Zones>,
    /// How pockets are to be probed.
    #[serde(default)]
    pub probing: ProbingTask,
    /// What has to be seen past the tongue.
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
    /// An exercise from its text.
    ///
    /// # Errors
    /// Names the key, the value found and what is expected; says so of unknown keys too.
    pub fn parse(text: &str) -> Result<Self, WrittenError> {
        Self::parsed(text)
    }

    /// An exercise from its file.
    ///
    /// # Errors
    /// As [`Exercise::parse`], and when the file cannot be read.
    pub fn open(path: &std::path::Path) -> Result<Self, WrittenError> {
        Self::opened(path)
    }

    /// The exercises that the programs bring along, in the order of lists.
    pub fn built_in() -> Vec<Self> {
        // (A test parses each.)
        BUILT_IN
            .iter()
            .filter_map(|text| Self::parse(text).ok())
            .collect()
    }

    /// Nothing in particular is asked: a hard case, or free exploration.
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

    /// The exercise of a recording, from its attachment. What cannot be read is free exploration: its events are
    /// those of any session.
    pub fn recorded(text: &str) -> Self {
        Self::parse(text).unwrap_or_else(|_| Self::free("free", 1.0))
    }

    /// The text for a recording: all values, those of the defaults too, and the seed.
    ///
    /// # Errors
    /// Never for an exercise that is valid.
    pub fn definition(&self, seed: u64) -> Result<String, WrittenError> {
        let with_seed = Self {
            seed: Some(seed),
            ..self.clone()
        };
        toml::to_string(&with_seed).map_err(|error| Self::syntax(&error))
    }

    /// Every zone to visit, in order.
    pub fn tour(&self) -> impl Iterator<Item = (u8, Site)> + '_ {
        let of = |zones: &'_ Zones| zones.tooth;
        self.zones
            .iter()
            .flat_map(move |zones| zones.sites.iter().map(move |site| (of(zones), *site)))
    }
}
