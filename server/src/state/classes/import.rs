//! Rosters: tables of persons and classes, with a verdict for each line. A second import of a roster changes nothing.
//!
//! | column | content |
//! |---|---|
//! | `learner` (or `learner_id`, or `id` in a table without the next three) | opaque id; a missing one is made |
//! | `sourcedId` | id of the person in the school's own system |
//! | `username` | name for signing in to the school's own system |
//! | `givenName`, `familyName` | name, for the key table alone |
//! | `class` | name of the class; without it the class of the import |
//!
//! A column `learner`, `sourcedId` or `username` is needed. Other columns, such as `email`, are not read. The table may
//! be in any form of [`sheet`].

mod report;

use std::collections::BTreeMap;

use sulcus_proto::hex::hex;
use sulcus_sessions::export::cells;
use sulcus_sessions::grade::sheet::{self, SheetError};

use super::change::{class_name, make};
use super::names::{Person, check};
use super::record::{Learner, MOST_LEARNERS};
use super::{Book, ClassError, Classes, told};
use crate::state::error::StateError;
use crate::state::files::Lock;

pub use report::{Line, Report, Row, Verdict};

/// Largest roster that is read, bytes.
pub const MOST_BYTES: usize = 1 << 20;
/// Headings that are read.
const HEADINGS: [&str; 8] = [
    "learner",
    "learnerId",
    "id",
    "sourcedId",
    "username",
    "givenName",
    "familyName",
    "class",
];
/// Characters of a made id: none looks like another.
const ALPHABET: &[u8; 31] = b"23456789abcdefghjkmnpqrstuvwxyz";

/// Rows of a roster's bytes.
///
/// # Errors
/// The bytes are no text, or a line does not fit the headings; the first such line.
pub fn parse(bytes: &[u8]) -> Result<Vec<Row>, String> {
    if bytes.len() > MOST_BYTES {
        let found = bytes.len();
        return Err(format!(
            "the roster has {found} bytes, expected at most 1 MiB"
        ));
    }
    let fits = |columns: &[Option<usize>; 8]| columns[..5].iter().any(Option::is_some);
    let expected = "`learner`, `sourcedId` or `username` among the columns, each column once";
    let (rows, found) =
        sheet::read_some(bytes, HEADINGS, fits, expected).map_err(|error| match error {
            SheetError::Text(why) => why,
            SheetError::Line {
                line,
                field,
                found,
                expected,
            } => format!("line {line}: {field} is {found}, expected {expected}"),
        })?;
    // A school's own table has an `id` of another kind.
    let has_school = found[3] || found[4] || found[0] || found[1];
    let row = |row: sheet::Row<8>| {
        let [
            learner,
            learner_id,
            id,
            sourced_id,
            username,
            given,
            family,
            class,
        ] = row.cells.map(|cell| cells::read(&cell).trim().to_owned());
        let ids = [
            learner,
            learner_id,
            if has_school { String::new() } else { id },
        ];
        let learner = ids.into_iter().find(|id| !id.is_empty());
        let learner = learner.unwrap_or_default();
        Row {
            line: row.line,
            // No id has an apostrophe of its own.
            learner: learner.strip_prefix('\'').unwrap_or(&learner).to_owned(),
            sourced_id,
            username,
            given,
            family,
            class,
        }
    };
    Ok(rows.into_iter().map(row).collect())
}

impl Classes {
    /// Effect of a roster, without a change. `class` is the name of the class for lines without one; may be empty.
    ///
    /// # Errors
    /// The roster is no table, the key table is not here, or a file cannot be read.
    pub fn examine(&self, bytes: &[u8], class: &str, now_s: u64) -> Result<Report, ClassError> {
        let rows = parse(bytes).map_err(ClassError::Invalid)?;
        let _lock = Lock::wait(&self.folder.file(super::LOCK))?;
        let mut book = self.load()?;
        report(&mut book, bytes, &rows, class, now_s)
    }

