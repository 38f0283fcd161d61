//! From a mesh file to a solid that can be touched: read, repair, check.

use std::path::Path;

use sulcus_program::PathText;

use crate::check::{MeshError, MeshReport, check};
use crate::load::{LoadError, Unit, load_mesh};
use crate::mesh::TriMesh;
use crate::repair::{Repairs, repair};

/// A mesh that passed the check.
#[derive(Clone, Debug, PartialEq)]
pub struct Solid {
    /// The mesh as repaired, metres, in the file's own frame.
    pub mesh: TriMesh,
    /// What it is like.
    pub report: MeshReport,
    /// What had to be repaired; users are to be told.
    pub repairs: Repairs,
}

/// Why a mesh file gives no solid. One sentence, with the file.
#[derive(Debug, thiserror::Error)]
pub enum SolidError {
    /// It cannot be read.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// What is in it is not a solid, even repaired.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

/// Reads a mesh file ([`load_mesh`]), mends what has one right answer ([`repair`]) and makes sure
/// that the result is a solid ([`check`]).
///
/// # Errors
/// If the file cannot be read, or what is in it is not a solid: what was found, where (mm, in the
/// file's frame), what was expected.
pub fn read_solid(file: &Path, unit: Unit) -> Result<Solid, SolidError> {
    let (mesh, repairs) = repair(load_mesh(file, unit)?);
    let report = check(&mesh, &file.shown().to_string()).map_err(|error| error.read_in(unit))?;
    Ok(Solid {
        mesh,
        report,
        repairs,
    })
}
