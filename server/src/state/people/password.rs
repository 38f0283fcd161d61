//! Passwords and their hashes.

use std::fmt;

use argon2::password_hash::phc::PasswordHash;
use argon2::password_hash::{PasswordHasher, PasswordVerifier};
use argon2::{Argon2, Params};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::state::error::{StateError, random};

/// Shortest and longest password, bytes.
const BYTES: std::ops::RangeInclusive<usize> = 10..=256;
/// Signs of a made password: digits and letters that nobody confuses.
const SIGNS: &[u8; 32] = b"23456789abcdefghijkmnpqrstuvwxyz";
/// Number of signs of a made password, each of five bits.
const MADE: usize = 20;
/// Hash of a password that nobody knows, for names that do not exist. Its parameters are those of new hashes.
const NOBODY: &str = "$argon2id$v=19$m=19456,t=2,p=1$c3VsY3VzIG5vYm9keSE$tIxEJ1yXGjjzcWbwAfVb3w2kXv7MmsSDLuC2mPKoFFA";

/// Password of a person. `Debug` hides it.
#[derive(Clone, PartialEq, Eq)]
pub struct Password(String);

impl Password {
    /// Password of a text.
    ///
    /// # Errors
    /// The text is too short or too long: one sentence without the text.
    pub fn new(text: &str) -> Result<Self, String> {
        let found = text.len();
        if !BYTES.contains(&found) {
            let (least, most) = (BYTES.start(), BYTES.end());
            return Err(format!(
                "the password has {found} bytes, expected {least} to {most}"
            ));
        }
        Ok(Self(text.to_owned()))
    }

    /// New password of 100 random bits.
    ///
    /// # Errors
    /// The system has no random numbers.
    pub fn made() -> Result<Self, StateError> {
        let mut bytes = [0; MADE];
        random(&mut bytes)?;
        let sign = |byte: u8| char::from(SIGNS[usize::from(byte) % SIGNS.len()]);
        let groups: Vec<String> = bytes
            .chunks(5)
            .map(|group| group.iter().map(|byte| sign(*byte)).collect())
            .collect();
        Ok(Self(groups.join("-")))
    }

    /// Text, for the person.
    pub fn reveal(&self) -> &str {
        &self.0
    }

    /// Hash with a new salt. Takes some 50 ms of CPU time.
    pub(super) fn hash(&self) -> Result<Hash, StateError> {
        let hash = Argon2::default().hash_password(self.0.as_bytes());
        let hash = hash.map_err(|error| StateError::Random(error.to_string()))?;
        Ok(Hash(hash.to_string()))
    }
}

impl fmt::Debug for Password {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Password(..)")
    }
}

/// Hash of a password with salt and parameters, in the PHC format. `Debug` hides it.
#[derive(Clone, PartialEq, Eq)]
pub(crate) struct Hash(String);

/// Whether a text is a hash of bounded cost: a damaged file must not ask the server for gigabytes.
fn is_cheap(text: &str) -> bool {
    let hash = PasswordHash::new(text).ok();
    let params = hash.and_then(|hash| Params::try_from(&hash).ok());
    params.is_some_and(|params| {
        params.m_cost() <= 4 * Params::DEFAULT_M_COST
            && params.t_cost() <= 4 * Params::DEFAULT_T_COST
            && params.p_cost() <= 4
    })
}

impl Hash {
    /// Hash that no password has.
    pub fn of_nobody() -> Self {
        Self(NOBODY.to_owned())
    }

    /// Whether the hash is that of a password.
    pub fn is_of(&self, password: &str) -> bool {
        let Ok(hash) = PasswordHash::new(&self.0) else {
            return false;
        };
        BYTES.contains(&password.len())
            && Argon2::default()
                .verify_password(password.as_bytes(), &hash)
                .is_ok()
    }
}

impl fmt::Debug for Hash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Hash(..)")
    }
}

impl Serialize for Hash {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_str(&self.0)
    }
}

impl<'de> Deserialize<'de> for Hash {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let text = String::deserialize(from)?;
        if is_cheap(&text) {
            return Ok(Self(text));
        }
        // The text found stays out of the message.
        let why =
            "password is no argon2 hash in the PHC format with at most four times the usual cost";
        Err(serde::de::Error::custom(why))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hash_of_nobody_is_valid_and_costs_as_much_as_a_new_one() {
        let parameters = |hash: &Hash| {
            let parsed = PasswordHash::new(&hash.0).expect("a hash");
            (
                parsed.algorithm.to_string(),
                parsed.params.to_string(),
                parsed.hash.map(|hash| hash.len()),
            )
        };
        let new = Password::new("0123456789")
            .expect("valid")
            .hash()
            .expect("hashed");
        assert_eq!(parameters(&Hash::of_nobody()), parameters(&new));
        assert!(!Hash::of_nobody().is_of("0123456789"));
    }

    #[test]
    fn a_made_password_is_long_valid_and_new_each_time() {
        let [a, b] = [(); 2].map(|()| Password::made().expect("made"));
        assert_ne!(a, b);
        assert_eq!((a.reveal().len(), a.reveal().matches('-').count()), (23, 3));
        assert_eq!(Password::new(a.reveal()).as_ref(), Ok(&a));
        assert!(a.hash().expect("hashed").is_of(a.reveal()));
        assert_eq!(format!("{a:?}"), "Password(..)");
    }

    #[test]
    fn a_short_password_is_refused_without_a_word_of_it() {
        let told = Password::new("hunter2").expect_err("short");
        assert!(
            told.contains("7 bytes, expected 10 to 256") && !told.contains("hunter2"),
            "{told}"
        );
    }

    #[test]
    fn a_hash_that_asks_for_gigabytes_is_refused() {
        let new = Password::new("0123456789")
            .expect("valid")
            .hash()
            .expect("hashed");
        for (text, expected) in [
            (new.0.clone(), true),
            (new.0.replace("m=19456", "m=4000000"), false),
            (new.0.replace("t=2", "t=4000000"), false),
            ("$argon2id$".to_owned(), false),
            (String::new(), false),
        ] {
            let read = serde_json::from_value::<Hash>(text.clone().into());
            assert_eq!(read.is_ok(), expected, "{text}");
        }
    }

    #[test]
    fn two_hashes_of_one_password_differ() {
        let password = Password::new("0123456789").expect("valid");
        assert_ne!(
            password.hash().expect("hashed"),
            password.hash().expect("hashed")
        );
    }
}
