//! Errors of the filling of a surface with tetrahedra.

use sulcus_fem::FemError;

use crate::mesh::check::MeshError;

/// Reason why a surface cannot be filled.
#[derive(Debug, thiserror::Error)]
pub enum TetraError {
    /// A number is out of range.
    #[error("{field} is {found}, expected {expected}")]
    Field {
        /// Name of the field.
        field: &'static str,
        /// Value found.
        found: String,
        /// Values allowed.
        expected: String,
    },
    /// The surface is not a solid.
    #[error(transparent)]
    Surface(MeshError),
    /// The boundary of the tetrahedra is not that of a solid.
    #[error("lattice of {mm} mm: {error}; choose a smaller size")]
    Boundary {
        /// Edge of the lattice's cubes, mm.
        mm: f64,
        /// Fault of the boundary.
        error: MeshError,
    },
    /// The tetrahedra are invalid as finite elements.
    #[error(transparent)]
    Mesh(FemError),
}

impl TetraError {
    pub(super) fn field(
        field: &'static str,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> Self {
        Self::Field {
            field,
            found: found.into(),
            expected: expected.into(),
        }
    }
}
