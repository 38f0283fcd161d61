//! Roster of a class: a table of learner ids and stations, for which tokens are made.
//!
//! The table is read as spreadsheets save it: commas, semicolons or tabs, UTF-8, UTF-16 or Windows-1252, headings in
//! any case. A second import of the same table makes no second token.

use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;

use serde::Serialize;
use sulcus_program::PathText;
use sulcus_proto::{Role, Ticket, learner};
use sulcus_sessions::export::cells;
use sulcus_sessions::grade::sheet::{self, SheetError};

use super::error::StateError;
use super::files::create_private;
use super::tokens::record::{NewToken, Place, Secret, TokenRecord};
use super::tokens::store::{TokenStore, insert};
use crate::plan::names::{EXPECTED, is_station_name};

/// Largest roster that is read, bytes.
const MOST_BYTES: u64 = 1 << 20;
/// Headings of the column of ids; the first that a table has is taken.
const ID_HEADINGS: [&str; 3] = ["learner", "learner_id", "id"];

/// Roster as read: rows with their lines in the file. The values are not checked yet.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Roster {
    rows: Vec<(u64, String, String)>,
}

/// A line of a roster, and what an import does with it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Line {
    /// Line in the file, from 1.
    pub line: u64,
    /// Learner id as found.
    pub learner: String,
    /// Name of the station as found.
    pub station: String,
    /// Effect of the line.
    #[serde(flatten)]
    pub verdict: Verdict,
}

/// Effect of a line of a roster.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(tag = "verdict", rename_all = "snake_case")]
pub enum Verdict {
    /// A token is made.
    New,
    /// The learner has a valid token for the station; nothing is made.
    Kept {
        /// Id of that token.
        id: String,
    },
    /// A token is made, and an old one is revoked: the learner moves to another station, or asked for a renewal.
    Replaces {
        /// Id of the old token.
        id: String,
    },
    /// The line is not valid. A roster with such a line is not imported at all.
    Fault {
        /// Column.
        field: &'static str,
        /// Value found.
        found: String,
        /// Value expected.
        expected: String,
    },
}

impl fmt::Display for Line {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (line, learner, station) = (self.line, &self.learner, &self.station);
        match &self.verdict {
            Verdict::New => write!(f, "line {line}: {learner} at {station}: new token"),
            Verdict::Kept { id } => {
                write!(f, "line {line}: {learner} at {station}: has token {id}")
            }
            Verdict::Replaces { id } => write!(
                f,
                "line {line}: {learner} at {station}: new token, {id} is revoked"
            ),
            Verdict::Fault {
                field,
                found,
                expected,
            } => write!(f, "line {line}: {field} is `{found}`, expected {expected}"),
        }
    }
}

/// Import of a roster.
#[derive(Clone, Copy, Debug)]
pub struct Import<'a> {
    /// Name of the class, for the records of the tokens.
    pub class: &'a str,
    /// Time from which the new tokens are no longer valid, seconds since 1970.
    pub expires_unix_s: u64,
    /// Whether learners who have a token get a new one. The old one is revoked.
    pub renew: bool,
    /// Fingerprint of the server's certificate, for the tickets.
    pub fingerprint: [u8; 32],
}

impl Roster {
    /// Roster in the file at `path`.
    ///
    /// # Errors
    /// The file cannot be read, is too long, or is no table with the columns of a roster.
    pub fn open(path: &Path) -> Result<Self, String> {
        let told = |why: String| format!("roster {}: {why}", path.shown());
        let length = std::fs::metadata(path).map_err(|error| told(error.to_string()))?;
        if length.len() > MOST_BYTES {
            let found = length.len();
            return Err(told(format!("{found} bytes long, expected at most 1 MiB")));
        }
        let bytes = std::fs::read(path).map_err(|error| told(error.to_string()))?;
        Self::parse(&bytes).map_err(told)
    }

    /// Roster in the bytes of a file.
    ///
    /// # Errors
    /// The bytes are no text, or a line does not fit the headings; the first such line.
    pub fn parse(bytes: &[u8]) -> Result<Self, String> {
        let mut first = None;
        for heading in ID_HEADINGS {
            match sheet::read(bytes, [heading, "station"]) {
                Ok(rows) => return Ok(Self::of(rows)),
                Err(error) => {
                    let is_heading =
                        matches!(&error, SheetError::Line { field, .. } if *field == "header");
                    first.get_or_insert(error.clone());
                    if !is_heading {
                        first = Some(error);
                        break;
                    }
                }
            }
        }
        Err(match first {
            Some(SheetError::Text(why)) => why,
            Some(SheetError::Line {
                line,
                field,
                found,
                expected,
            }) => format!("line {line}: {field} is {found}, expected {expected}"),
            None => "no headings".into(),
        })
    }

    fn of(rows: Vec<sheet::Row<2>>) -> Self {
        let plain = |cell: &str| {
            let cell = cells::read(cell);
            // Neither an id nor a station's name has an apostrophe of its own.
            cell.strip_prefix('\'').unwrap_or(cell).to_owned()
        };
        let row = |row: sheet::Row<2>| {
            let [learner, station] = &row.cells;
            (row.line, plain(learner), plain(station))
        };
        Self {
            rows: rows.into_iter().map(row).collect(),
        }
    }

