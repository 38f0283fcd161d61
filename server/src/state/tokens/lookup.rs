//! Tokens as a running server asks for them. A change of the file is seen by the next question.

use std::os::unix::fs::MetadataExt as _;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use sulcus_proto::Role;

use super::record::{Place, TokenHash, TokenRecord};
use super::store::{FILE, TokenStore};
use crate::state::date::day;
use crate::state::error::StateError;
use crate::state::folder::StateFolder;

/// Rights of a valid token.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Grant {
    /// Id of the token, for logs and recordings.
    pub id: String,
    /// Rights of the holder.
    pub role: Role,
    /// Stations that the token opens.
    pub station: Place,
    /// Opaque learner id; may be empty.
    pub learner: String,
    /// Class for which the token was made; may be empty.
    pub class: String,
}

/// Reason why a token opens nothing. The text is a sentence for the holder.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Denied {
    /// No token has this text.
    #[error("this server does not know the token; ask for a ticket of this server")]
    Unknown,
    /// The token was revoked.
    #[error("token {id} was revoked on {on}; ask for a new ticket")]
    Revoked {
        /// Id of the token.
        id: String,
        /// Date, UTC.
        on: String,
    },
    /// The token has expired.
    #[error("token {id} expired on {on}; ask for a new ticket")]
    Expired {
        /// Id of the token.
        id: String,
        /// Date, UTC.
        on: String,
    },
    /// The file of the tokens cannot be used. The text has no detail; the server's log has it.
    #[error("the server cannot read its list of tokens; tell an instructor")]
    Unreadable,
}

/// Identity of a file's content. A replaced file has another inode; an edited one another time or length.
type Stamp = (u64, i64, i64, u64);

/// Newest known content of the file.
#[derive(Debug, Default)]
struct Known {
    /// `None`: there is no file, or nothing was read yet.
    stamp: Option<Stamp>,
    tokens: Vec<TokenRecord>,
    /// Whether the file of `stamp` could not be used.
    is_faulty: bool,
}

/// Tokens of a running server: those of the state folder, and those of its command line.
///
/// Every question looks at the file's time first, which costs one call of the system. A command that adds or revokes a
/// token therefore acts at once and without a restart. A file that cannot be read refuses every token but those of the
/// command line.
#[derive(Debug)]
pub struct Tokens {
    store: TokenStore,
    path: PathBuf,
    known: Mutex<Known>,
    /// Tokens of this process alone, never written.
    extra: Vec<(TokenHash, Grant)>,
}

impl Tokens {
    /// Tokens of `folder`.
    ///
    /// # Errors
    /// The file exists and cannot be used; a server should not start then.
    pub fn open(folder: &StateFolder) -> Result<Self, StateError> {
        let store = TokenStore::of(folder);
        store.list()?;
        Ok(Self {
            store,
            path: folder.file(FILE),
            known: Mutex::default(),
            extra: Vec::new(),
        })
    }

    /// Adds a token of the command line or the environment, which never expires and is not stored.
    #[must_use]
    pub fn with_extra(mut self, secret: &str, id: &str, role: Role, station: Place) -> Self {
        let grant = Grant {
            id: id.to_owned(),
            role,
            station,
            learner: String::new(),
            class: String::new(),
        };
        self.extra.push((TokenHash::of(secret), grant));
        self
    }

    /// Rights of the holder of `token` at a time in seconds since 1970. The time of the answer does not depend on how
    /// much of a token is right: every stored hash is compared, in constant time.
    ///
    /// # Errors
    /// The token is unknown, revoked or expired, or the file cannot be read.
    pub fn grant(&self, token: &str, now_s: u64) -> Result<Grant, Denied> {
        let asked = TokenHash::of(token);
        let mut found = None;
        for (hash, grant) in &self.extra {
            if *hash == asked {
                found = Some(grant.clone());
            }
        }
        if let Some(grant) = found {
            return Ok(grant);
        }
        self.with_known(|known| {
            let mut found = None;
            for token in &known.tokens {
                if token.blake3 == asked {
                    found = Some(token);
                }
            }
            let unknown = if known.is_faulty {
                Denied::Unreadable
            } else {
                Denied::Unknown
            };
            judge(found.ok_or(unknown)?, now_s)
        })
    }

    /// Whether the token with this id is still valid, for a connection that it opened. Ask once a second.
    ///
    /// A file that cannot be read at present does not end a connection.
    ///
    /// # Errors
    /// The token was revoked, has expired, or is no longer in the file.
    pub fn still(&self, id: &str, now_s: u64) -> Result<(), Denied> {
        if self.extra.iter().any(|(_, grant)| grant.id == id) {
            return Ok(());
        }
        self.with_known(|known| {
            if known.is_faulty {
                return Ok(());
            }
            let found = known.tokens.iter().find(|token| token.id == id);
            judge(found.ok_or(Denied::Unknown)?, now_s).map(|_| ())
        })
    }

    /// Rights of the stored token with this id, for a person whose password was right.
    ///
    /// # Errors
    /// The token is unknown, revoked or expired, or the file cannot be read.
    pub fn holder(&self, id: &str, now_s: u64) -> Result<Grant, Denied> {
        self.with_known(|known| {
            if known.is_faulty {
                return Err(Denied::Unreadable);
            }
            let found = known.tokens.iter().find(|token| token.id == id);
            judge(found.ok_or(Denied::Unknown)?, now_s)
        })
    }

    /// Number of tokens that are valid at a time in seconds since 1970, those of the command line included.
    pub fn valid(&self, now_s: u64) -> usize {
        let stored = self.with_known(|known| {
            let valid = known.tokens.iter().filter(|token| token.is_valid(now_s));
            valid.count()
        });
        stored + self.extra.len()
    }

