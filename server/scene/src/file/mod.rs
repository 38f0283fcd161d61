//! Scene files: TOML, clinical units with the unit in the key, paths relative to the file.
//!
//! Unknown keys are refused by name. What is written by hand is checked here, with the file, the
//! key, the value found and the value expected in one sentence.

pub(crate) mod gingiva;
pub mod printed;
pub(crate) mod validate;

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use sulcus_core::Params;
use sulcus_program::PathText;

use crate::anatomy::mouth::MouthEntry;
use crate::anatomy::sulcus::Sulcus;
use crate::anatomy::{Molar, Pocket, Tongue, ToothSizes};
use crate::file::printed::{PrintedGingivaEntry, PrintedSkeletonEntry};
use crate::instruments::{Mirror, Probe};
use crate::mesh::load::Unit;
use crate::mesh::repair::Asked;
use crate::mesh::size::Size;
use crate::mesh::solid::Reading;
use crate::organ::SurfaceOptions;
use crate::organ::skeleton::SkeletonOptions;

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
    /// A patient's teeth with their gingivae.
    pub mouth: Option<MouthEntry>,
    /// What can be touched besides.
    #[serde(default, rename = "object")]
    pub objects: Vec<ObjectEntry>,
}

/// A tool that is made from numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ToolKind {
    /// A periodontal probe; `probe.marking` says whose marks it carries.
    PeriodontalProbe,
    /// A mouth mirror; `mirror.number` says its size. A `stiffness_nmm_per_rad` of 3000 suits it.
    MouthMirror,
}

/// An object that is made from numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ObjectKind {
    /// A lower left first molar.
    Molar,
    /// A lower tooth, the one that `fdi` names (31 to 37, 41 to 47; the right ones are mirror images).
    Tooth,
    /// A tongue at rest.
    Tongue,
    /// The gingiva of one of the file's molars, at its place: wants `tooth` and `tissue = "gingiva"`.
    Gingiva,
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
    /// As a gingiva does; wants `tooth` and either `kind = "gingiva"` or a mesh.
    Gingiva,
    /// As a whole, by finite elements condensed to its surface: a tongue.
    SurfaceCompliance,
    /// As [`TissueEntry::Skeleton`], exactly by the paper: for comparison.
    PrintedSkeleton,
    /// As [`TissueEntry::Gingiva`], exactly by the paper: for comparison.
    PrintedGingiva,
}

