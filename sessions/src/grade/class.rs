//! A class in one table: a row for each session, and what its pages and its CSV are made of.

use super::names::Names;
use super::report::Grade;
use super::revision::Sidecar;

/// One session of a class.
#[derive(Clone, Debug, PartialEq)]
pub struct Session {
    /// Name of the recording's file, without its folder.
    pub file: String,
    /// Its grade.
    pub grade: Grade,
    /// What an instructor said.
    pub sidecar: Option<Sidecar>,
    /// The learner's own score, where it was asked for.
    pub self_score: Option<f64>,
    /// Which attempt of this learner at this exercise it is, from 1.
    pub attempt: usize,
}

/// Numbers the attempts: sessions of one learner at one exercise, by when they began.
pub fn number_attempts(sessions: &mut [Session]) {
    sessions.sort_by(|a, b| {
        let key = |s: &Session| {
            let grade = &s.grade;
            (
                grade.exercise.clone(),
                grade.learner_id.clone(),
                grade.started_unix_ns,
                s.file.clone(),
            )
        };
        key(a).cmp(&key(b))
    });
    let mut last: Option<(String, String)> = None;
    let mut attempt = 0;
    for session in sessions {
        let who = (
            session.grade.exercise.clone(),
            session.grade.learner_id.clone(),
        );
        attempt = if last.as_ref() == Some(&who) {
            attempt + 1
        } else {
            1
        };
        session.attempt = attempt;
        last = Some(who);
    }
}

/// A table for spreadsheets: learner, attempt, score, every metric's value, and what an instructor said. Names only where a
/// key table is given.
///
/// # Errors
/// When a row cannot be written.
pub fn csv(sessions: &[Session], names: Option<&Names>) -> Result<String, csv::Error> {
    let mut metrics: Vec<&str> = Vec::new();
    for known in super::definitions::METRICS {
        if sessions
            .iter()
            .any(|session| session.grade.metric(known.name).is_some())
        {
            metrics.push(known.name);
        }
    }
    let mut out = csv::Writer::from_writer(Vec::new());
    let mut header = vec!["file", "learner_id"];
    header.extend(names.map(|_| "name"));
    header.extend([
        "exercise",
        "attempt",
        "started_unix_ns",
        "rubric",
        "rubric_version",
        "rubric_source",
        "migrated_from_format",
        "gradable",
        "reason",
        "score",
        "passed",
        "self_score",
        "revised_score",
        "revised_passed",
        "revised_at",
        "revised_by",
        "revised_reason",
    ]);
    header.extend(&metrics);
    out.write_record(&header)?;
    let number = |x: Option<f64>| x.map_or(String::new(), |x| x.to_string());
    for session in sessions {
        let grade = &session.grade;
        let used = grade.rubric.as_ref();
        let latest = session.sidecar.as_ref().and_then(Sidecar::latest);
        let mut row = vec![plain(&session.file), plain(&grade.learner_id)];
        row.extend(names.map(|names| plain(names.of(&grade.learner_id).unwrap_or(""))));
        row.extend([
            plain(&grade.exercise),
            session.attempt.to_string(),
            grade.started_unix_ns.to_string(),
            used.map_or(String::new(), |used| plain(&used.name)),
            used.map_or(String::new(), |used| used.version.to_string()),
            used.map_or(String::new(), |used| used.source.words().to_owned()),
            grade
                .migrated
                .as_ref()
                .map_or(String::new(), |migrated| migrated.migration.from.to_owned()),
            grade.gradable.to_string(),
            grade.reason.as_deref().map_or(String::new(), plain),
            number(grade.score),
            grade
                .passed
                .map_or(String::new(), |passed| passed.to_string()),
            number(session.self_score),
            number(latest.map(|said| said.score)),
            latest.map_or(String::new(), |said| said.passed.to_string()),
            latest.map_or(String::new(), |said| plain(&said.at)),
            latest.map_or(String::new(), |said| plain(&said.by)),
            latest.map_or(String::new(), |said| plain(&said.reason)),
        ]);
        row.extend(
            metrics
                .iter()
                .map(|name| number(grade.metric(name).and_then(|metric| metric.value))),
        );
        out.write_record(&row)?;
    }
    let bytes = out.into_inner().map_err(|error| error.into_error())?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// Text that a spreadsheet does not take for a formula.
fn plain(text: &str) -> String {
    if text.starts_with(['=', '+', '-', '@', '\t', '\r']) {
        format!("'{text}")
    } else {
        text.to_owned()
    }
}
