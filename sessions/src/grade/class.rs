//! A class in one table: a row for each session, and what its pages and its CSV are made of.

use super::names::Names;
use super::report::Grade;
use super::revision::Sidecar;
use crate::export::cells;
use crate::pages::date;
use crate::record::mode::Mode;

/// As what a session is shown, and as what it was recorded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Shown {
    /// As what it is shown.
    pub mode: Mode,
    /// As what it was recorded; none where the recording does not say.
    pub recorded: Option<Mode>,
}

impl Shown {
    /// For people.
    pub fn words(self) -> String {
        match self.recorded {
            Some(recorded) if recorded != self.mode => {
                format!("{recorded}, shown as {}", self.mode)
            }
            _ => self.mode.to_string(),
        }
    }
}

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
    /// As what it is shown.
    pub shown: Shown,
    /// Which attempt of this learner at this exercise it is, from 1.
    pub attempt: usize,
}

impl Session {
    /// Whether nothing is shown of it that tells what the depths are, nor what to practise.
    pub fn is_exam(&self) -> bool {
        self.shown.mode == Mode::Exam
    }

    /// Whether both are of one learner at one exercise, and both exams or neither. Who has no id is nobody's other attempt.
    pub fn is_of_the_same(&self, other: &Self) -> bool {
        let (a, b) = (&self.grade, &other.grade);
        !a.learner_id.is_empty()
            && a.learner_id == b.learner_id
            && a.exercise == b.exercise
            && self.is_exam() == other.is_exam()
    }

    /// How much it says, to compare copies: whether there is a grade, how much an instructor said, whether the learner did.
    pub fn says(&self) -> (bool, usize, bool) {
        let said = self.sidecar.as_ref();
        let revisions = said.map_or(0, |sidecar| sidecar.revisions.len());
        (
            self.grade.score.is_some(),
            revisions,
            self.self_score.is_some(),
        )
    }

    /// What counts in the end, and whether it is passed: an instructor's last word, else the proposal.
    pub fn counts(&self) -> (Option<f64>, Option<bool>) {
        let latest = self.sidecar.as_ref().and_then(Sidecar::latest);
        match latest {
            Some(said) => (Some(said.score), Some(said.passed)),
            None => (self.grade.score, self.grade.passed),
        }
    }

    /// Whether both are the same session: the same recording, or a copy of it.
    pub fn is(&self, other: &Self) -> bool {
        let (a, b) = (&self.grade, &other.grade);
        (a.started_unix_ns, a.seed) == (b.started_unix_ns, b.seed)
            && (&a.exercise, &a.learner_id) == (&b.exercise, &b.learner_id)
            && (&a.station, &a.signer) == (&b.station, &b.signer)
    }
}

/// Numbers the attempts: sessions of one learner at one exercise, exams apart, by when they began.
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

/// A table for spreadsheets: learner, attempt, score, every metric's value, and what an instructor said; then a row for each file
/// that could not be read, with the reason. Names only where a key table is given.
/// Text that a spreadsheet would misread begins with an apostrophe, a signer always.
///
/// # Errors
/// When a row cannot be written.
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

/// Text that a spreadsheet takes for text.
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
