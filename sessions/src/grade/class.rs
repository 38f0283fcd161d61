//! Sessions of a class: attempts, final scores, and the CSV table.

use super::names::Names;
use super::report::Grade;
use super::revision::Sidecar;
use crate::export::cells;
use crate::pages::date;
use crate::record::mode::Mode;

/// Mode of a session: as shown and as recorded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Shown {
    /// Mode in which the session is shown.
    pub mode: Mode,
    /// Recorded mode. None for a recording without a mode.
    pub recorded: Option<Mode>,
}

impl Shown {
    /// Mode in words, for people.
    pub fn words(self) -> String {
        match self.recorded {
            Some(recorded) if recorded != self.mode => {
                format!("{recorded}, shown as {}", self.mode)
            }
            _ => self.mode.to_string(),
        }
    }
}

/// Session of a class.
#[derive(Clone, Debug, PartialEq)]
pub struct Session {
    /// Name of the recording's file, without its folder.
    pub file: String,
    /// Grade.
    pub grade: Grade,
    /// Revisions and the learner's own score, stored beside the recording.
    pub sidecar: Option<Sidecar>,
    /// Learner's own score, in self-assessment.
    pub self_score: Option<f64>,
    /// Mode of the session.
    pub shown: Shown,
    /// Number of the learner's attempt at this exercise, from 1.
    pub attempt: usize,
}

impl Session {
    /// Whether the session is shown as an exam: without advice and without values that tell depths.
    pub fn is_exam(&self) -> bool {
        self.shown.mode == Mode::Exam
    }

    /// Whether both sessions are attempts of one learner at one exercise, both exams or neither.
    /// A session without a learner id has no other attempts.
    pub fn is_of_the_same(&self, other: &Self) -> bool {
        let (a, b) = (&self.grade, &other.grade);
        !a.learner_id.is_empty()
            && a.learner_id == b.learner_id
            && a.exercise == b.exercise
            && self.is_exam() == other.is_exam()
    }

    /// Content, to compare copies: whether a grade exists, the number of revisions, whether an own score exists.
    pub fn says(&self) -> (bool, usize, bool) {
        let said = self.sidecar.as_ref();
        let revisions = said.map_or(0, |sidecar| sidecar.revisions.len());
        (
            self.grade.score.is_some(),
            revisions,
            self.self_score.is_some(),
        )
    }

    /// Final score, and whether the session is passed: the latest revision, else the program's proposal.
    pub fn counts(&self) -> (Option<f64>, Option<bool>) {
        let latest = self.sidecar.as_ref().and_then(Sidecar::latest);
        match latest {
            Some(said) => (Some(said.score), Some(said.passed)),
            None => (self.grade.score, self.grade.passed),
        }
    }

    /// Whether both are the same session: one recording and its copy.
    pub fn is(&self, other: &Self) -> bool {
        let (a, b) = (&self.grade, &other.grade);
        (a.started_unix_ns, a.seed) == (b.started_unix_ns, b.seed)
            && (&a.exercise, &a.learner_id) == (&b.exercise, &b.learner_id)
            && (&a.station, &a.signer) == (&b.station, &b.signer)
    }
}

/// Numbers the attempts: sessions of one learner at one exercise in the order of their beginnings, exams apart.
pub fn number_attempts(sessions: &mut [Session]) {
    sessions.sort_by(|a, b| {
        let key = |s: &Session| {
            let grade = &s.grade;
            (
                grade.exercise.clone(),
                grade.learner_id.clone(),
                s.is_exam(),
                grade.started_unix_ns,
                s.file.clone(),
            )
        };
        key(a).cmp(&key(b))
    });
    for attempts in sessions.chunk_by_mut(Session::is_of_the_same) {
        for (k, session) in attempts.iter_mut().enumerate() {
            session.attempt = k + 1;
        }
    }
}