    /// Imports a roster. With the hash of a dry run, exactly that report is carried out.
    ///
    /// # Errors
    /// The roster is no table, the key table is not here, a file cannot be written, or the classes have changed since
    /// the dry run.
    pub fn import(
        &self,
        bytes: &[u8],
        class: &str,
        hash: Option<&str>,
        now_s: u64,
    ) -> Result<Report, ClassError> {
        let rows = parse(bytes).map_err(ClassError::Invalid)?;
        self.change(|book| {
            let report = report(book, bytes, &rows, class, now_s)?;
            if hash.is_some_and(|hash| hash != report.hash) {
                let why = "the classes or the roster have changed since this report was made";
                return Err(ClassError::Changed(why.into()));
            }
            let object = format!(
                "{} new, {} kept, {} renamed, {} moved, {} refused",
                report.count("new"),
                report.count("kept"),
                report.count("renamed"),
                report.count("moved"),
                report.count("refused")
            );
            Ok((report, vec![("import roster", object)]))
        })
    }
}

fn report(
    book: &mut Book,
    bytes: &[u8],
    rows: &[Row],
    class: &str,
    now_s: u64,
) -> Result<Report, ClassError> {
    let before = book.roll.classes.len();
    let lines = apply(book, rows, class, &mut draw, now_s)?;
    let mut hash = blake3::Hasher::new();
    hash.update(bytes);
    hash.update(class.trim().as_bytes());
    for line in &lines {
        // The id of a new learner is made at the import.
        let id = match line.verdict {
            Verdict::New => "",
            _ => &line.learner,
        };
        hash.update(format!("\n{} {id} {} {:?}", line.line, line.class, line.verdict).as_bytes());
    }
    let new = book.roll.classes.get(before..).unwrap_or_default();
    let named: Vec<&str> = lines.iter().map(|line| line.learner.as_str()).collect();
    let touched: Vec<&str> = lines
        .iter()
        .filter_map(|line| book.roll.learner(&line.learner))
        .map(|learner| learner.class.as_str())
        .collect();
    let absent = book.roll.learners.iter().filter(|learner| {
        touched.contains(&learner.class.as_str()) && !named.contains(&learner.id.as_str())
    });
    Ok(Report {
        new_classes: new.iter().map(|class| class.name.clone()).collect(),
        absent: absent.count(),
        hash: hex(hash.finalize().as_bytes()),
        lines,
    })
}

/// Carries out the lines of a roster on a book. `class` is the name of the class for rows without one.
///
/// # Errors
/// The key table is not here although persons had names, or the system has no random numbers.
pub(super) fn apply(
    book: &mut Book,
    rows: &[Row],
    class: &str,
    draw: &mut dyn FnMut() -> Result<String, StateError>,
    now_s: u64,
) -> Result<Vec<Line>, ClassError> {
    let is_named = |row: &Row| {
        let parts = [&row.sourced_id, &row.username, &row.given, &row.family];
        parts.iter().any(|part| !part.is_empty())
    };
    if book.roll.has_names && !book.names.is_open && rows.iter().any(is_named) {
        return Err(closed());
    }
    // A username that a line of the roster still has cannot be given up by another line: the order of lines would
    // count.
    let named = rows.iter().filter(|row| !row.username.is_empty());
    let usernames: BTreeMap<String, u64> = named
        .map(|row| (row.username.to_lowercase(), row.line))
        .collect();
    let mut seen: BTreeMap<String, u64> = BTreeMap::new();
    let mut lines = Vec::with_capacity(rows.len());
    for row in rows {
        let class = match row.class.trim() {
            "" => class.trim(),
            own => own,
        };
        let mut line = Line {
            line: row.line,
            learner: String::new(),
            name: person(row).name(),
            class: class.to_owned(),
            verdict: Verdict::Kept,
        };
        let carried = match whose(book, row, class) {
            Ok(Some(id)) if seen.contains_key(&id) => {
                let first = seen.get(&id).copied().unwrap_or_default();
                Err(format!(
                    "each person once is expected, and line {first} has the same"
                ))
            }
            Ok(id) => match given_up(book, row, id.as_deref(), &usernames) {
                Some(why) => Err(why),
                None => carry_out(book, row, class, id, draw, now_s)?,
            },
            Err(why) => Err(why),
        };
        match carried {
            Ok((id, verdict)) => {
                seen.insert(id.clone(), row.line);
                (line.learner, line.verdict) = (id, verdict);
            }
            Err(why) => line.verdict = Verdict::Refused { why },
        }
        lines.push(line);
    }
    Ok(lines)
}

