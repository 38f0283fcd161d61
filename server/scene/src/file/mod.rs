//! Scene files: TOML, clinical units with the unit in the key, paths relative to the file.
//!
//! Unknown keys are refused by name. Errors have file, key, value found and value expected in one sentence.
//!
//! Keys are the fields of the types here; `gingiva`, `mouth`, `parts` and `printed` have the keys of nested tables.
//! Keys of instruments and organs are in [`crate::instruments`] and [`crate::organ`], which do not import this folder.
//!
//! This folder has entries and ranges. It imports neither the anatomy nor the compiler: both import it.

mod gingiva;
mod mouth;
mod parts;
mod printed;
mod read;
mod validate;

use std::path::PathBuf;

use serde::{Deserialize, Serialize};
use sulcus_core::Params;

use crate::instruments::{Mirror, Probe};
use crate::mesh::load::Unit;
use crate::mesh::repair::Asked;
use crate::mesh::size::Size;
use crate::mesh::solid::Reading;
use crate::organ::SurfaceOptions;
use crate::organ::skeleton::SkeletonOptions;

pub use crate::hand_written::FileError;
pub use gingiva::{GingivaEntry, Pocket, SulcusEntry};
pub use mouth::{Condition, LOWER, MouthEntry};
pub use parts::{Molar, Tongue, ToothSizes};
pub use printed::{PrintedGingivaEntry, PrintedSkeletonEntry};
pub use read::{parse, read};

/// A scene file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneFile {
    /// Name of the scene.
    pub name: String,
    /// `[params]`: parameters of the tick that differ from the defaults, SI units, by the names of
    /// [`sulcus_core::Params`].
    #[serde(default)]
    pub params: Params,
    /// One or two tools.
    #[serde(default, rename = "tool")]
    pub tools: Vec<ToolEntry>,
    /// A patient's teeth with their gingivae.
    pub mouth: Option<MouthEntry>,
    /// Other objects.
    #[serde(default, rename = "object")]
    pub objects: Vec<ObjectEntry>,
}

/// A parametric tool.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ToolKind {
    /// A periodontal probe; `probe.marking` is the pattern of its marks.
    PeriodontalProbe,
    /// A mouth mirror; `mirror.number` is its size. A suitable `stiffness_nmm_per_rad` is 3000.
    MouthMirror,
}

/// A parametric object.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ObjectKind {
    /// A lower left first molar.
    Molar,
    /// The lower tooth with the number `fdi`, 31 to 37 or 41 to 47. Right teeth are mirror images.
    Tooth,
    /// A tongue at rest.
    Tongue,
    /// The gingiva of one of the file's molars, at its place. It needs `tooth` and `tissue = "gingiva"`.
    Gingiva,
}

/// Tissue model of an object.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TissueEntry {
    /// No deformation.
    #[default]
    Rigid,
    /// Deformation of the whole on a skeleton of springs: a tongue.
    Skeleton,
    /// A gingiva. It needs `tooth` and either `kind = "gingiva"` or a mesh.
    Gingiva,
    /// Deformation of the whole by finite elements condensed to the surface: a tongue.
    SurfaceCompliance,
    /// [`TissueEntry::Skeleton`] exactly by the paper, for comparison.
    PrintedSkeleton,
    /// [`TissueEntry::Gingiva`] exactly by the paper, for comparison.
    PrintedGingiva,
}

impl TissueEntry {
    /// Returns whether it has a skeleton of springs, by either method.
    pub fn is_skeleton(self) -> bool {
        matches!(self, Self::Skeleton | Self::PrintedSkeleton)
    }

    /// Returns whether it deforms as a whole, by any method.
    pub fn is_organ(self) -> bool {
        self.is_skeleton() || self == Self::SurfaceCompliance
    }

    /// Returns whether it is a gingiva, by either method.
    pub fn is_gingiva(self) -> bool {
        matches!(self, Self::Gingiva | Self::PrintedGingiva)
    }
}

/// `[[tool]]`: either `kind` or `mesh` with `unit`, `working_point_mm`, `tip_mm`, `tip_axis`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ToolEntry {
    /// Name for people.
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
    /// Kind of object in the mesh file, for the check of its size. Default: an instrument; `any` accepts every size.
    pub size: Option<Size>,
    /// Keeps only the largest piece of the mesh file.
    #[serde(default)]
    pub keep_largest: bool,
    /// Closes the one flat opening of a scan without base.
    #[serde(default)]
    pub close_base: bool,
    /// Reference point of the optimisation, at the working end, tool frame, mm.
    pub working_point_mm: Option<[f64; 3]>,
    /// Foremost point of the tip, tool frame, mm.
    pub tip_mm: Option<[f64; 3]>,
    /// Direction out of the tip, tool frame, any length.
    pub tip_axis: Option<[f64; 3]>,
    /// Level in contact.
    #[serde(default = "contact_level")]
    pub level: u8,
    /// Finest level of the tree.
    #[serde(default = "finest_level")]
    pub levels: u8,
    /// Coupling stiffness in translation, N/mm.
    #[serde(default = "default_kt")]
    pub stiffness_n_per_mm: f64,
    /// Coupling stiffness in rotation, N mm/rad.
    #[serde(default = "default_kr")]
    pub stiffness_nmm_per_rad: f64,
    /// Place of the device point before the first entry, world, mm.
    pub park_mm: [f64; 3],
    /// Rotation of the tool there: rotation vector, degrees.
    #[serde(default)]
    pub park_rotation_deg: [f64; 3],
}

/// `[[object]]`: either `kind` or `mesh` with `unit`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObjectEntry {
    /// Name for people.
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
    /// Kind of object in the mesh file, for the check of its size. Default: by tissue and FDI number; `any` accepts
    /// every size.
    pub size: Option<Size>,
    /// Keeps only the largest piece of the mesh file.
    #[serde(default)]
    pub keep_largest: bool,
    /// Closes the one flat opening of a scan without base.
    #[serde(default)]
    pub close_base: bool,
    /// Place of its origin in the world, mm.
    #[serde(default)]
    pub translate_mm: [f64; 3],
    /// Level in contact.
    #[serde(default = "contact_level")]
    pub level: u8,
    /// Finest level of the tree.
    #[serde(default = "finest_level")]
    pub levels: u8,
    /// Tissue model.
    #[serde(default)]
    pub tissue: TissueEntry,
    /// Parameters of `tissue = "skeleton"` that differ from the defaults.
    pub skeleton: Option<SkeletonOptions>,
    /// Parameters of `tissue = "surface_compliance"` that differ from the defaults.
    pub surface: Option<SurfaceOptions>,
    /// Name of the tooth of a gingiva: a molar, or any rigid object if the gingiva is a mesh.
    pub tooth: Option<String>,
    /// Pocket of a gingiva, if it differs from the default.
    pub pocket: Option<Pocket>,
    /// Known values of the sulcus of a gingiva that is a mesh. Omitted ones are found from the meshes.
    pub sulcus: Option<SulcusEntry>,
    /// Parameters of `tissue = "printed_skeleton"` that differ from the defaults.
    pub printed_skeleton: Option<PrintedSkeletonEntry>,
    /// Parameters of `tissue = "printed_gingiva"` that differ from the defaults.
    pub printed_gingiva: Option<PrintedGingivaEntry>,
    /// Parameters of a gingiva that differ from the defaults.
    pub gingiva: Option<GingivaEntry>,
}

impl ToolEntry {
    /// Returns the options for reading its mesh file.
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
    /// Returns the options for reading its mesh file.
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
