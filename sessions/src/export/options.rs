//! Options of an export.

use super::error::ExportError;
use super::mesh_file::MeshFormat;

/// Options of an export.
#[derive(Clone, Debug, PartialEq)]
pub struct ExportOptions {
    /// Tables `ticks.csv` and `events.csv`, and `devices.csv` for a recording with samples of devices.
    pub tables: bool,
    /// Number of ticks per line of `ticks.csv`.
    pub every_ticks: u64,
    /// Format of the meshes; `None` for no meshes.
    pub meshes: Option<MeshFormat>,
    /// Times of meshes, seconds from the first row.
    pub at_s: Vec<f64>,
    /// Time between meshes, seconds.
    pub every_s: Option<f64>,
}

impl ExportOptions {
    pub(super) fn check(&self) -> Result<(), ExportError> {
        let wrong = |field, found: String, expected| {
            Err(ExportError::Option {
                field,
                found,
                expected,
            })
        };
        if self.every_ticks == 0 {
            return wrong("every_ticks", "0".to_owned(), "1 or more");
        }
        if let Some(at) = self.at_s.iter().find(|at| !(at.is_finite() && **at >= 0.0)) {
            return wrong("at", at.to_string(), "0 s or more");
        }
        match self.every_s {
            Some(every) if !(every.is_finite() && every > 0.0) => {
                wrong("every", every.to_string(), "more than 0 s")
            }
            _ => Ok(()),
        }
    }
}
