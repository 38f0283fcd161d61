//! Recorded sessions and their grades, as the console sees them.

use std::path::PathBuf;
use std::sync::Arc;

use serde_json::Value;

/// State of a session's grade.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Grading {
    /// The grade is still to be made.
    #[default]
    Waiting,
    /// The session is being replayed.
    Running,
    /// There is a grade.
    Graded,
    /// The session cannot be graded: reason, one sentence.
    Ungradable(String),
    /// The grading program failed: reason, one sentence.
    Failed(String),
}

/// Score of a person in place of the program's proposal.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Revised {
    /// Score, 0 to 100.
    pub score: f64,
    /// Whether the session is passed.
    pub passed: bool,
    /// Opaque id of the person.
    pub by: String,
    /// Date, as text.
    pub at: String,
    /// Reason.
    pub reason: String,
}

/// Recorded session.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recorded {
    /// Name of the recording's file without its ending.
    pub id: String,
    /// Name of the station.
    pub station: String,
    /// Opaque learner id of the recording; empty for an anonymous learner.
    pub learner: String,
    /// Exercise.
    pub exercise: String,
    /// Purpose: `practice`, `self-assessment` or `exam`.
    pub mode: String,
    /// BLAKE3 of the compiled scene, hexadecimal. Sessions with the same value have the same patient.
    pub scene: String,
    /// Beginning, such as `2026-11-26 04:20 UTC`. As text, a later beginning is greater.
    pub started: String,
    /// The same, seconds since 1970.
    pub started_unix_s: u64,
    /// Length of the session, seconds; `None` before the grade.
    pub seconds: Option<f64>,
    /// State of the grade.
    pub grading: Grading,
    /// Score of the program's proposal, 0 to 100.
    pub score: Option<f64>,
    /// Whether the session is passed by the proposal.
    pub passed: Option<bool>,
    /// Score by the learner, given before the proposal was shown.
    pub own_score: Option<f64>,
    /// Scores of persons, the latest last.
    pub revised: Vec<Revised>,
    /// Whether the session is a norm: the recording of an expert.
    pub is_norm: bool,
}

impl Recorded {
    /// Final score and pass: of the latest revision, else of the proposal.
    pub fn counts(&self) -> (Option<f64>, Option<bool>) {
        match self.revised.last() {
            Some(said) => (Some(said.score), Some(said.passed)),
            None => (self.score, self.passed),
        }
    }

    /// Whether the session is an exam.
    pub fn is_exam(&self) -> bool {
        self.mode == "exam"
    }

    /// Whether the learner has to give the own score before the proposal is shown.
    pub fn waits_for_own_score(&self) -> bool {
        self.mode == "self-assessment" && self.own_score.is_none() && self.score.is_some()
    }
}

/// Files of an erased learner.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Erased {
    /// Number of recordings.
    pub recordings: usize,
    /// Number of other files: grades, pages, scores of persons.
    pub files: usize,
}

/// Recorded sessions and their grades.
pub trait Grades: Send + Sync + 'static {
    /// All sessions that have ended, the newest first.
    fn all(&self) -> Arc<Vec<Recorded>>;

    /// Grade of a session as `sulcus-sessions grade --json` prints it; `None` without a grade.
    fn grade(&self, id: &str) -> Option<Arc<Value>>;

    /// Printable sheet of a session's grade, a whole HTML page; `None` without a grade.
    fn sheet(&self, id: &str) -> Option<String>;

    /// File of a session's recording.
    fn file(&self, id: &str) -> Option<PathBuf>;

    /// Replay of some seconds about a moment of a session, a file for the viewer. Takes some seconds.
    ///
    /// # Errors
    /// A sentence for the person: the program that draws the replay is missing, or fails.
    fn replay(&self, id: &str, at_ms: u64) -> Result<Vec<u8>, String>;

    /// Puts a person's score beside the proposal.
    ///
    /// # Errors
    /// A sentence for the person: no such session, no grade yet, or a value that is not valid.
    fn revise(&self, id: &str, revised: Revised) -> Result<(), String>;

    /// Takes the learner's own score of a self-assessment. Only the first counts.
    ///
    /// # Errors
    /// A sentence for the person.
    fn assess(&self, id: &str, own: f64) -> Result<(), String>;

    /// Makes the grade of a session again, such as after an upgrade.
    ///
    /// # Errors
    /// A sentence for the person.
    fn again(&self, id: &str) -> Result<(), String>;

    /// Makes a session a norm for its exercise, or takes that back.
    ///
    /// # Errors
    /// A sentence for the person.
    fn set_norm(&self, id: &str, is_norm: bool, by: &str) -> Result<(), String>;

    /// Table of sessions for a spreadsheet, as CSV: a row for each, in their order. `name` tells the name of a learner;
    /// empty where the key table is closed.
    ///
    /// # Errors
    /// A sentence for the person.
    fn table(&self, rows: &[Recorded], name: &dyn Fn(&str) -> String) -> Result<String, String>;

    /// Archive (zip) with everything that the server has of these sessions: recordings, grades, sheets, scores of
    /// persons. The caller removes the file.
    ///
    /// # Errors
    /// A sentence for the person.
    fn export(&self, ids: &[String]) -> Result<PathBuf, String>;

    /// Removes recordings of a learner, with their grades.
    ///
    /// # Errors
    /// A sentence for the person: a session of the learner runs, or a file cannot be removed.
    fn erase(&self, learner: &str, ids: &[String]) -> Result<Erased, String>;
}
