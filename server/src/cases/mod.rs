//! Cases: written patients of a school with their compiled scenes, in the folder `cases` of the state folder.
//!
//! | file | content |
//! |---|---|
//! | `NAME.patient.toml` | patient file, written by the console's form or by hand |
//! | `NAME.scene` | compiled scene, which plans name |
//! | `NAME.status.json` | facts of the compilation: [`Status`] |
//! | `NAME.SIDE.png` | drawn picture of the compiled scene |
//! | `store.lock`, `compile.lock` | locks; empty |
//!
//! A case is compiled by a process of its own ([`build()`]). The compiled scene stays usable until the next one is
//! whole.

pub mod build;
#[cfg(feature = "console")]
pub mod edit;
pub mod error;
pub mod status;
pub mod store;
pub mod uses;

pub use build::build;
pub use error::CaseError;
pub use status::{State, Status};
pub use store::{CaseStore, Opened};

use crate::plan::names::is_station_name;

/// Words for the form of a name.
pub const EXPECTED: &str =
    "a case's name: 1 to 64 letters, digits, - and _, a letter or digit first, and not `any`";

/// Checks the name of a case. The rule is that of stations.
///
/// # Errors
/// The name has another form.
pub fn check_name(name: &str) -> Result<(), CaseError> {
    match is_station_name(name) {
        true => Ok(()),
        false => Err(CaseError::Name(name.escape_debug().to_string())),
    }
}
