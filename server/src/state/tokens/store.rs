//! File of the tokens: added, listed and revoked by commands, under a lock.

use std::time::Duration;

use serde::{Deserialize, Serialize};
use sulcus_proto::hex::hex;

use super::record::{NewToken, Secret, TokenRecord};
use crate::state::date::DAY_S;
use crate::state::error::{StateError, random};
use crate::state::files::{Lock, read_private, write_private};
use crate::state::folder::StateFolder;

/// File of the tokens.
pub(super) const FILE: &str = "tokens.json";
/// Version of the file's layout.
const VERSION: u32 = 1;
/// Largest number of tokens. A lookup compares with every token: 4096 take about 0.1 ms.
pub const MOST_TOKENS: usize = 4096;
/// Largest file that is read, bytes: the largest number of the longest records.
const MOST_BYTES: u64 = 4 << 20;
/// Time after its end for which a token is still listed, seconds. Chosen: more than a school year, for disputes.
const KEPT_S: u64 = 400 * DAY_S;

/// Layout of the file.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Stored {
    version: u32,
    tokens: Vec<TokenRecord>,
}

/// Tokens of a state folder.
#[derive(Clone, Debug)]
pub struct TokenStore {
    folder: StateFolder,
    /// Longest wait for the lock of the file.
    lock_wait: Duration,
}

impl TokenStore {
    /// Tokens of `folder`. The file is made with the first token.
    pub fn of(folder: &StateFolder) -> Self {
        Self {
            folder: folder.clone(),
            lock_wait: Lock::LONGEST,
        }
    }

    /// All tokens, oldest first.
    ///
    /// # Errors
    /// The file cannot be read, can be read by other users, or is not valid.
    pub fn list(&self) -> Result<Vec<TokenRecord>, StateError> {
        let path = self.folder.file(FILE);
        match read_private(&path, MOST_BYTES)? {
            Some(bytes) => parse(&bytes).map_err(|why| StateError::content(&path, why)),
            None => Ok(Vec::new()),
        }
    }

    /// Makes tokens, all or none, in the order asked for. The secrets are returned once and never stored.
    ///
    /// # Errors
    /// A value is not valid, the file cannot be written, or it would hold more than [`MOST_TOKENS`].
    pub fn add(
        &self,
        asked: &[NewToken],
        now_s: u64,
    ) -> Result<Vec<(TokenRecord, Secret)>, StateError> {
        let secrets = asked
            .iter()
            .map(|_| Secret::new())
            .collect::<Result<Vec<_>, _>>()?;
        self.change(now_s, |tokens| {
            let made = insert(tokens, asked, &secrets, now_s)?;
            Ok(made.into_iter().zip(secrets.clone()).collect())
        })
    }

    /// Revokes a token from now on. A second revocation keeps the first date.
    ///
    /// # Errors
    /// No token has the id, or the file cannot be written.
    pub fn revoke(&self, id: &str, now_s: u64) -> Result<TokenRecord, StateError> {
        let path = self.folder.file(FILE);
        self.change(now_s, |tokens| {
            let found = tokens.iter_mut().find(|token| token.id == id);
            let token = found.ok_or_else(|| {
                let id = id.escape_debug();
                StateError::content(
                    &path,
                    format!(
                        "no token has the id `{id}`; `sulcus-server token list` prints the ids"
                    ),
                )
            })?;
            token.revoked_unix_s.get_or_insert(now_s);
            Ok(token.clone())
        })
    }

    /// Changes the list under the lock and writes it, unless `change` fails.
    ///
    /// # Errors
    /// The error of `change`, or the file cannot be read or written.
    pub(crate) fn change<R>(
        &self,
        now_s: u64,
        change: impl FnOnce(&mut Vec<TokenRecord>) -> Result<R, StateError>,
    ) -> Result<R, StateError> {
        let path = self.folder.file(FILE);
        let _lock = Lock::wait_for(&self.folder.file("tokens.lock"), self.lock_wait)?;
        let mut tokens = self.list()?;
        tokens.retain(|token| {
            let end = token.revoked_unix_s.unwrap_or(token.expires_unix_s);
            now_s < end.saturating_add(KEPT_S)
        });
        let result = change(&mut tokens)?;
        if tokens.len() > MOST_TOKENS {
            let found = tokens.len();
            return Err(StateError::content(
                &path,
                format!("{found} tokens, expected at most {MOST_TOKENS}; use another state folder"),
            ));
        }
        let stored = Stored {
            version: VERSION,
            tokens,
        };
        let mut bytes = serde_json::to_vec_pretty(&stored)
            .map_err(|error| StateError::content(&path, error.to_string()))?;
        bytes.push(b'\n');
        write_private(&path, &bytes)?;
        Ok(result)
    }
}