    /// Calls `ask` with the newest content of the file.
    fn with_known<R>(&self, ask: impl FnOnce(&Known) -> R) -> R {
        // A panic while the lock was held cannot leave a half-written list: it is replaced whole.
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        let stamp = std::fs::metadata(&self.path)
            .ok()
            .map(|file| (file.ino(), file.mtime(), file.mtime_nsec(), file.size()));
        if stamp != known.stamp || known.is_faulty {
            *known = match self.store.list() {
                Ok(tokens) => Known {
                    stamp,
                    tokens,
                    is_faulty: false,
                },
                Err(error) => {
                    if !known.is_faulty {
                        tracing::error!("no stored token is valid: {error}");
                    }
                    Known {
                        stamp,
                        tokens: Vec::new(),
                        is_faulty: true,
                    }
                }
            };
        }
        ask(&known)
    }
}

fn judge(token: &TokenRecord, now_s: u64) -> Result<Grant, Denied> {
    let id = token.id.clone();
    if let Some(revoked) = token.revoked_unix_s {
        return Err(Denied::Revoked {
            id,
            on: day(revoked),
        });
    }
    if now_s >= token.expires_unix_s {
        return Err(Denied::Expired {
            id,
            on: day(token.expires_unix_s),
        });
    }
    Ok(Grant {
        id,
        role: token.role,
        station: token.station.clone(),
        learner: token.learner.clone(),
        class: token.class.clone(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::date::DAY_S;
    use crate::state::folder::fresh as folder;
    use crate::state::tokens::record::NewToken;

    /// 2026-11-26.
    const NOW: u64 = 1_795_651_200;

    fn student(station: &str, days: u64) -> NewToken {
        NewToken {
            role: Role::Student,
            station: Place::Station(station.into()),
            learner: "s-17".into(),
            class: "autumn".into(),
            expires_unix_s: NOW + days * DAY_S,
        }
    }

    #[test]
    fn yesterdays_token_works_and_a_revoked_one_says_so() {
        let (_place, folder) = folder();
        let store = TokenStore::of(&folder);
        let made = store
            .add(&[student("a", 30), student("b", 2)], NOW)
            .expect("adds");
        // Another process, a day later.
        let tokens = Tokens::open(&folder).expect("opens");
        let later = NOW + DAY_S;
        let grant = tokens.grant(made[0].1.reveal(), later).expect("valid");
        assert_eq!(
            (grant.role, grant.learner.as_str()),
            (Role::Student, "s-17")
        );
        assert!(grant.station.includes("a") && !grant.station.includes("b"));
        assert_eq!(tokens.valid(later), 2);

        store.revoke(&grant.id, later).expect("revokes");
        let denied = tokens
            .grant(made[0].1.reveal(), later)
            .expect_err("revoked");
        assert_eq!(
            denied.to_string(),
            format!(
                "token {} was revoked on 2026-11-27; ask for a new ticket",
                grant.id
            )
        );
        assert_eq!(tokens.still(&grant.id, later), Err(denied));
        let denied = tokens
            .grant(made[1].1.reveal(), NOW + 2 * DAY_S)
            .expect_err("expired");
        assert!(
            denied.to_string().contains("expired on 2026-11-28"),
            "{denied}"
        );
        assert_eq!(tokens.grant("guess", later), Err(Denied::Unknown));
        assert_eq!(tokens.valid(later), 1);
    }

    #[test]
    fn a_token_that_is_added_while_the_server_runs_is_valid_at_once() {
        let (_place, folder) = folder();
        let tokens = Tokens::open(&folder).expect("no file yet");
        assert_eq!(tokens.grant("guess", NOW), Err(Denied::Unknown));
        let store = TokenStore::of(&folder);
        for station in ["a", "b", "c"] {
            let made = store.add(&[student(station, 1)], NOW).expect("adds");
            let grant = tokens.grant(made[0].1.reveal(), NOW).expect("valid");
            assert!(grant.station.includes(station));
        }
    }

    #[test]
    fn a_file_that_cannot_be_read_refuses_new_and_keeps_old_connections() {
        let (_place, folder) = folder();
        let store = TokenStore::of(&folder);
        let made = store.add(&[student("a", 1)], NOW).expect("adds");
        let tokens = Tokens::open(&folder).expect("opens").with_extra(
            "classroom",
            "t-serve",
            Role::Student,
            Place::Station("a".into()),
        );
        let path = folder.file(FILE);
        let good = std::fs::read(&path).expect("reads");
        std::fs::write(&path, b"{").expect("writes");
        let denied = tokens.grant(made[0].1.reveal(), NOW).expect_err("faulty");
        assert_eq!(denied, Denied::Unreadable);
        assert!(!denied.to_string().contains("tokens.json"), "{denied}");
        assert_eq!(tokens.still(&made[0].0.id, NOW), Ok(()));
        assert_eq!(tokens.grant("classroom", NOW).expect("extra").id, "t-serve");
        assert!(Tokens::open(&folder).is_err(), "a server does not start");
        std::fs::write(&path, good).expect("writes");
        assert!(tokens.grant(made[0].1.reveal(), NOW).is_ok(), "repaired");
    }

    #[test]
    fn a_removed_file_ends_its_tokens() {
        let (_place, folder) = folder();
        let made = TokenStore::of(&folder)
            .add(&[student("a", 1)], NOW)
            .expect("adds");
        let tokens = Tokens::open(&folder).expect("opens");
        assert!(tokens.grant(made[0].1.reveal(), NOW).is_ok());
        std::fs::remove_file(folder.file(FILE)).expect("removes");
        assert_eq!(tokens.grant(made[0].1.reveal(), NOW), Err(Denied::Unknown));
        assert_eq!(tokens.still(&made[0].0.id, NOW), Err(Denied::Unknown));
    }
}