    /// Effect of every line on `tokens` at a time in seconds since 1970, without a change.
    pub fn examine(&self, tokens: &[TokenRecord], import: &Import<'_>, now_s: u64) -> Vec<Line> {
        let mut seen: BTreeMap<&str, u64> = BTreeMap::new();
        let line = |(line, learner, station): &'_ (u64, String, String), verdict| Line {
            line: *line,
            learner: learner.clone(),
            station: station.clone(),
            verdict,
        };
        let mut lines = Vec::with_capacity(self.rows.len());
        for row in &self.rows {
            let (at, id, station) = row;
            let verdict = if let Some(fault) = fault(id, station) {
                fault
            } else if let Some(before) = seen.insert(id, *at) {
                Verdict::Fault {
                    field: "learner",
                    found: id.clone(),
                    expected: format!("each learner once, and line {before} has the same"),
                }
            } else {
                effect(id, station, tokens, import, now_s)
            };
            lines.push(line(row, verdict));
        }
        lines
    }

    /// Makes the tokens of the roster and the table of tickets at `tickets`, a new private file.
    ///
    /// The table is written before the tokens. A crash in between leaves tickets that open nothing, and the next
    /// import makes others.
    ///
    /// # Errors
    /// A line has a fault, the table exists or cannot be written, or the tokens cannot be written.
    pub fn import(
        &self,
        store: &TokenStore,
        import: &Import<'_>,
        tickets: &Path,
        now_s: u64,
    ) -> Result<Vec<Line>, StateError> {
        store.change(now_s, |tokens| {
            let lines = self.examine(tokens, import, now_s);
            let makes =
                |line: &&Line| matches!(line.verdict, Verdict::New | Verdict::Replaces { .. });
            if lines
                .iter()
                .any(|line| matches!(line.verdict, Verdict::Fault { .. }))
            {
                return Err(StateError::content(
                    "roster".as_ref(),
                    "a line is not valid",
                ));
            }
            let asked: Vec<NewToken> = lines
                .iter()
                .filter(makes)
                .map(|l| import.token(l))
                .collect();
            let secrets = asked
                .iter()
                .map(|_| Secret::new())
                .collect::<Result<Vec<_>, _>>()?;
            for line in &lines {
                if let Verdict::Replaces { id } = &line.verdict
                    && let Some(old) = tokens.iter_mut().find(|token| token.id == *id)
                {
                    old.revoked_unix_s.get_or_insert(now_s);
                }
            }
            insert(tokens, &asked, &secrets, now_s)?;
            let table = table(&asked, &secrets, import.fingerprint);
            create_private(tickets, table.as_bytes())?;
            Ok(lines)
        })
    }
}

impl Import<'_> {
    fn token(&self, line: &Line) -> NewToken {
        NewToken {
            role: Role::Student,
            station: Place::Station(line.station.clone()),
            learner: line.learner.clone(),
            class: self.class.to_owned(),
            expires_unix_s: self.expires_unix_s,
        }
    }
}

/// Table of tickets: learner, station, ticket. A spreadsheet keeps every cell as written.
fn table(asked: &[NewToken], secrets: &[Secret], fingerprint: [u8; 32]) -> String {
    let mut text = String::from("learner,station,ticket\r\n");
    for (new, secret) in asked.iter().zip(secrets) {
        let ticket = Ticket {
            token: secret.reveal().to_owned(),
            fingerprint,
        };
        // No cell needs quotation marks: ids, names and tickets have neither separators nor quotation marks.
        let (learner, station) = (cells::text(&new.learner), new.station.to_string());
        let station = cells::text(&station);
        text.push_str(&format!("{learner},{station},{ticket}\r\n"));
    }
    text
}

fn fault(id: &str, station: &str) -> Option<Verdict> {
    let wrong = |field, found: &str, expected: String| {
        Some(Verdict::Fault {
            field,
            found: found.escape_debug().to_string(),
            expected,
        })
    };
    if id.is_empty() {
        return wrong("learner", id, "an opaque id".into());
    }
    if let Err(expected) = learner::parse(id) {
        let expected = expected.strip_prefix("expected ").unwrap_or(&expected);
        return wrong("learner", id, expected.to_owned());
    }
    if !is_station_name(station) {
        return wrong("station", station, EXPECTED.to_owned());
    }
    None
}

fn effect(
    id: &str,
    station: &str,
    tokens: &[TokenRecord],
    import: &Import<'_>,
    now_s: u64,
) -> Verdict {
    let of_learner = |token: &&TokenRecord| {
        token.role == Role::Student && token.learner == id && token.is_valid(now_s)
    };
    let here = |token: &&TokenRecord| token.station.includes(station);
    let mine = || tokens.iter().filter(of_learner);
    match mine().find(here) {
        Some(token) if !import.renew => Verdict::Kept {
            id: token.id.clone(),
        },
        Some(token) => Verdict::Replaces {
            id: token.id.clone(),
        },
        // A learner of another class may have another station there.
        None => match mine().find(|token| token.class == import.class) {
            Some(token) => Verdict::Replaces {
                id: token.id.clone(),
            },
            None => Verdict::New,
        },
    }
}

#[cfg(test)]
mod tests;
