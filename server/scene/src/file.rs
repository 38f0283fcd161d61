//! Scene files: TOML, clinical units with the unit in the key, paths relative to the file.
//!
//! Unknown keys are refused by name. What is written by hand is checked here, with the file, the
//! key, the value found and the value expected in one sentence.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use sulcus_core::Params;

use crate::load::Unit;
use crate::parametric::{Mirror, Molar, Probe, Tongue};
use crate::skeleton::SkeletonOptions;

/// A scene file as written.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneFile {
    /// Name of the scene.
    pub name: String,
    /// Parameters of the tick that differ from the defaults, SI units, by the names of
    /// [`sulcus_core::Params`].
    #[serde(default)]
    pub params: Params,
    /// One or two tools.
    #[serde(default, rename = "tool")]
    pub tools: Vec<ToolEntry>,
    /// What can be touched.
    #[serde(default, rename = "object")]
    pub objects: Vec<ObjectEntry>,
}

/// A tool that is made from numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ToolKind {
    /// A UNC-15 probe.
    PeriodontalProbe,
    /// A mouth mirror. A `stiffness_nmm_per_rad` of 3000 suits it.
    MouthMirror,
}

/// An object that is made from numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ObjectKind {
    /// A lower left first molar.
    Molar,
    /// A tongue at rest.
    Tongue,
}

/// How an object yields.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TissueEntry {
    /// Not at all.
    #[default]
    Rigid,
    /// As a whole, on a skeleton of springs: a tongue.
    Skeleton,
}

/// `[[tool]]`: either `kind` or `mesh` with `unit`, `working_point_mm`, `tip_mm`, `tip_axis`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ToolEntry {
    /// Name, for people.
    pub name: String,
    /// Parametric tool.
    pub kind: Option<ToolKind>,
    /// Dimensions of a parametric probe that differ from the defaults.
    pub probe: Option<Probe>,
    /// Dimensions of a parametric mirror that differ from the defaults.
    pub mirror: Option<Mirror>,
    /// STL, OBJ or PLY file, relative to the scene file; its origin is the device point.
    pub mesh: Option<PathBuf>,
    /// Unit of the mesh file.
    pub unit: Option<Unit>,
    /// Reference point of the optimisation, at the working end, tool frame, mm.
    pub working_point_mm: Option<[f64; 3]>,
    /// The very tip, tool frame, mm.
    pub tip_mm: Option<[f64; 3]>,
    /// Direction out of the tip, tool frame, any length.
    pub tip_axis: Option<[f64; 3]>,
    /// Level in contact.
    #[serde(default = "contact_level")]
    pub level: u8,
    /// Finest level that is built.
    #[serde(default = "finest_level")]
    pub levels: u8,
    /// Coupling stiffness in translation, N/mm.
    #[serde(default = "default_kt")]
    pub stiffness_n_per_mm: f64,
    /// Coupling stiffness in rotation, N mm/rad.
    #[serde(default = "default_kr")]
    pub stiffness_nmm_per_rad: f64,
    /// Where the device point waits before the first entry, world, mm.
    pub park_mm: [f64; 3],
    /// How the tool is turned there: rotation vector, degrees.
    #[serde(default)]
    pub park_rotation_deg: [f64; 3],
}

/// `[[object]]`: either `kind` or `mesh` with `unit`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObjectEntry {
    /// Name, for people.
    pub name: String,
    /// FDI number of a tooth.
    #[serde(default)]
    pub fdi: u8,
    /// Parametric object.
    pub kind: Option<ObjectKind>,
    /// Dimensions of a parametric molar that differ from the defaults.
    pub molar: Option<Molar>,
    /// Dimensions of a parametric tongue that differ from the defaults.
    pub tongue: Option<Tongue>,
    /// STL, OBJ or PLY file, relative to the scene file.
    pub mesh: Option<PathBuf>,
    /// Unit of the mesh file.
    pub unit: Option<Unit>,
    /// Where its origin lies in the world, mm.
    #[serde(default)]
    pub translate_mm: [f64; 3],
    /// Level in contact.
    #[serde(default = "contact_level")]
    pub level: u8,
    /// Finest level that is built.
    #[serde(default = "finest_level")]
    pub levels: u8,
    /// How it yields.
    #[serde(default)]
    pub tissue: TissueEntry,
    /// Parameters of `tissue = "skeleton"` that differ from the defaults.
    pub skeleton: Option<SkeletonOptions>,
}

fn contact_level() -> u8 {
    3
}
fn finest_level() -> u8 {
    4
}
fn default_kt() -> f64 {
    0.5
}
fn default_kr() -> f64 {
    500.0
}

/// Why a scene file could not be understood.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// It cannot be read.
    #[error("{}: cannot read the scene file: {source}", file.display())]
    Read {
        /// The file.
        file: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// It is not TOML, or a key is unknown, missing or of the wrong type.
    #[error("{}, line {line} (`{text}`): {message}", file.display())]
    Syntax {
        /// The file.
        file: PathBuf,
        /// Line, from 1.
        line: usize,
        /// What stands there.
        text: String,
        /// What is wrong with it, and what was expected.
        message: String,
    },
    /// A value is out of range or does not fit another.
    #[error("{}: {field} is {found}, expected {expected}", file.display())]
    Field {
        /// The file.
        file: PathBuf,
        /// The key, with the tool or object it belongs to.
        field: String,
        /// Value found.
        found: String,
        /// What it must be.
        expected: &'static str,
    },
}

/// Reads and checks a scene file; the mesh files that it names are not opened.
///
/// # Errors
/// One sentence with file, key, value found and value expected.
pub fn read(file: &Path) -> Result<(SceneFile, String), FileError> {
    let text = std::fs::read_to_string(file).map_err(|source| FileError::Read {
        file: file.to_owned(),
        source,
    })?;
    Ok((parse(&text, file)?, text))
}

/// Parses and checks the text of a scene file; `file` is how messages call it.
///
/// # Errors
/// One sentence with file, key, value found and value expected.
pub fn parse(text: &str, file: &Path) -> Result<SceneFile, FileError> {
    let scene: SceneFile = toml::from_str(text).map_err(|error| {
        let at = error.span().map_or(0, |span| span.start.min(text.len()));
        let line = text[..at].matches('\n').count() + 1;
        FileError::Syntax {
            file: file.to_owned(),
            line,
            text: text
                .lines()
                .nth(line - 1)
                .unwrap_or_default()
                .trim()
                .to_owned(),
            message: error.message().replace('\n', " "),
        }
    })?;
    crate::validate::scene_file(&scene).map_err(|wrong| FileError::Field {
        file: file.to_owned(),
        field: wrong.field,
        found: wrong.found,
        expected: wrong.expected,
    })?;
    Ok(scene)
}
