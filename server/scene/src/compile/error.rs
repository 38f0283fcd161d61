//! Errors of a compilation.

use std::path::PathBuf;

use sulcus_core::SceneError;
use sulcus_program::PathText;

use crate::anatomy::sulcus::SulcusError;
use crate::hand_written::FileError;
use crate::mesh::check::MeshError;
use crate::mesh::load::LoadError;
use crate::mesh::solid::SolidError;
use crate::organ::OrganError;
use crate::organ::skeleton::SkeletonError;
use crate::organ::springs::SpringsError;
use crate::tree::build::TreeBuildError;

/// Reason why a scene cannot be compiled, in one sentence.
#[derive(Debug, thiserror::Error)]
pub enum BuildError {
    /// The scene file is invalid.
    #[error(transparent)]
    File(#[from] FileError),
    /// A mesh file cannot be read.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// A mesh is not a solid.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The base of a mesh cannot be closed.
    #[error("{0}")]
    Base(SolidError),
    /// A tree cannot be built.
    #[error("{part}: {source}")]
    Tree {
        /// Tool or object.
        part: String,
        /// Reason.
        source: TreeBuildError,
    },
    /// A skeleton cannot be made.
    #[error("{part}: {source}")]
    Skeleton {
        /// The object.
        part: String,
        /// Reason.
        source: SkeletonError,
    },
    /// A gingiva's mesh has no sulcus round its tooth.
    #[error("{part}: {source}")]
    Sulcus {
        /// The object.
        part: String,
        /// Reason.
        source: SulcusError,
    },
    /// Fitted springs cannot be used.
    #[error("{part}: {source}")]
    Springs {
        /// The object.
        part: String,
        /// Reason.
        source: SpringsError,
    },
    /// No parametric tooth has this number. The check of the scene file refuses such a number first.
    #[error("{part}: fdi is {fdi}, expected a lower tooth, 31 to 37 or 41 to 47")]
    NoSuchTooth {
        /// Object.
        part: String,
        /// FDI number found.
        fdi: u8,
    },
    /// A patient's gingiva cannot be laid out.
    #[error("patient: {0}")]
    Patient(String),
    /// Finite elements cannot be made or condensed.
    #[error("{part}: {source}")]
    Organ {
        /// The object.
        part: String,
        /// Reason.
        source: OrganError,
    },
    /// The parts do not make a scene.
    #[error("{}: {source}", file.shown())]
    Scene {
        /// The scene file.
        file: PathBuf,
        /// Reason.
        source: SceneError,
    },
    /// A tool waits inside an object.
    #[error("{}: `park_mm` of tool `{tool}` is {depth_mm:.2} mm inside object `{object}`, expected a place outside of all objects", file.shown())]
    ParkedInside {
        /// The scene file.
        file: PathBuf,
        /// The tool.
        tool: String,
        /// The object.
        object: String,
        /// Depth, millimetres.
        depth_mm: f64,
    },
}

impl From<SolidError> for BuildError {
    fn from(error: SolidError) -> Self {
        match error {
            SolidError::Load(error) => Self::Load(error),
            SolidError::Mesh(error) => Self::Mesh(error),
            error @ SolidError::Base { .. } => Self::Base(error),
        }
    }
}
