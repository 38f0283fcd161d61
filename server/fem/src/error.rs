//! Errors of meshes, materials and files.

use std::path::PathBuf;

/// Reason why a result cannot be computed or a file cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum FemError {
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
    /// A file cannot be opened.
    #[error("{path}: {source}")]
    Open {
        /// File.
        path: PathBuf,
        /// Error of the system.
        source: std::io::Error,
    },
    /// A row of a file is invalid.
    #[error("{path}, line {line}: {found}, expected {expected}")]
    Row {
        /// File.
        path: PathBuf,
        /// Line, counted from 1.
        line: u64,
        /// Text found.
        found: String,
        /// Text expected.
        expected: String,
    },
    /// Bytes are not those of a condensed organ.
    #[error("a condensed organ's bytes: {0}")]
    Bytes(String),
    /// A file as a whole is invalid.
    #[error("{path}: {found}, expected {expected}")]
    File {
        /// File.
        path: PathBuf,
        /// Content found.
        found: String,
        /// Content expected.
        expected: String,
    },
    /// The stiffness matrix cannot be factored.
    #[error("the stiffness matrix cannot be factored: {0}")]
    Factor(String),
    /// Newton's method finds no equilibrium.
    #[error("no equilibrium at {aim} of the load: {why}; the last one is at {reached}")]
    Newton {
        /// Largest share of the load with an equilibrium, 0 to 1.
        reached: f64,
        /// Share of the load without one, at the shortest step.
        aim: f64,
        /// Reason of the failure at that share.
        why: &'static str,
    },
}

impl FemError {
    /// Returns an error of a field.
    pub(crate) fn field(
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
