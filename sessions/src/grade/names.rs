//! The key table: which learner id is whose. It is kept apart from recordings and given only when something is printed for
//! people, so that erasing a person does not break a signed file.

use std::collections::BTreeMap;
use std::path::Path;

use sulcus_program::PathText;

/// Names by learner id. A CSV file with the columns `learner_id` and `name`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Names(BTreeMap<String, String>);

/// Why a file is no key table.
#[derive(Debug, thiserror::Error)]
pub enum NamesError {
    /// It cannot be read, or is no CSV.
    #[error("key table `{path}`: {why}")]
    Read {
        /// The file.
        path: String,
        /// Why not.
        why: String,
    },
    /// A row is not as it must be.
    #[error("key table `{path}`, line {line}: {field} is {found}, expected {expected}")]
    Field {
        /// The file.
        path: String,
        /// Line, from 1.
        line: u64,
        /// Column.
        field: &'static str,
        /// Value found.
        found: String,
        /// What it must be.
        expected: &'static str,
    },
}

impl Names {
    /// Reads a key table.
    ///
    /// # Errors
    /// Names the file, the line, the column, what was found and what is expected.
    pub fn open(path: &Path) -> Result<Self, NamesError> {
        let unread = |why: String| NamesError::Read {
            path: path.shown().to_string(),
            why,
        };
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .from_path(path)
            .map_err(|error| unread(error.to_string()))?;
        let header = reader
            .headers()
            .map_err(|error| unread(error.to_string()))?;
        let column = |field: &'static str| {
            let at = header.iter().position(|name| name == field);
            let found: Vec<&str> = header.iter().collect();
            at.ok_or_else(|| NamesError::Field {
                path: path.shown().to_string(),
                line: 1,
                field: "header",
                found: format!("`{}`", found.join(",").escape_debug()),
                expected: "the columns `learner_id` and `name`",
            })
        };
        let (id, name) = (column("learner_id")?, column("name")?);
        let mut names = BTreeMap::new();
        for record in reader.records() {
            let record = record.map_err(|error| unread(error.to_string()))?;
            let wrong = |field, found: &str, expected| NamesError::Field {
                path: path.shown().to_string(),
                line: record.position().map_or(0, csv::Position::line),
                field,
                found: format!("`{}`", found.escape_debug()),
                expected,
            };
            let (key, value) = (record.get(id).unwrap_or(""), record.get(name).unwrap_or(""));
            if key.is_empty() {
                return Err(wrong("learner_id", key, "an opaque id"));
            }
            if names.insert(key.to_owned(), value.to_owned()).is_some() {
                return Err(wrong("learner_id", key, "each id once"));
            }
        }
        Ok(Self(names))
    }

    /// The name of a learner, where the table has it.
    pub fn of(&self, learner_id: &str) -> Option<&str> {
        self.0.get(learner_id).map(String::as_str)
    }

    /// What a learner is called on a page: the name with the id, or the id alone.
    pub fn label(&self, learner_id: &str) -> String {
        let id = if learner_id.is_empty() {
            "(no id)"
        } else {
            learner_id
        };
        match self.of(learner_id) {
            Some(name) => format!("{name} ({id})"),
            None => id.to_owned(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Names, NamesError> {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("names.csv");
        std::fs::write(&path, text).expect("written");
        Names::open(&path)
    }

    #[test]
    fn a_table_gives_names_and_a_bad_one_says_where() {
        let names = read("name,learner_id\n\"Doe, A.\", a7f3\nRoe,b1\n").expect("a table");
        assert_eq!(names.of("a7f3"), Some("Doe, A."));
        assert_eq!(names.label("b1"), "Roe (b1)");
        assert_eq!(names.label("c9"), "c9");
        assert_eq!(names.label(""), "(no id)");
        for (text, words) in [
            (
                "id,name\n1,x\n",
                "line 1: header is `id,name`, expected the columns",
            ),
            (
                "learner_id,name\na,x\n,y\n",
                "line 3: learner_id is ``, expected an opaque id",
            ),
            (
                "learner_id,name\na,x\na,y\n",
                "line 3: learner_id is `a`, expected each id once",
            ),
        ] {
            let said = read(text).expect_err("no table").to_string();
            assert!(said.contains(words), "{said}");
        }
        assert!(Names::open(Path::new("no/such.csv")).is_err());
    }
}
