//! Revisions of a grade, stored beside the recording in `FILE.grade.json`.
//!
//! The file has the program's first proposal, the learner's own score from before the proposal was shown, and a growing
//! list of instructors' revisions. Instructors give their opaque id and the date as text.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use sulcus_program::PathText;

use super::report::Grade;

/// Revision by an instructor.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Revision {
    /// Score, 0 to 100, instead of the proposal.
    pub score: f64,
    /// Whether the session is passed.
    pub passed: bool,
    /// Opaque id of the instructor.
    pub by: String,
    /// Date, as text.
    pub at: String,
    /// Reason.
    pub reason: String,
}

/// Proposal of the program.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Proposal {
    /// Score; null without a grade.
    pub score: Option<f64>,
    /// Whether the session was passed; null without a grade.
    pub passed: Option<bool>,
    /// Name of the rubric.
    pub rubric: String,
    /// Version of the rubric.
    pub rubric_version: u32,
    /// blake3 of the rubric's text, hexadecimal.
    pub rubric_blake3: String,
    /// Opaque id of the learner.
    pub learner_id: String,
    /// Beginning of the session, nanoseconds since the Unix epoch.
    pub started_unix_ns: u64,
}

/// Content of the file beside a recording.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sidecar {
    /// Proposal of the program when the file was first written.
    pub proposal: Proposal,
    /// Learner's own score, 0 to 100, given before the proposal was first shown.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub self_score: Option<f64>,
    /// Revisions, the oldest first.
    pub revisions: Vec<Revision>,
}

/// Failure to read or write the file, or a value that is not valid.
#[derive(Debug, thiserror::Error)]
pub enum RevisionError {
    /// File that cannot be read or written.
    #[error("revisions `{path}`: {why}")]
    File {
        /// Path of the file.
        path: String,
        /// Reason.
        why: String,
    },
    /// Value that is not valid.
    #[error("revision: {field} is {found}, expected {expected}")]
    Field {
        /// Name of the value.
        field: &'static str,
        /// Value found.
        found: String,
        /// Value expected.
        expected: String,
    },
}

impl RevisionError {
    /// Error of a second own score `own` after the first. Only the first counts: the grade was shown after it.
    pub fn another(own: f64, first: f64) -> Self {
        Self::Field {
            field: "self_score",
            found: own.to_string(),
            expected: format!("{first}, the first own score"),
        }
    }
}

/// Longest text of a revision, bytes.
const MOST_TEXT: usize = 4096;
/// Largest file that is read, bytes.
const MOST_FILE: u64 = 16 << 20;

impl Proposal {
    /// Proposal of a grade.
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

    /// Proposal in the JSON object that `grade --json` prints for a session. None for any other object.
    pub fn of_json(grade: &serde_json::Value) -> Option<Self> {
        let rubric = &grade["rubric"];
        let text = |value: &serde_json::Value| value.as_str().unwrap_or_default().to_owned();
        let version = rubric["version"].as_u64().unwrap_or_default();
        Some(Self {
            score: grade["score"].as_f64(),
            passed: grade["passed"].as_bool(),
            rubric: text(&rubric["name"]),
            rubric_version: u32::try_from(version).ok()?,
            rubric_blake3: text(&rubric["blake3"]),
            learner_id: grade["learner_id"].as_str()?.to_owned(),
            started_unix_ns: grade["started_unix_ns"].as_u64()?,
        })
    }

    /// This proposal in words, if `now` has another score or another rubric. None if both agree.
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

/// Path of the file beside a recording: the recording's path with `.grade.json` appended.
pub fn beside(recording: &Path) -> PathBuf {
    let mut name = recording.as_os_str().to_owned();
    name.push(".grade.json");
    name.into()
}

impl Revision {
    /// Checks every value.
    ///
    /// # Errors
    /// The first value that is not valid.
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

/// Checks the range of a learner's own score.
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
    /// Reads the file beside a recording. None without such a file.
    ///
    /// # Errors
    /// A file that cannot be read, is no such file, or has a value that is not valid.
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
                "{error}, expected a file that --revise or --self-score wrote"
            ))
        })?;
        for revision in &found.revisions {
            revision.check()?;
        }
        found.self_score.map_or(Ok(()), check_own)?;
        Ok(Some(found))
    }

    /// Checks that the file belongs to the session of this proposal.
    ///
    /// # Errors
    /// Learner and beginning of both sessions, if they differ.
    pub fn belongs_to(&self, is: &Proposal) -> Result<(), RevisionError> {
        let was = &self.proposal;
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

    /// Appends a revision to the file beside the recording. The first proposal stays.
    ///
    /// # Errors
    /// A value that is not valid, a file of another session, or a file that cannot be written.
    pub fn add(
        recording: &Path,
        proposal: &Proposal,
        revision: Revision,
    ) -> Result<Self, RevisionError> {
        revision.check()?;
        let mut sidecar = Self::begun(recording, proposal)?;
        sidecar.revisions.push(revision);
        sidecar.write(recording)?;
        Ok(sidecar)
    }

    /// Stores the learner's own score. Only the first counts: the grade is shown after it.
    ///
    /// # Errors
    /// A score out of range, another own score in the file, a file of another session, or a file that cannot be
    /// written.
    pub fn assess(recording: &Path, proposal: &Proposal, own: f64) -> Result<(), RevisionError> {
        check_own(own)?;
        let mut sidecar = Self::begun(recording, proposal)?;
        match sidecar.self_score {
            Some(first) if first == own => return Ok(()),
            Some(first) => return Err(RevisionError::another(own, first)),
            None => sidecar.self_score = Some(own),
        }
        sidecar.write(recording)
    }

    /// Content of the file beside the recording, or a new one with this proposal.
    fn begun(recording: &Path, proposal: &Proposal) -> Result<Self, RevisionError> {
        let sidecar = Self::read(recording)?.unwrap_or_else(|| Self {
            proposal: proposal.clone(),
            self_score: None,
            revisions: Vec::new(),
        });
        sidecar.belongs_to(proposal)?;
        Ok(sidecar)
    }

    fn write(&self, recording: &Path) -> Result<(), RevisionError> {
        let path = beside(recording);
        let failed = |why: String| RevisionError::File {
            path: path.shown().to_string(),
            why,
        };
        let text = serde_json::to_string_pretty(self).map_err(|error| failed(error.to_string()))?;
        // A draft is renamed, so that a failed write cannot destroy earlier revisions.
        let draft = path.with_extension("json.new");
        std::fs::write(&draft, text + "\n")
            .and_then(|()| std::fs::rename(&draft, &path))
            .map_err(|error| failed(error.to_string()))
    }

    /// Latest revision. None without a revision.
    pub fn latest(&self) -> Option<&Revision> {
        self.revisions.last()
    }
}
