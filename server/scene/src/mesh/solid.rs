//! Mesh file to solid: read, repair, check.

use std::path::{Path, PathBuf};

use sulcus_program::PathText;

use crate::mesh::TriMesh;
use crate::mesh::check::{MeshError, MeshReport, check_as};
use crate::mesh::load::{LoadError, Unit, load_mesh};
use crate::mesh::repair::{Asked, Repairs, repair_as};
use crate::mesh::size::Size;

/// Options for reading a mesh file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// Its unit.
    pub unit: Unit,
    /// Kind of object. A size that is implausible for it is refused.
    pub size: Size,
    /// Repairs that are made on request only.
    pub asked: Asked,
}

impl From<Unit> for Reading {
    /// Any object in a mouth, without requested repairs.
    fn from(unit: Unit) -> Self {
        Self {
            unit,
            size: Size::default(),
            asked: Asked::default(),
        }
    }
}

/// A mesh that passed the check.
#[derive(Clone, Debug, PartialEq)]
pub struct Solid {
    /// The mesh as repaired, metres, in the file's own frame.
    pub mesh: TriMesh,
    /// Measures of the mesh.
    pub report: MeshReport,
    /// Repairs made, for the user.
    pub repairs: Repairs,
    /// Parts of the file that were not read, and requests without effect, a sentence each, for the user.
    pub notes: Vec<String>,
}

/// Reason why a mesh file gives no solid, in one sentence with the file.
#[derive(Debug, thiserror::Error)]
pub enum SolidError {
    /// The file cannot be read.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// The mesh is not a solid, even after repairs.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The base was to be closed, but cannot be.
    #[error(
        "{}: cannot close the base: found {found}, expected one opening whose rim is nearly flat and does not cross itself",
        file.display()
    )]
    Base {
        /// The file.
        file: PathBuf,
        /// Openings found.
        found: String,
    },
}

/// Reads a mesh file ([`load_mesh`]), makes the automatic and the requested repairs ([`repair_as`]), and checks the
/// result ([`check_as`]).
///
/// A [`Unit`] is also a [`Reading`].
///
/// # Errors
/// [`SolidError`] if the file cannot be read or its mesh is not a solid. It has the value found, its place (mm, in
/// the file's frame), and the value expected.
pub fn read_solid(file: &Path, reading: impl Into<Reading>) -> Result<Solid, SolidError> {
    let reading: Reading = reading.into();
    let loaded = load_mesh(file, reading.unit)?;
    let mut notes = loaded.notes;
    let (mesh, repairs) = repair_as(loaded.mesh, &reading.asked);
    let checked = check_as(
        &mesh,
        &file.shown().to_string(),
        reading.size,
        Some(reading.unit),
    );
    let report = match (checked, &repairs.base_refused) {
        (Err(MeshError::Open { .. }), Some(found)) => {
            return Err(SolidError::Base {
                file: file.to_owned(),
                found: found.clone(),
            });
        }
        (checked, _) => checked?,
    };
    if reading.asked.keep_largest && repairs.dropped.is_none() {
        notes.push("there is only one piece, so none was dropped".to_owned());
    }
    if reading.asked.close_base && repairs.base.is_none() {
        notes.push("nothing is open, so no base was closed".to_owned());
    }
    Ok(Solid {
        mesh,
        report,
        repairs,
        notes,
    })
}
