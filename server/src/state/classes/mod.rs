//! Classes: learners by opaque id, their tasks, codes, seats and exams, for the console and for `sulcus-server class`.
//!
//! - [`record`]: the list of classes as it is stored
//! - [`names`]: the key table, a file of its own, the only place with names
//! - [`import`]: rosters as spreadsheets save them, with a verdict for each line
//! - [`archive`]: classes whose school year has ended
//! - [`task`]: tasks, and the plan that a station gets for a learner
//! - [`codes`]: codes with which learners sign in at a station
//! - [`seal`]: which role sees what of an exam
//! - [`reassigned`]: sessions of another learner than the recording says
//!
//! Every change stands in the audit log before the files change: [`crate::state::audit`].

pub mod archive;
pub mod change;
pub mod codes;
mod exams;
pub mod import;
pub mod names;
pub mod reassigned;
pub mod record;
pub mod seal;
pub mod task;

use crate::state::audit::Audit;
use crate::state::error::StateError;
use crate::state::files::{Lock, Staged, read_private};
use crate::state::folder::StateFolder;

pub use archive::Archived;
pub use names::{Names, Person};
pub use record::{Class, Exam, Learner, Roll, Task};

/// File of the classes.
const FILE: &str = "classes.json";
/// Lock of the classes and of the key table.
const LOCK: &str = "classes.lock";
/// Largest file that is read, bytes.
const MOST_BYTES: u64 = 16 << 20;

/// Reason why a question about classes has no answer, or a change is not made.
#[derive(Debug, thiserror::Error)]
pub enum ClassError {
    /// No class, learner or exam has the id.
    #[error("{0}")]
    Unknown(String),
    /// A value is not valid: field, value found, value expected.
    #[error("{0}")]
    Invalid(String),
    /// The person may not do this.
    #[error("{0}")]
    Forbidden(String),
    /// The classes are no longer as they were shown.
    #[error("{0}")]
    Changed(String),
    /// A file cannot be used.
    #[error(transparent)]
    State(#[from] StateError),
}

/// All classes and the key table.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Book {
    /// Classes, learners, exams and seats.
    pub roll: Roll,
    /// Names of the learners.
    pub names: Names,
}

/// Classes of a state folder, changed in the name of a person.
#[derive(Clone, Debug)]
pub struct Classes {
    folder: StateFolder,
    by: String,
}

/// Line for the audit log: action and object.
pub type Act = (&'static str, String);

impl Classes {
    /// Classes of `folder`. `by` is the id of a token, or `shell (uid N)`.
    pub fn of(folder: &StateFolder, by: &str) -> Self {
        Self {
            folder: folder.clone(),
            by: by.to_owned(),
        }
    }

    /// Classes, learners and names at present.
    ///
    /// # Errors
    /// A file cannot be read, can be read by other users, or is not valid.
    pub fn load(&self) -> Result<Book, StateError> {
        Ok(Book {
            roll: self.roll()?,
            names: Names::load(&self.folder)?,
        })
    }

    /// Classes and learners without their names.
    ///
    /// # Errors
    /// The file cannot be read, can be read by other users, or is not valid.
    pub fn roll(&self) -> Result<Roll, StateError> {
        let path = self.folder.file(FILE);
        match read_private(&path, MOST_BYTES)? {
            Some(bytes) => parse(&bytes).map_err(|why| StateError::content(&path, why)),
            None => Ok(Roll::default()),
        }
    }

    /// State folder of the classes.
    pub fn folder(&self) -> &StateFolder {
        &self.folder
    }

    /// Audit log, written in the name of the same person.
    pub fn audit(&self) -> Audit {
        Audit::of(&self.folder)
    }

    /// Changes the classes under the lock. The audit log is written first: a change without an entry is not possible.
    fn change<R>(
        &self,
        change: impl FnOnce(&mut Book) -> Result<(R, Vec<Act>), ClassError>,
    ) -> Result<R, ClassError> {
        let _lock = Lock::wait(&self.folder.file(LOCK))?;
        let before = self.load()?;
        let mut book = before.clone();
        let (result, acts) = change(&mut book)?;
        book.roll.tidy();
        if book == before {
            return Ok(result);
        }
        // All that needs space on the disk comes before the entries: a full disk leaves no entry of a failed change.
        let mut staged = Vec::new();
        if book.names != before.names {
            book.names.is_open = true;
            staged.push(book.names.stage(&self.folder)?);
        }
        if book.roll != before.roll {
            let path = self.folder.file(FILE);
            let bytes = serde_json::to_vec_pretty(&book.roll);
            let mut bytes = bytes.map_err(|error| StateError::content(&path, error.to_string()))?;
            bytes.push(b'\n');
            staged.push(Staged::write(&path, &bytes)?);
        }
        for (action, object) in acts {
            self.audit().record(&self.by, action, &object)?;
        }
        // A crash between the two leaves a name without a class; the next import finds its id again.
        staged.into_iter().try_for_each(Staged::commit)?;
        Ok(result)
    }
}

fn parse(bytes: &[u8]) -> Result<Roll, String> {
    let roll: Roll = serde_json::from_slice(bytes).map_err(|error| error.to_string())?;
    if roll.version != record::VERSION {
        return Err(format!(
            "version is {}, expected {}; install the program that wrote the file",
            roll.version,
            record::VERSION
        ));
    }
    for (what, found, most) in [
        ("classes", roll.classes.len(), record::MOST_CLASSES),
        ("learners", roll.learners.len(), record::MOST_LEARNERS),
        (
            "archived classes",
            roll.archived.len(),
            archive::MOST_ARCHIVED,
        ),
    ] {
        if found > most {
            return Err(format!("{found} {what}, expected at most {most}"));
        }
    }
    for class in &roll.classes {
        change::class_name(&class.name).map_err(|error| error.to_string())?;
    }
    for class in &roll.archived {
        change::class_name(&class.name).map_err(|error| error.to_string())?;
        for id in &class.learners {
            if let Err(expected) = import::learner_id(id) {
                let id = id.escape_debug();
                return Err(format!("learner is `{id}`: {expected}"));
            }
        }
    }
    for learner in &roll.learners {
        let (id, class) = (learner.id.escape_debug(), &learner.class);
        if let Err(expected) = import::learner_id(&learner.id) {
            return Err(format!("learner is `{id}`: {expected}"));
        }
        if roll.class(class).is_none() {
            let class = class.escape_debug();
            return Err(format!(
                "class of learner {id} is `{class}`, expected the id of a class"
            ));
        }
    }
    Ok(roll)
}

/// Text of a person without control characters, for output on one line.
pub(crate) fn plain(text: &str) -> String {
    text.chars().filter(|c| !c.is_control()).collect()
}

/// Text of a person for a message: short, on one line.
pub(crate) fn told(text: &str) -> String {
    text.escape_debug().take(80).collect()
}

#[cfg(test)]
mod tests;
