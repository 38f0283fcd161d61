//! Lines of a roster, their verdicts, and the report of an import.

use std::fmt;

use serde::Serialize;

use crate::state::classes::plain;

/// A line of a roster. A value that is not given is empty.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Row {
    /// Line in the file, from 1.
    pub line: u64,
    /// Opaque id of the learner.
    pub learner: String,
    /// Id of the person in the school's own system.
    pub sourced_id: String,
    /// Name for signing in to the school's own system.
    pub username: String,
    /// Given name.
    pub given: String,
    /// Family name.
    pub family: String,
    /// Name of the class.
    pub class: String,
}

/// A line of a roster, and what the import does with it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Line {
    /// Line in the file, from 1.
    pub line: u64,
    /// Opaque id of the learner; empty where an id is still to be made, or none was found.
    pub learner: String,
    /// Name of the person, as given.
    pub name: String,
    /// Name of the class.
    pub class: String,
    /// Effect of the line.
    #[serde(flatten)]
    pub verdict: Verdict,
}

/// Effect of a line of a roster.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(tag = "verdict", rename_all = "snake_case")]
pub enum Verdict {
    /// The person comes into the list.
    New,
    /// The person is in the class already.
    Kept,
    /// The person is in the class, and gets another name.
    Renamed {
        /// Name before; empty if there was none.
        before: String,
    },
    /// The person is known, and comes into another class; a new name is taken over.
    Moved {
        /// Name of the class before; empty for a person who was in none.
        from: String,
    },
    /// The line is not valid and changes nothing.
    Refused {
        /// Field, value found, value expected.
        why: String,
    },
}

impl Verdict {
    /// Word for tables.
    pub fn word(&self) -> &'static str {
        match self {
            Self::New => "new",
            Self::Kept => "kept",
            Self::Renamed { .. } => "renamed",
            Self::Moved { .. } => "moved",
            Self::Refused { .. } => "refused",
        }
    }

    /// Words beside the verdict; may be empty.
    pub fn details(&self) -> String {
        match self {
            Self::New | Self::Kept => String::new(),
            Self::Renamed { before } if before.is_empty() => "had no name".into(),
            Self::Renamed { before } => format!("was {before}"),
            Self::Moved { from } if from.is_empty() => "was in no class".into(),
            Self::Moved { from } => format!("was in {from}"),
            Self::Refused { why } => why.clone(),
        }
    }
}

impl fmt::Display for Line {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (line, word) = (self.line, self.verdict.word());
        write!(f, "line {line}: {word}")?;
        let parts = [&self.learner, &self.name, &self.class];
        for part in parts.into_iter().filter(|part| !part.is_empty()) {
            write!(f, ", {}", plain(part))?;
        }
        match self.verdict.details() {
            details if details.is_empty() => Ok(()),
            details => write!(f, ": {details}"),
        }
    }
}

/// Report of an import, or of its dry run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Report {
    /// Lines in the order of the file.
    pub lines: Vec<Line>,
    /// Names of the classes that the import makes.
    pub new_classes: Vec<String>,
    /// Learners of the classes of the roster who are not in the roster. They stay.
    pub absent: usize,
    /// Hash of the roster and its effect: the import of exactly this report.
    pub hash: String,
}

impl Report {
    /// Number of lines with a verdict of this word.
    pub fn count(&self, word: &str) -> usize {
        let lines = self.lines.iter();
        lines.filter(|line| line.verdict.word() == word).count()
    }
}