/// Appends a token for each of `asked` with the secret of the same place.
///
/// # Errors
/// A value is not valid.
pub(crate) fn insert(
    tokens: &mut Vec<TokenRecord>,
    asked: &[NewToken],
    secrets: &[Secret],
    now_s: u64,
) -> Result<Vec<TokenRecord>, StateError> {
    let first = tokens.len();
    for (new, secret) in asked.iter().zip(secrets) {
        new.check()
            .map_err(|why| StateError::content("token".as_ref(), why))?;
        let record = TokenRecord {
            id: new_id(tokens)?,
            role: new.role,
            station: new.station.clone(),
            learner: new.learner.clone(),
            class: new.class.clone(),
            blake3: secret.hash(),
            created_unix_s: now_s,
            expires_unix_s: new.expires_unix_s,
            revoked_unix_s: None,
        };
        tokens.push(record);
    }
    Ok(tokens[first..].to_vec())
}

/// Short random id that no token has. The id grows by a byte when eight attempts found only taken ids.
fn new_id(tokens: &[TokenRecord]) -> Result<String, StateError> {
    for attempt in 0..usize::MAX {
        let mut bytes = [0; 8];
        random(&mut bytes)?;
        let digits = (4 + attempt / 8 * 2).min(16);
        let id = format!("t-{}", &hex(&bytes)[..digits]);
        if tokens.iter().all(|token| token.id != id) {
            return Ok(id);
        }
    }
    Err(StateError::Random("no free token id".into()))
}

