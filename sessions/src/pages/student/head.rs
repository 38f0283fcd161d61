//! Head of a session's page: learner, exercise, recording, score.

use super::super::{Look, date};
use crate::grade::class::Session;
use crate::grade::text;

/// Facts of the head, as the template `student/head.html` takes them.
pub struct Head<'a> {
    /// Name and id of the learner.
    pub learner: String,
    /// Exercise.
    pub exercise: &'a str,
    /// Number of the attempt; 0 if it is not known.
    pub attempt: usize,
    /// Beginning of the session.
    pub date: String,
    /// Station.
    pub station: &'a str,
    /// Mode of the session.
    pub mode: String,
    /// Rubric.
    pub rubric: String,
    /// Name of the recording's file.
    pub file: &'a str,
    /// Beginning of the signer's key.
    pub key: &'a str,
    /// Whether the key was given from outside.
    pub trusted: bool,
    /// Migration of a recording of a former version.
    pub migrated: Option<String>,
    /// Reservations about the grade: kind and details.
    pub reservations: Vec<(&'static str, String)>,
    /// Proposed score; none without a grade.
    pub score: Option<f64>,
    /// Verdict of the proposal in words.
    pub verdict: &'static str,
    /// Score from which the session is passed.
    pub pass_mark: f64,
}

impl<'a> Head<'a> {
    /// Head of a session.
    pub fn of(session: &'a Session, look: &Look<'_>) -> Self {
        let grade = &session.grade;
        Self {
            learner: look.learner(&grade.learner_id),
            exercise: &grade.exercise,
            attempt: session.attempt,
            date: date(grade.started_unix_ns),
            station: match grade.station.as_str() {
                "" => "(none)",
                station => station,
            },
            mode: session.shown.words(),
            rubric: text::rubric(grade),
            file: &session.file,
            key: &grade.signer[..grade.signer.len().min(16)],
            trusted: grade.signer_trusted,
            migrated: grade.migrated.as_ref().map(ToString::to_string),
            reservations: grade.reservations(),
            score: grade.score,
            verdict: grade.verdict().unwrap_or_default(),
            pass_mark: grade.pass_mark.unwrap_or_default(),
        }
    }
}
