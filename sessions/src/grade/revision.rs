//! What people say of a grade, kept beside the recording: `FILE.grade.json` has the program's proposal as it was, the learner's own
//! score from before it was shown, and a list of an instructor's revisions that only grows. Who and when are given from outside:
//! an opaque id, a date as text.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use sulcus_program::PathText;

use super::report::Grade;

/// One instructor's word.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Revision {
    /// Score instead, 0 to 100.
    pub score: f64,
    /// Whether it is passed.
    pub passed: bool,
    /// Opaque id of who says so.
    pub by: String,
    /// When, as given.
    pub at: String,
    /// Why.
    pub reason: String,
}

/// What the program proposed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Proposal {
    /// Score; null where there was no grade.
    pub score: Option<f64>,
    /// Whether it was passed.
    pub passed: Option<bool>,
    /// Name and version of the rubric, and blake3 of its text.
    pub rubric: String,
    /// See `rubric`.
    pub rubric_version: u32,
    /// See `rubric`.
    pub rubric_blake3: String,
    /// Learner.
    pub learner_id: String,
    /// When the session began, nanoseconds since the Unix epoch.
    pub started_unix_ns: u64,
}

/// The file beside a recording.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sidecar {
    /// What the program proposed when the file was begun.
    pub proposal: Proposal,
    /// The learner's own score, 0 to 100, given before the proposal was shown for the first time.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub self_score: Option<f64>,
    /// What was said since, the oldest first.
    pub revisions: Vec<Revision>,
}

/// Why what was said cannot be read or kept.
#[derive(Debug, thiserror::Error)]
pub enum RevisionError {
    /// The file cannot be read or written.
    #[error("revisions `{path}`: {why}")]
    File {
        /// The file.
        path: String,
        /// Why not.
        why: String,
    },
    /// A value is not as it must be.
    #[error("revision: {field} is {found}, expected {expected}")]
    Field {
        /// What of it.
        field: &'static str,
        /// Value found.
        found: String,
        /// What it must be.
        expected: String,
    },
}

impl RevisionError {
    /// Another own score than the first, which counts: whoever gives another has seen the grade.
    pub fn another(own: f64, first: f64) -> Self {
        Self::Field {
            field: "self_score",
            found: own.to_string(),
            expected: format!("{first}, which was given first"),
        }
    }
}

/// Longest text of a revision, and largest file of them, bytes.
const MOST_TEXT: usize = 4096;
const MOST_FILE: u64 = 16 << 20;

impl Proposal {
    /// Of a grade.
    pub fn of(grade: &Grade) -> Self {
        let rubric = grade.rubric.as_ref();
        Self {
            score: grade.score,
            passed: grade.passed,
            rubric: rubric.map_or(String::new(), |used| used.name.clone()),
            rubric_version: rubric.map_or(0, |used| used.version),
            rubric_blake3: rubric.map_or(String::new(), |used| used.blake3.clone()),
            learner_id: grade.learner_id.clone(),
            started_unix_ns: grade.started_unix_ns,
        }
    }

    /// What was proposed, in words, where `now` something else is: another score, or by another rubric.
    pub fn differs(&self, now: &Self) -> Option<String> {
        let same = (self.score, &self.rubric_blake3) == (now.score, &now.rubric_blake3);
        let score = self
            .score
            .map_or("no grade".into(), |score| format!("{score:.1}"));
        (!same).then(|| {
            let (name, version) = (self.rubric.escape_debug(), self.rubric_version);
            format!("{score} by rubric {name}, version {version}")
        })
    }
}

/// The file beside a recording: its whole name, and `.grade.json`.
pub fn beside(recording: &Path) -> PathBuf {
    let mut name = recording.as_os_str().to_owned();
    name.push(".grade.json");
    name.into()
}

impl Revision {
    /// Whether every value is as it must be.
    ///
    /// # Errors
    /// Names the first that is not.
    pub fn check(&self) -> Result<(), RevisionError> {
        let wrong = |field, found: String, expected: &str| {
            Err(RevisionError::Field {
                field,
                found,
                expected: expected.into(),
            })
        };
        if !(0.0..=100.0).contains(&self.score) {
            return wrong("score", self.score.to_string(), "0 to 100");
        }
        for (field, text) in [("by", &self.by), ("at", &self.at), ("reason", &self.reason)] {
            if text.trim().is_empty() || text.len() > MOST_TEXT {
                let found = format!("{} bytes long", text.len());
                return wrong(field, found, "1 to 4096 bytes, not blank");
            }
        }
        Ok(())
    }
}