/// Learner of a row; `None`: a new one. The error is the reason of a refusal.
fn whose(book: &Book, row: &Row, class: &str) -> Result<Option<String>, String> {
    let wrong = |field: &str, found: &str, expected: &str| {
        Err(format!("{field} is `{}`, expected {expected}", told(found)))
    };
    if class.is_empty() {
        return wrong("class", class, "the name of a class");
    }
    class_name(class).map_err(|error| error.to_string())?;
    let parts = [
        ("sourcedId", &row.sourced_id),
        ("username", &row.username),
        ("givenName", &row.given),
        ("familyName", &row.family),
    ];
    for (field, text) in parts {
        if let Err(expected) = check(text) {
            return wrong(field, text, &expected);
        }
    }
    let people = &book.names.people;
    let mut found: Vec<(&str, &str)> = Vec::new();
    if !row.learner.is_empty() {
        if let Err(expected) = learner_id(&row.learner) {
            return Err(format!("learner is `{}`: {expected}", told(&row.learner)));
        }
        found.push(("learner", &row.learner));
    }
    if !row.sourced_id.is_empty() {
        let own = people.iter().find(|one| one.sourced_id == row.sourced_id);
        found.extend(own.map(|one| ("sourcedId", one.learner.as_str())));
    }
    if !row.username.is_empty() {
        let username = row.username.to_lowercase();
        let own = people
            .iter()
            .find(|one| one.username.to_lowercase() == username);
        found.extend(own.map(|one| ("username", one.learner.as_str())));
    }
    if row.learner.is_empty() && row.sourced_id.is_empty() && row.username.is_empty() {
        return Err("learner, sourcedId and username are empty, expected one of them".into());
    }
    let Some((first, id)) = found.first().copied() else {
        return Ok(None);
    };
    if let Some((field, other)) = found.iter().find(|(_, other)| *other != id) {
        return Err(format!(
            "{first} and {field} belong to different learners, {id} and {other}"
        ));
    }
    let before = book
        .names
        .of(id)
        .map_or("", |person| person.sourced_id.as_str());
    if !before.is_empty() && !row.sourced_id.is_empty() && before != row.sourced_id {
        let expected = format!("`{}`, which {id} has", told(before));
        return wrong("sourcedId", &row.sourced_id, &expected);
    }
    Ok(Some(id.to_owned()))
}

/// Reason why the person of a row cannot give up the username of before; `None`: the username stays, or is free.
fn given_up(
    book: &Book,
    row: &Row,
    id: Option<&str>,
    usernames: &BTreeMap<String, u64>,
) -> Option<String> {
    let before = &book.names.of(id?)?.username;
    if row.username.is_empty() || row.username.to_lowercase() == before.to_lowercase() {
        return None;
    }
    let line = usernames.get(&before.to_lowercase())?;
    let (found, before) = (told(&row.username), told(before));
    Some(format!(
        "username is `{found}`, expected `{before}` of before, which line {line} still has"
    ))
}

type Carried = Result<(String, Verdict), String>;