/// `[object.gingiva]`: what differs from the defaults of [`sulcus_core::tissue::gingiva::GingivaParams`], in clinical units.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct GingivaEntry {
    /// Stiffness of the pocket's wall away from the tooth, N/mm.
    pub wall_stiffness_n_per_mm: Option<f64>,
    /// Stiffness of it along the tooth, N/mm.
    pub shear_stiffness_n_per_mm: Option<f64>,
    /// Length over which a press is felt, mm.
    pub reach_mm: Option<f64>,
    /// Time constant, ms.
    pub relaxation_ms: Option<f64>,
    /// Stiffness of the floor along the tooth's axis, N/mm.
    pub floor_stiffness_n_per_mm: Option<f64>,
    /// Height in which the wall becomes the floor, mm.
    pub floor_taper_mm: Option<f64>,
    /// Force at which the prescribed depths are read, N.
    pub reading_force_n: Option<f64>,
    /// Diameter of the tip with which they are read, mm.
    pub reading_tip_mm: Option<f64>,
    /// How inflamed it is, 0 to 1.
    pub inflammation: Option<f64>,
    /// Share of the stiffness that full inflammation takes away.
    pub softening: Option<f64>,
    /// Threshold of the zone "too heavy", N.
    pub too_heavy_n: Option<f64>,
    /// Threshold of the zone "trauma", N.
    pub trauma_n: Option<f64>,
    /// Threshold of the zone "damage", N.
    pub damage_n: Option<f64>,
    /// Share of a threshold under which its zone is left.
    pub rearm: Option<f64>,
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
    /// Kind of thing that the mesh file is of, where its size is to be judged by another kind than an instrument;
    /// `any` takes every size.
    pub size: Option<Size>,
    /// Whether only the largest piece of the mesh file is kept.
    #[serde(default)]
    pub keep_largest: bool,
    /// Whether the one flat opening of a scan without base is closed.
    #[serde(default)]
    pub close_base: bool,
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
    /// Dimensions of a parametric tooth that differ from its average ones.
    pub sizes: Option<ToothSizes>,
    /// Dimensions of a parametric tongue that differ from the defaults.
    pub tongue: Option<Tongue>,
    /// STL, OBJ or PLY file, relative to the scene file.
    pub mesh: Option<PathBuf>,
    /// Unit of the mesh file.
    pub unit: Option<Unit>,
    /// Kind of thing that the mesh file is of, where its size is to be judged by another kind than its tissue and FDI number say;
    /// `any` takes every size.
    pub size: Option<Size>,
    /// Whether only the largest piece of the mesh file is kept.
    #[serde(default)]
    pub keep_largest: bool,
    /// Whether the one flat opening of a scan without base is closed.
    #[serde(default)]
    pub close_base: bool,
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
    /// Parameters of `tissue = "surface_compliance"` that differ from the defaults.
    pub surface: Option<SurfaceOptions>,
    /// Name of the tooth that a gingiva surrounds: a molar, or for a gingiva that is a mesh any rigid object.
    pub tooth: Option<String>,
    /// Pocket of a gingiva, where it differs from the default.
    pub pocket: Option<Pocket>,
    /// What is known of the sulcus of a gingiva that is a mesh; the rest is found from the meshes.
    pub sulcus: Option<Sulcus>,
    /// Parameters of `tissue = "printed_skeleton"` that differ from the defaults.
    pub printed_skeleton: Option<PrintedSkeletonEntry>,
    /// Parameters of `tissue = "printed_gingiva"` that differ from the defaults.
    pub printed_gingiva: Option<PrintedGingivaEntry>,
    /// Parameters of a gingiva that differ from the defaults.
    pub gingiva: Option<GingivaEntry>,
}

impl ToolEntry {
    /// How its mesh file is to be read.
    pub(crate) fn reading(&self) -> Reading {
        Reading {
            unit: self.unit.unwrap_or(Unit::Millimetre),
            size: self.size.unwrap_or(Size::Instrument),
            asked: Asked {
                keep_largest: self.keep_largest,
                close_base: self.close_base,
            },
        }
    }
}

impl ObjectEntry {
    /// How its mesh file is to be read.
    pub(crate) fn reading(&self) -> Reading {
        let usual = match self.tissue {
            tissue if tissue.is_organ() => Size::Tongue,
            tissue if tissue.is_gingiva() => Size::Arch,
            _ if self.fdi != 0 => Size::Tooth,
            _ => Size::Mouth,
        };
        Reading {
            unit: self.unit.unwrap_or(Unit::Millimetre),
            size: self.size.unwrap_or(usual),
            asked: Asked {
                keep_largest: self.keep_largest,
                close_base: self.close_base,
            },
        }
    }
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
    #[error("{}: cannot read the file: {source}", file.shown())]
    Read {
        /// The file.
        file: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// It is not TOML, or a key is unknown, missing or of the wrong type.
    #[error("{}, line {line} (`{text}`): {message}", file.shown())]
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
    #[error("{}: {field} is {found}, expected {expected}", file.shown())]
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
    let scene: SceneFile = from_toml(text, file)?;
    crate::file::validate::scene_file(&scene).map_err(|wrong| wrong.in_file(file))?;
    Ok(scene)
}

/// Parses TOML to the letter ([`sulcus_core::exactly`]); `file` is how messages call it.
///
/// # Errors
/// One sentence with file, line, the text of the line and the text expected.
pub(crate) fn from_toml<T: serde::de::DeserializeOwned>(
    text: &str,
    file: &Path,
) -> Result<T, FileError> {
    let read = toml::Deserializer::parse(text).and_then(sulcus_core::exactly);
    read.map_err(|error| {
        let at = error.span().map_or(0, |span| span.start);
        let line = text.get(..at).unwrap_or(text).matches('\n').count() + 1;
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
    })
}
