//! Key table: learner ids and names, in a file of its own.
//!
//! Recordings and the list of classes have opaque ids alone. An administrator may keep the file elsewhere and bring it
//! for a lesson: without it the console shows ids. The file is erased for a person without a change of any recording.

use serde::{Deserialize, Serialize};

use super::record::MOST_LEARNERS;
use crate::state::error::StateError;
use crate::state::files::{Staged, read_private};
use crate::state::folder::StateFolder;

/// File of the key table.
pub const FILE: &str = "names.json";
/// Version of the file's layout.
const VERSION: u32 = 1;
/// Largest file that is read, bytes.
const MOST_BYTES: u64 = 8 << 20;
/// Longest part of a name, characters.
pub const LONGEST: usize = 64;

/// A person of the key table.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Person {
    /// Opaque id of the learner.
    pub learner: String,
    /// Given name; may be empty.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub given: String,
    /// Family name; may be empty.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub family: String,
    /// Id of the person in the school's own system; may be empty.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub sourced_id: String,
    /// Name for signing in to the school's own system; may be empty.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub username: String,
}

impl Person {
    /// Name for people: given and family name, else the username, else the id of the school.
    pub fn name(&self) -> String {
        let name = format!("{} {}", self.given, self.family);
        let name = name.trim();
        let all = [name, &self.username, &self.sourced_id];
        let first = all.iter().find(|text| !text.is_empty());
        first.map_or(String::new(), |text| (*text).to_owned())
    }
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Stored {
    version: u32,
    people: Vec<Person>,
}

/// The key table.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Names {
    /// Whether the file is here.
    pub is_open: bool,
    /// Persons, in the order of their making.
    pub people: Vec<Person>,
}

impl Names {
    /// Key table of a folder. Without the file the table is empty and closed.
    ///
    /// # Errors
    /// The file cannot be read, can be read by other users, or is not valid.
    pub fn load(folder: &StateFolder) -> Result<Self, StateError> {
        let path = folder.file(FILE);
        let Some(bytes) = read_private(&path, MOST_BYTES)? else {
            return Ok(Self::default());
        };
        let people = parse(&bytes).map_err(|why| StateError::content(&path, why))?;
        Ok(Self {
            is_open: true,
            people,
        })
    }

    /// Writes the table beside the present one: see [`Staged::commit`].
    ///
    /// # Errors
    /// The file cannot be written.
    pub(super) fn stage(&self, folder: &StateFolder) -> Result<Staged, StateError> {
        let path = folder.file(FILE);
        let stored = Stored {
            version: VERSION,
            people: self.people.clone(),
        };
        let bytes = serde_json::to_vec_pretty(&stored);
        let mut bytes = bytes.map_err(|error| StateError::content(&path, error.to_string()))?;
        bytes.push(b'\n');
        Staged::write(&path, &bytes)
    }

    /// Person with a learner id.
    pub fn of(&self, learner: &str) -> Option<&Person> {
        self.people.iter().find(|person| person.learner == learner)
    }

    /// Name of a learner for people; `None`: the table is closed, or has no name.
    pub fn name_of(&self, learner: &str) -> Option<String> {
        let name = self.of(learner)?.name();
        (!name.is_empty()).then_some(name)
    }
}

/// Checks a part of a name.
///
/// # Errors
/// The expected form.
pub(super) fn check(text: &str) -> Result<(), String> {
    if text.chars().count() > LONGEST || text.contains(char::is_control) {
        return Err(format!(
            "at most {LONGEST} characters without line feeds and other control characters"
        ));
    }
    Ok(())
}

fn parse(bytes: &[u8]) -> Result<Vec<Person>, String> {
    let stored: Stored = serde_json::from_slice(bytes).map_err(|error| error.to_string())?;
    if stored.version != VERSION {
        let found = stored.version;
        return Err(format!(
            "version is {found}, expected {VERSION}; install the program that wrote the file"
        ));
    }
    let found = stored.people.len();
    if found > 4 * MOST_LEARNERS {
        let most = 4 * MOST_LEARNERS;
        return Err(format!("{found} persons, expected at most {most}"));
    }
    for person in &stored.people {
        let id = &person.learner;
        if id.is_empty() || !sulcus_proto::learner::is_opaque(id) {
            let found = id.escape_debug();
            return Err(format!("learner is `{found}`, expected an opaque id"));
        }
        let parts = [
            ("given", &person.given),
            ("family", &person.family),
            ("sourced_id", &person.sourced_id),
            ("username", &person.username),
        ];
        for (field, text) in parts {
            check(text)
                .map_err(|expected| format!("{field} of learner {id}: expected {expected}"))?;
        }
    }
    Ok(stored.people)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::state::folder::fresh;

    #[test]
    fn a_table_is_read_as_written_and_its_absence_is_no_error() {
        let (_place, folder) = fresh();
        let closed = Names::load(&folder).expect("no file");
        assert!(!closed.is_open && closed.name_of("s-1").is_none());
        let person = Person {
            learner: "s-1".into(),
            given: "Zoë".into(),
            family: "O'Neill".into(),
            ..Person::default()
        };
        let names = Names {
            is_open: true,
            people: vec![person],
        };
        names
            .stage(&folder)
            .and_then(Staged::commit)
            .expect("writes");
        assert_eq!(Names::load(&folder).expect("reads"), names);
        assert_eq!(names.name_of("s-1").as_deref(), Some("Zoë O'Neill"));
    }

    #[test]
    fn a_wrong_table_is_refused_with_the_field() {
        for (text, named) in [
            (r#"{"version":2,"people":[]}"#, "version is 2, expected 1"),
            (r#"{"version":1,"people":[{"learner":"jane"}]}"#, "`jane`"),
            (
                r#"{"version":1,"people":[{"learner":"s-1","given":"a\nb"}]}"#,
                "given of learner s-1",
            ),
            (
                r#"{"version":1,"people":[{"learner":"s-1","email":"x"}]}"#,
                "email",
            ),
        ] {
            let told = parse(text.as_bytes()).expect_err(text);
            assert!(told.contains(named), "{told}");
        }
    }

    proptest! {
        #[test]
        fn no_content_panics(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
            let _ = parse(&bytes);
        }
    }
}