/// Carries out a row whose values are valid. The inner error is the reason of a refusal.
fn carry_out(
    book: &mut Book,
    row: &Row,
    class: &str,
    id: Option<String>,
    draw: &mut dyn FnMut() -> Result<String, StateError>,
    now_s: u64,
) -> Result<Carried, ClassError> {
    let is_known = |id: &str| {
        let is_here = book.roll.learner(id).is_some() || book.names.of(id).is_some();
        is_here || book.roll.was_learner(id)
    };
    let here = id.as_deref().and_then(|id| book.roll.learner(id)).is_some();
    if !here && book.roll.learners.len() >= MOST_LEARNERS {
        return Ok(Err(format!(
            "{MOST_LEARNERS} learners exist, expected at most {MOST_LEARNERS}"
        )));
    }
    let is_new = !id.as_deref().is_some_and(is_known);
    let id = match id {
        Some(id) => id,
        None => loop {
            let id = draw()?;
            if !is_known(&id) {
                break id;
            }
        },
    };
    let class_id = match book.roll.class_named(class) {
        Some(class) => class.id.clone(),
        None => match make(book, class, now_s) {
            Ok(id) => id,
            Err(error) => return Ok(Err(error.to_string())),
        },
    };
    let renamed = rename(book, &id, row);
    let from = match book.roll.learners.iter_mut().find(|one| one.id == id) {
        Some(learner) if learner.class == class_id => None,
        Some(learner) => {
            let from = std::mem::replace(&mut learner.class, class_id);
            // Task and code were those of the former class.
            (learner.task, learner.code) = (None, None);
            Some(
                book.roll
                    .class(&from)
                    .map_or(from.clone(), |class| class.name.clone()),
            )
        }
        None => {
            book.roll.learners.push(Learner {
                id: id.clone(),
                class: class_id,
                task: None,
                code: None,
            });
            Some(String::new())
        }
    };
    if from.is_some() {
        book.roll.end_exams(&id, now_s);
    }
    let verdict = match (from, renamed) {
        _ if is_new => Verdict::New,
        (Some(from), _) => Verdict::Moved { from },
        (None, Some(before)) => Verdict::Renamed { before },
        (None, None) => Verdict::Kept,
    };
    Ok(Ok((id, verdict)))
}

fn person(row: &Row) -> Person {
    Person {
        learner: row.learner.clone(),
        given: row.given.clone(),
        family: row.family.clone(),
        sourced_id: row.sourced_id.clone(),
        username: row.username.clone(),
    }
}

/// Takes the names of a row into the key table; empty values leave those of before. Returns the name of before, if the
/// name or the username has changed.
fn rename(book: &mut Book, id: &str, row: &Row) -> Option<String> {
    let given = [&row.given, &row.family, &row.sourced_id, &row.username];
    if given.iter().all(|text| text.is_empty()) {
        return None;
    }
    book.roll.has_names = true;
    let people = &mut book.names.people;
    let at = match people.iter().position(|person| person.learner == id) {
        Some(at) => at,
        None => {
            people.push(Person {
                learner: id.to_owned(),
                ..Person::default()
            });
            people.len() - 1
        }
    };
    let before = people[at].clone();
    let person = &mut people[at];
    let parts = [
        (&mut person.given, &row.given),
        (&mut person.family, &row.family),
        (&mut person.sourced_id, &row.sourced_id),
        (&mut person.username, &row.username),
    ];
    for (own, new) in parts {
        if !new.is_empty() {
            own.clone_from(new);
        }
    }
    let is_other = before.given != person.given
        || before.family != person.family
        || before.username != person.username;
    is_other.then(|| before.name())
}

/// Checks the id of a learner.
///
/// # Errors
/// The expected form.
pub(super) fn learner_id(id: &str) -> Result<(), String> {
    if id.is_empty() {
        return Err("expected an opaque id".into());
    }
    if sulcus_proto::learner::code_of(id).is_some() {
        return Err("expected an opaque id; this form is that of a code".into());
    }
    sulcus_proto::learner::parse(id).map(|_| ())
}

/// A random id, such as `s-4f7k2`.
///
/// # Errors
/// The system has no random numbers.
pub(super) fn draw() -> Result<String, StateError> {
    loop {
        let mut bytes = [0; 5];
        super::super::error::random(&mut bytes)?;
        // Five bits each; 31 is drawn again.
        let letters = bytes.map(|byte| ALPHABET.get(usize::from(byte & 31)).copied());
        let id: Option<String> = letters.into_iter().map(|c| c.map(char::from)).collect();
        match id {
            Some(id) if id.contains(|c: char| c.is_ascii_digit()) => return Ok(format!("s-{id}")),
            _ => {}
        }
    }
}

pub(super) fn closed() -> ClassError {
    ClassError::Invalid(format!(
        "the key table {} is not in the state folder; put it back first, or the persons would get new ids",
        super::names::FILE
    ))
}
