//! What can be wrong with a mesh, a material or a file.

use std::path::PathBuf;

/// Why something cannot be computed or read.
#[derive(Debug, thiserror::Error)]
pub enum FemError {
    /// A number is out of range.
    #[error("{field} is {found}, expected {expected}")]
    Field {
        /// What it is.
        field: &'static str,
        /// What it was.
        found: String,
        /// What it may be.
        expected: String,
    },
    /// A file cannot be opened.
    #[error("{path}: {source}")]
    Open {
        /// Which.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A row of a file is not what it should be.
    #[error("{path}, line {line}: {found}, expected {expected}")]
    Row {
        /// Which file.
        path: PathBuf,
        /// Line, counted from 1.
        line: u64,
        /// What stands there.
        found: String,
        /// What should.
        expected: String,
    },
    /// Bytes are not those of a condensed organ.
    #[error("a condensed organ's bytes: {0}")]
    Bytes(String),
    /// A file as a whole is not what it should be.
    #[error("{path}: {found}, expected {expected}")]
    File {
        /// Which file.
        path: PathBuf,
        /// What it has.
        found: String,
        /// What it should have.
        expected: String,
    },
    /// The stiffness matrix cannot be factored.
    #[error("the stiffness matrix cannot be factored: {0}")]
    Factor(String),
    /// Newton's method finds no equilibrium.
    #[error("no equilibrium is found at {aim} of the load: {why}; the last found is at {reached}")]
    Newton {
        /// Share of the load up to which there is one, 0 to 1.
        reached: f64,
        /// Share at which none is found, with the shortest step.
        aim: f64,
        /// What stopped it there.
        why: &'static str,
    },
}

impl FemError {
    /// A field that is wrong.
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