/// Tokens of a file's content.
///
/// # Errors
/// The line, the fault and the value expected. The message quotes no hash.
pub(super) fn parse(bytes: &[u8]) -> Result<Vec<TokenRecord>, String> {
    let stored: Stored = serde_json::from_slice(bytes).map_err(|error| {
        format!("not a list of tokens: {error}; restore the file from a backup")
    })?;
    if stored.version != VERSION {
        return Err(format!(
            "version is {}, expected {VERSION}; install the program that wrote the file",
            stored.version
        ));
    }
    Ok(stored.tokens)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use sulcus_proto::Role;

    use super::*;
    use crate::state::tokens::record::Place;

    const NOW: u64 = 1_795_651_200;

    fn store() -> (tempfile::TempDir, TokenStore) {
        let place = tempfile::tempdir().expect("temporary folder");
        let folder = StateFolder::open(Some(&place.path().join("state"))).expect("creates");
        (place, TokenStore::of(&folder))
    }

    fn student(station: &str, learner: &str) -> NewToken {
        NewToken {
            role: Role::Student,
            station: Place::Station(station.into()),
            learner: learner.into(),
            class: String::new(),
            expires_unix_s: NOW + DAY_S,
        }
    }

    #[test]
    fn no_secret_is_stored_or_shown_by_debug() {
        let (_place, store) = store();
        let made = store.add(&[student("a-1", "s-1")], NOW).expect("adds");
        let secret = made[0].1.reveal();
        assert!(secret.len() == 64 && made[0].0.id.len() == 6, "{made:?}");
        let file = std::fs::read_to_string(store.folder.file(FILE)).expect("reads");
        assert!(!file.contains(secret), "{file}");
        let hash = blake3::hash(secret.as_bytes()).to_hex();
        assert!(file.contains(hash.as_str()), "{file}");
        let debug = format!("{made:?}");
        assert!(!debug.contains(secret) && !debug.contains(hash.as_str()));
    }

    #[test]
    fn a_bad_value_adds_no_token_at_all() {
        let (_place, store) = store();
        let named = student("a-1", "Jane Doe");
        let error = store.add(&[student("a-1", "s-1"), named], NOW);
        let error = error.expect_err("a name").to_string();
        assert!(
            error.contains("Jane Doe") && error.contains("opaque"),
            "{error}"
        );
        assert_eq!(store.list().expect("reads"), []);
        for (wrong, told) in [
            (
                NewToken {
                    station: Place::Any,
                    ..student("a", "")
                },
                "one station",
            ),
            (student("a/b", ""), "`a/b`"),
            (
                NewToken {
                    role: Role::Examiner,
                    ..student("a", "s-1")
                },
                "examiner",
            ),
            (
                NewToken {
                    class: "x\ny".into(),
                    ..student("a", "")
                },
                "class",
            ),
        ] {
            let error = store.add(&[wrong], NOW).expect_err(told).to_string();
            assert!(error.contains(told), "{error}");
        }
    }

    #[test]
    fn a_revocation_keeps_its_first_date() {
        let (_place, store) = store();
        let made = store
            .add(&[student("a", ""), student("b", "")], NOW)
            .expect("adds");
        let id = &made[1].0.id;
        store.revoke(id, NOW + 10).expect("revokes");
        let again = store.revoke(id, NOW + 20).expect("again");
        assert_eq!(again.revoked_unix_s, Some(NOW + 10));
        let list = store.list().expect("reads");
        assert!(list[0].is_valid(NOW) && !list[1].is_valid(NOW));
        assert!(!list[0].is_valid(NOW + DAY_S));
        let error = store
            .revoke("t-\n", NOW)
            .expect_err("no such id")
            .to_string();
        assert!(error.contains("token list"), "{error}");
    }

    #[test]
    fn ended_tokens_are_dropped_after_a_long_time() {
        let (_place, store) = store();
        store.add(&[student("a", "")], NOW).expect("adds");
        let later = NOW + DAY_S + KEPT_S;
        let b = NewToken {
            expires_unix_s: later + DAY_S,
            ..student("b", "")
        };
        store.add(&[b], later - 1).expect("adds");
        assert_eq!(store.list().expect("reads").len(), 2);
        store.add(&[student("c", "")], later).expect("adds");
        let list = store.list().expect("reads");
        let stations: Vec<String> = list.iter().map(|one| one.station.to_string()).collect();
        assert_eq!(stations, ["b", "c"]);
    }

    #[test]
    fn two_writers_at_once_lose_no_token() {
        let (_place, store) = store();
        // Each of the twenty writes waits for the disk, and the others wait for it.
        let store = TokenStore {
            lock_wait: Duration::from_secs(120),
            ..store
        };
        std::thread::scope(|scope| {
            for k in 0..4 {
                let store = &store;
                scope.spawn(move || {
                    for n in 0..5 {
                        let new = student("a", &format!("s-{k}{n}"));
                        store.add(&[new], NOW).expect("adds");
                    }
                });
            }
        });
        let mut ids: Vec<String> = store
            .list()
            .expect("reads")
            .into_iter()
            .map(|t| t.id)
            .collect();
        ids.sort();
        ids.dedup();
        assert_eq!(ids.len(), 20);
    }

    #[test]
    fn a_rest_of_a_crash_does_no_harm() {
        let (_place, store) = store();
        store.add(&[student("a", "")], NOW).expect("adds");
        // A crash between the write and the rename leaves a part under another name.
        let rest = store.folder.file(".tokens.json.new-1-0");
        std::fs::write(&rest, "{\"version\":1,\"tok").expect("writes");
        store.add(&[student("b", "")], NOW).expect("adds");
        assert_eq!(store.list().expect("reads").len(), 2);
    }

    #[test]
    fn a_damaged_file_is_named_and_left_alone() {
        let (_place, store) = store();
        store.add(&[student("a", "")], NOW).expect("adds");
        let path = store.folder.file(FILE);
        let good = std::fs::read_to_string(&path).expect("reads");
        let hash = good
            .split('"')
            .find(|part| part.len() == 64)
            .expect("a hash")
            .to_owned();
        for (damaged, told) in [
            (good[..good.len() / 2].to_owned(), "line"),
            (good.replace("student", "teacher"), "teacher"),
            (
                good.replace("\"version\": 1", "\"version\": 2"),
                "version is 2",
            ),
            (good.replace(&hash, &hash[1..]), "blake3"),
            (good.replace("\"role\"", "\"rule\""), "rule"),
        ] {
            std::fs::write(&path, &damaged).expect("writes");
            let error = store
                .add(&[student("b", "")], NOW)
                .expect_err(told)
                .to_string();
            assert!(
                error.contains(told) && !error.contains(&hash[1..]),
                "{error}"
            );
            assert_eq!(std::fs::read_to_string(&path).expect("reads"), damaged);
        }
    }

    proptest! {
        #[test]
        fn no_content_panics(bytes in proptest::collection::vec(any::<u8>(), 0..200), text in "\\PC{0,80}") {
            let _ = parse(&bytes);
            let _ = parse(text.as_bytes());
        }
    }
}
