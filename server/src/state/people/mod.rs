//! Persons with a password, for the instructor's console.
//!
//! A person is a login name for a token: role, stations, end and revocation are those of the token, and recordings have
//! the token's id. The state folder keeps the argon2id hash of the password. A password costs some 50 ms of CPU time to
//! check, so that a stolen file is slow to guess from.

mod password;

use serde::{Deserialize, Serialize};

pub use password::Password;

use crate::state::error::StateError;
use crate::state::files::{Lock, read_private, write_private};
use crate::state::folder::StateFolder;

/// File of the persons.
const FILE: &str = "people.json";
/// Version of the file's layout.
const VERSION: u32 = 1;
/// Largest number of persons.
pub const MOST_PEOPLE: usize = 512;
/// Largest file that is read, bytes.
const MOST_BYTES: u64 = 1 << 20;
/// Longest login name, characters.
const LONGEST_LOGIN: usize = 32;
/// Form of a login name.
pub const LOGIN: &str = "1 to 32 small letters, digits, `.`, `-` or `_`, a letter first";

/// Layout of the file.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Stored {
    version: u32,
    people: Vec<PersonRecord>,
}

/// A stored person.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PersonRecord {
    /// Login name. It appears in no recording.
    pub login: String,
    /// Id of the person's token.
    pub token: String,
    /// Hash of the password.
    pub(crate) password: password::Hash,
    /// Time of the last change of the password, seconds since 1970.
    pub changed_unix_s: u64,
}

/// Persons of a state folder.
#[derive(Clone, Debug)]
pub struct People {
    folder: StateFolder,
}

/// Whether a text is a login name.
pub fn is_login(text: &str) -> bool {
    let known =
        |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || matches!(c, '.' | '-' | '_');
    text.len() <= LONGEST_LOGIN
        && text.starts_with(|c: char| c.is_ascii_lowercase())
        && text.chars().all(known)
}

impl People {
    /// Persons of `folder`. The file is made with the first person.
    pub fn of(folder: &StateFolder) -> Self {
        Self {
            folder: folder.clone(),
        }
    }

    /// All persons, in the order of their making.
    ///
    /// # Errors
    /// The file cannot be read, can be read by other users, or is not valid.
    pub fn list(&self) -> Result<Vec<PersonRecord>, StateError> {
        let path = self.folder.file(FILE);
        match read_private(&path, MOST_BYTES)? {
            Some(bytes) => parse(&bytes).map_err(|why| StateError::content(&path, why)),
            None => Ok(Vec::new()),
        }
    }

    /// Adds a person with a token.
    ///
    /// # Errors
    /// The login name is taken or not valid, or the file cannot be written.
    pub fn add(
        &self,
        login: &str,
        token: &str,
        password: &Password,
        now_s: u64,
    ) -> Result<(), StateError> {
        self.check_new(login)?;
        let hash = password.hash()?;
        self.change(|people| {
            if people.iter().any(|person| person.login == login) {
                return Err(self.content(format!("the login name `{login}` is taken")));
            }
            people.push(PersonRecord {
                login: login.to_owned(),
                token: token.to_owned(),
                password: hash,
                changed_unix_s: now_s,
            });
            Ok(())
        })
    }

    /// Checks that a login name is valid and free.
    ///
    /// # Errors
    /// The name is taken or not valid, or the file cannot be read.
    pub fn check_new(&self, login: &str) -> Result<(), StateError> {
        if !is_login(login) {
            let found: String = login.escape_debug().take(2 * LONGEST_LOGIN).collect();
            return Err(self.content(format!("login is `{found}`, expected {LOGIN}")));
        }
        if self.list()?.iter().any(|person| person.login == login) {
            return Err(self.content(format!("the login name `{login}` is taken")));
        }
        Ok(())
    }

    /// Changes the password of a person.
    ///
    /// # Errors
    /// No person has the name, or the file cannot be written.
    pub fn set_password(
        &self,
        login: &str,
        password: &Password,
        now_s: u64,
    ) -> Result<(), StateError> {
        let hash = password.hash()?;
        self.change(|people| {
            let found = people.iter_mut().find(|person| person.login == login);
            let person = found.ok_or_else(|| self.unknown(login))?;
            (person.password, person.changed_unix_s) = (hash.clone(), now_s);
            Ok(())
        })
    }

    /// Removes a person. Returns the id of the token, which stays valid until it is revoked.
    ///
    /// # Errors
    /// No person has the name, or the file cannot be written.
    pub fn remove(&self, login: &str) -> Result<String, StateError> {
        self.change(|people| {
            let found = people.iter().position(|person| person.login == login);
            let at = found.ok_or_else(|| self.unknown(login))?;
            Ok(people.remove(at).token)
        })
    }

