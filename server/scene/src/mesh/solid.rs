//! From a mesh file to a solid that can be touched: read, repair, check.

use std::path::{Path, PathBuf};

use sulcus_program::PathText;

use crate::mesh::TriMesh;
use crate::mesh::check::{MeshError, MeshReport, check_as};
use crate::mesh::load::{LoadError, Unit, load_mesh};
use crate::mesh::repair::{Asked, Repairs, repair_as};
use crate::mesh::size::Size;

/// How a mesh file is to be read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// Its unit.
    pub unit: Unit,
    /// The kind of thing that it is of: a size that is implausible for that is refused.
    pub size: Size,
    /// Repairs that are made only where they are asked for.
    pub asked: Asked,
}

impl From<Unit> for Reading {
    /// Anything in a mouth, and no repair but those with one right answer.
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
    /// What it is like.
    pub report: MeshReport,
    /// What had to be repaired; users are to be told.
    pub repairs: Repairs,
    /// Parts of the file that were not read, and requests that changed nothing, a sentence each; users are to be told.
    pub notes: Vec<String>,
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
    /// Its base was to be closed and cannot be.
    #[error(
        "{}: cannot close the base: found {found}, expected one opening whose rim is nearly flat and does not cross itself",
        file.display()
    )]
    Base {
        /// The file.
        file: PathBuf,
        /// The openings that were found instead.
        found: String,
    },
}

/// Reads a mesh file ([`load_mesh`]), mends what has one right answer and what was asked for ([`repair_as`]), and makes
/// sure that the result is a solid of plausible size ([`check_as`]). A [`Unit`] alone is a [`Reading`], too.
///
/// # Errors
/// If the file cannot be read, or what is in it is not a solid: what was found, where (mm, in the
/// file's frame), what was expected.
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
        notes.push("there is one piece alone, so none was dropped".to_owned());
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