/// CSV table for spreadsheets. A session's row has learner, attempt, scores, revision and the value of every metric.
/// A file that could not be read has a row with the reason. The column of names exists only with a key table.
/// Text that a spreadsheet would change begins with an apostrophe; a signer always does.
///
/// # Errors
/// A row that cannot be written.
pub fn csv(
    sessions: &[Session],
    unread: &[(String, String)],
    names: Option<&Names>,
) -> Result<String, csv::Error> {
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
        "mode",
        "recorded_mode",
        "started_utc",
        "started_unix_ns",
        "rubric",
        "rubric_version",
        "rubric_source",
        "migrated_from_format",
        "signer",
        "signer_trusted",
        "gradable",
        "reason",
        "score",
        "passed",
        "pass_mark",
        "self_score",
        "revised_score",
        "revised_passed",
        "revised_at",
        "revised_by",
        "revised_reason",
        "final_score",
        "final_passed",
    ]);
    header.extend(&metrics);
    out.write_record(&header)?;
    let number = |x: Option<f64>| x.map_or(String::new(), |x| x.to_string());
    let truth = |x: Option<bool>| x.map_or(String::new(), |x| x.to_string());
    for session in sessions {
        let grade = &session.grade;
        let used = grade.rubric.as_ref();
        let latest = session.sidecar.as_ref().and_then(Sidecar::latest);
        let mut row = vec![cell(&session.file), cell(&grade.learner_id)];
        row.extend(names.map(|names| cell(names.of(&grade.learner_id).unwrap_or(""))));
        row.extend([
            cell(&grade.exercise),
            session.attempt.to_string(),
            session.shown.mode.to_string(),
            session
                .shown
                .recorded
                .map_or(String::new(), |mode| mode.to_string()),
            date(grade.started_unix_ns),
            grade.started_unix_ns.to_string(),
            used.map_or(String::new(), |used| cell(&used.name)),
            used.map_or(String::new(), |used| used.version.to_string()),
            used.map_or(String::new(), |used| used.source.words().to_owned()),
            grade
                .migrated
                .as_ref()
                .map_or(String::new(), |migrated| migrated.migration.from.to_owned()),
            cells::code(&grade.signer),
            grade.signer_trusted.to_string(),
            grade.gradable.to_string(),
            grade.reason.as_deref().map_or(String::new(), cell),
            number(grade.score),
            truth(grade.passed),
            number(grade.pass_mark),
            number(session.self_score),
            number(latest.map(|said| said.score)),
            latest.map_or(String::new(), |said| said.passed.to_string()),
            latest.map_or(String::new(), |said| cell(&said.at)),
            latest.map_or(String::new(), |said| cell(&said.by)),
            latest.map_or(String::new(), |said| cell(&said.reason)),
            number(session.counts().0),
            truth(session.counts().1),
        ]);
        row.extend(
            metrics
                .iter()
                .map(|name| number(grade.metric(name).and_then(|metric| metric.value))),
        );
        out.write_record(&row)?;
    }
    for (file, why) in unread {
        let mut row = vec![String::new(); header.len()];
        let mut put = |column: &str, what: String| {
            if let Some(at) = header.iter().position(|name| *name == column) {
                row[at] = what;
            }
        };
        put("file", cell(file));
        put("gradable", "false".into());
        put("reason", cell(why));
        out.write_record(&row)?;
    }
    let bytes = out.into_inner().map_err(|error| error.into_error())?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// Text that a spreadsheet keeps as text.
fn cell(text: &str) -> String {
    cells::text(text).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_cannot_be_read_has_a_row_with_the_reason() {
        let table = csv(&[], &[("=a,b.mcap".into(), "is no MCAP file".into())], None);
        let table = table.expect("a table");
        let mut reader = csv::Reader::from_reader(table.as_bytes());
        let header = reader.headers().expect("a header").clone();
        let row = reader.records().next().expect("a row").expect("a record");
        let of = |name: &str| &row[header.iter().position(|h| h == name).expect(name)];
        assert_eq!(of("file"), "'=a,b.mcap");
        assert_eq!((of("gradable"), of("score")), ("false", ""));
        assert_eq!(of("reason"), "is no MCAP file");
    }
}
