//! Errors of the store of cases.

use sulcus_program::PathText;
use sulcus_scene::file::FileError;

use super::EXPECTED;
use crate::state::StateError;

/// Reason why a case cannot be read, changed or compiled.
#[derive(Debug, thiserror::Error)]
pub enum CaseError {
    /// The name has another form.
    #[error("name is `{0}`, expected {EXPECTED}")]
    Name(String),
    /// No case has the name.
    #[error("the case `{name}` does not exist; {known}")]
    Unknown {
        /// Name.
        name: String,
        /// Names that exist, a part of the sentence.
        known: String,
    },
    /// A case has the name already.
    #[error("the case `{0}` exists already: choose another name")]
    Exists(String),
    /// The store is full.
    #[error("the store has {0} cases, which is the largest number: remove one first")]
    Full(usize),
    /// The file was changed after the reader had loaded the file.
    #[error(
        "the case `{0}` was changed by another person in the meantime: load the case again, or save a copy"
    )]
    Conflict(String),
    /// A plan uses the case.
    #[error("the case `{name}` is in the plan of {}: assign another plan there first", .users.join(", "))]
    InUse {
        /// Name.
        name: String,
        /// Stations, classes and learners.
        users: Vec<String>,
    },
    /// The patient is not valid.
    #[error("the case `{name}` cannot be compiled: {why}")]
    NotValid {
        /// Name.
        name: String,
        /// First fault and the number of others.
        why: String,
    },
    /// The case has no compiled scene yet.
    #[error("the case `{0}` is not compiled yet")]
    NotCompiled(String),
    /// The patient file cannot be parsed.
    #[error(transparent)]
    File(#[from] FileError),
    /// The patient file has text that is not UTF-8.
    #[error("{}: the file is no text, expected a patient file", .0.shown())]
    NoText(std::path::PathBuf),
    /// A part of an edit cannot be written into the file.
    #[error(
        "the file of the case `{0}` is written in a form that the page cannot change without loss: change the file by hand"
    )]
    Form(String),
    /// The state folder cannot be used.
    #[error(transparent)]
    State(#[from] StateError),
}