    /// Id of the token of the person with this name and password; `None`: no such person, or another password. The
    /// time of the answer is the same for both. Takes some 50 ms of CPU time: never on a thread that others wait for.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn find(&self, login: &str, password: &str) -> Result<Option<String>, StateError> {
        let people = self.list()?;
        let person = people.iter().find(|person| person.login == login);
        let is_right = match person {
            Some(person) => person.password.is_of(password),
            None => password::Hash::of_nobody().is_of(password),
        };
        Ok(person
            .filter(|_| is_right)
            .map(|person| person.token.clone()))
    }

    /// Login name of the person with a token.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn login_of(&self, token: &str) -> Result<Option<String>, StateError> {
        let people = self.list()?;
        let found = people.into_iter().find(|person| person.token == token);
        Ok(found.map(|person| person.login))
    }

    fn change<R>(
        &self,
        change: impl FnOnce(&mut Vec<PersonRecord>) -> Result<R, StateError>,
    ) -> Result<R, StateError> {
        let path = self.folder.file(FILE);
        let _lock = Lock::wait(&self.folder.file("people.lock"))?;
        let mut people = self.list()?;
        let result = change(&mut people)?;
        if people.len() > MOST_PEOPLE {
            let found = people.len();
            return Err(self.content(format!("{found} persons, expected at most {MOST_PEOPLE}")));
        }
        let stored = Stored {
            version: VERSION,
            people,
        };
        let mut bytes =
            serde_json::to_vec_pretty(&stored).map_err(|error| self.content(error.to_string()))?;
        bytes.push(b'\n');
        write_private(&path, &bytes)?;
        Ok(result)
    }

    fn unknown(&self, login: &str) -> StateError {
        let login: String = login.escape_debug().take(2 * LONGEST_LOGIN).collect();
        self.content(format!(
            "no person has the login name `{login}`; `sulcus-server person list` prints the names"
        ))
    }

    fn content(&self, why: String) -> StateError {
        StateError::content(&self.folder.file(FILE), why)
    }
}

/// Persons of a file's content.
///
/// # Errors
/// The fault and the value expected. The message quotes no hash.
fn parse(bytes: &[u8]) -> Result<Vec<PersonRecord>, String> {
    let stored: Stored = serde_json::from_slice(bytes).map_err(|error| {
        format!("not a list of persons: {error}; restore the file from a backup")
    })?;
    if stored.version != VERSION {
        return Err(format!(
            "version is {}, expected {VERSION}; install the program that wrote the file",
            stored.version
        ));
    }
    Ok(stored.people)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn people() -> (tempfile::TempDir, People) {
        let place = tempfile::tempdir().expect("a folder");
        let folder = StateFolder::open(Some(&place.path().join("state"))).expect("a state folder");
        (place, People::of(&folder))
    }

    fn password(text: &str) -> Password {
        Password::new(text).expect("long enough")
    }

    #[test]
    fn a_person_is_found_by_name_and_password_until_either_changes() {
        let (place, people) = people();
        people
            .add("mueller", "t-1", &password("correct horse"), 7)
            .expect("added");
        let find = |login: &str, text: &str| people.find(login, text).expect("read");
        assert_eq!(find("mueller", "correct horse"), Some("t-1".into()));
        for (login, text) in [
            ("mueller", "correct hors"),
            ("mueller", ""),
            ("", "correct horse"),
            ("meier", "correct horse"),
        ] {
            assert_eq!(find(login, text), None, "{login} {text}");
        }
        people
            .set_password("mueller", &password("battery staple"), 8)
            .expect("set");
        assert_eq!(find("mueller", "correct horse"), None);
        assert_eq!(find("mueller", "battery staple"), Some("t-1".into()));
        assert_eq!(
            people.login_of("t-1").expect("read"),
            Some("mueller".into())
        );
        let file = std::fs::read_to_string(place.path().join("state").join(FILE)).expect("a file");
        assert!(
            !file.contains("battery") && file.contains("$argon2id$"),
            "{file}"
        );
        assert_eq!(people.remove("mueller").expect("removed"), "t-1");
        assert_eq!(find("mueller", "battery staple"), None);
        assert!(people.remove("mueller").is_err());
    }

    #[test]
    fn a_name_is_valid_and_taken_once() {
        let (_place, people) = people();
        people
            .add("a.b-c_1", "t-1", &password("0123456789"), 7)
            .expect("added");
        for (login, named) in [
            ("a.b-c_1", "taken"),
            ("A", "login is `A`"),
            ("", "login is ``"),
            ("1a", "login is"),
            ("a b", "login is"),
            ("\u{1b}", "login is `\\u{1b}`"),
        ] {
            let told = people
                .add(login, "t-2", &password("0123456789"), 7)
                .expect_err(login)
                .to_string();
            assert!(told.contains(named), "{told}");
        }
        assert_eq!(people.list().expect("read").len(), 1);
    }

    #[test]
    fn no_hash_is_shown_by_debug() {
        let (_place, people) = people();
        people
            .add("a", "t-1", &password("0123456789"), 7)
            .expect("added");
        let shown = format!("{:?}", people.list().expect("read"));
        assert!(!shown.contains("argon2"), "{shown}");
    }

    proptest! {
        #[test]
        fn no_content_panics(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
            let _ = parse(&bytes);
            let json = format!(
                r#"{{"version":1,"people":[{{"login":"a","token":"t","changed_unix_s":1,"password":{}}}]}}"#,
                serde_json::Value::from(String::from_utf8_lossy(&bytes)),
            );
            if let Ok(people) = parse(json.as_bytes()) {
                prop_assert!(!people[0].password.is_of("password"));
            }
        }
    }
}