/// Whether a learner's own score is one.
fn check_own(score: f64) -> Result<(), RevisionError> {
    if (0.0..=100.0).contains(&score) {
        return Ok(());
    }
    Err(RevisionError::Field {
        field: "self_score",
        found: score.to_string(),
        expected: "0 to 100".into(),
    })
}

impl Sidecar {
    /// What is beside a recording; none where there is nothing.
    ///
    /// # Errors
    /// When there is something, and it is not that.
    pub fn read(recording: &Path) -> Result<Option<Self>, RevisionError> {
        let path = beside(recording);
        let failed = |why: String| RevisionError::File {
            path: path.shown().to_string(),
            why,
        };
        match std::fs::metadata(&path) {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(failed(error.to_string())),
            Ok(file) if file.len() > MOST_FILE => {
                return Err(failed(format!(
                    "{} bytes long, expected at most 16 MiB",
                    file.len()
                )));
            }
            Ok(_) => {}
        }
        let text = std::fs::read_to_string(&path).map_err(|error| failed(error.to_string()))?;
        let found: Self = serde_json::from_str(&text).map_err(|error| {
            failed(format!(
                "{error}, expected as this program writes it with --revise and --self-score"
            ))
        })?;
        for revision in &found.revisions {
            revision.check()?;
        }
        found.self_score.map_or(Ok(()), check_own)?;
        Ok(Some(found))
    }

    /// Whether it is about this grade's session.
    ///
    /// # Errors
    /// Names what is of another session.
    pub fn belongs_to(&self, grade: &Grade) -> Result<(), RevisionError> {
        let (was, is) = (&self.proposal, Proposal::of(grade));
        if (&was.learner_id, was.started_unix_ns) == (&is.learner_id, is.started_unix_ns) {
            return Ok(());
        }
        Err(RevisionError::Field {
            field: "proposal",
            found: format!(
                "of learner `{}` at {}",
                was.learner_id.escape_debug(),
                was.started_unix_ns
            ),
            expected: format!(
                "learner `{}` at {}",
                is.learner_id.escape_debug(),
                is.started_unix_ns
            ),
        })
    }

    /// Adds a revision to what is beside the recording; the proposal stays as it was first.
    ///
    /// # Errors
    /// When a value is not as it must be, what is there is of another session, or it cannot be written.
    pub fn add(recording: &Path, grade: &Grade, revision: Revision) -> Result<Self, RevisionError> {
        revision.check()?;
        let mut sidecar = Self::begun(recording, grade)?;
        sidecar.revisions.push(revision);
        sidecar.write(recording)?;
        Ok(sidecar)
    }

    /// Keeps the learner's own score. The first one counts: whoever gives another has seen the grade.
    ///
    /// # Errors
    /// When it is no score, another was kept before, what is there is of another session, or it cannot be written.
    pub fn assess(recording: &Path, grade: &Grade, own: f64) -> Result<(), RevisionError> {
        check_own(own)?;
        let mut sidecar = Self::begun(recording, grade)?;
        match sidecar.self_score {
            Some(first) if first == own => return Ok(()),
            Some(first) => return Err(RevisionError::another(own, first)),
            None => sidecar.self_score = Some(own),
        }
        sidecar.write(recording)
    }

    /// What is beside the recording, or a new one.
    fn begun(recording: &Path, grade: &Grade) -> Result<Self, RevisionError> {
        let sidecar = Self::read(recording)?.unwrap_or_else(|| Self {
            proposal: Proposal::of(grade),
            self_score: None,
            revisions: Vec::new(),
        });
        sidecar.belongs_to(grade)?;
        Ok(sidecar)
    }

    fn write(&self, recording: &Path) -> Result<(), RevisionError> {
        let path = beside(recording);
        let failed = |why: String| RevisionError::File {
            path: path.shown().to_string(),
            why,
        };
        let text = serde_json::to_string_pretty(self).map_err(|error| failed(error.to_string()))?;
        // Whole or not at all: what was said before must not be lost.
        let draft = path.with_extension("json.new");
        std::fs::write(&draft, text + "\n")
            .and_then(|()| std::fs::rename(&draft, &path))
            .map_err(|error| failed(error.to_string()))
    }

    /// The last word; none where nothing was said.
    pub fn latest(&self) -> Option<&Revision> {
        self.revisions.last()
    }
}
