//! A token as it is stored, and a new token as it is asked for.

use std::fmt;

use serde::{Deserialize, Deserializer, Serialize, Serializer};
use sulcus_proto::hex::{from_hex32, hex};
use sulcus_proto::{Role, learner};

use crate::plan::names::is_station_name;
use crate::state::error::{StateError, random};

/// Longest name of a class, characters.
const LONGEST_CLASS: usize = 64;

/// Secret text of a token: 64 hexadecimal digits. The text is shown once, and `Debug` hides it.
#[derive(Clone, PartialEq, Eq)]
pub struct Secret(String);

impl Secret {
    /// New secret from the system's random numbers.
    ///
    /// # Errors
    /// The system has none.
    pub fn new() -> Result<Self, StateError> {
        let mut bytes = [0; 32];
        random(&mut bytes)?;
        Ok(Self(hex(&bytes)))
    }

    /// Text of the secret, for its holder.
    pub fn reveal(&self) -> &str {
        &self.0
    }

    /// Hash under which the token is stored.
    pub(crate) fn hash(&self) -> TokenHash {
        TokenHash::of(&self.0)
    }
}

impl fmt::Debug for Secret {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Secret(..)")
    }
}

/// BLAKE3 hash of a token's text. Two hashes compare in constant time; `Debug` hides the bytes.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) struct TokenHash(blake3::Hash);

impl TokenHash {
    /// Hash of a token's text.
    pub fn of(token: &str) -> Self {
        Self(blake3::hash(token.as_bytes()))
    }
}

impl fmt::Debug for TokenHash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("TokenHash(..)")
    }
}

impl Serialize for TokenHash {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_str(&hex(self.0.as_bytes()))
    }
}

impl<'de> Deserialize<'de> for TokenHash {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let digits = String::deserialize(from)?;
        let bytes = from_hex32(&digits).ok_or_else(|| {
            // The digits found stay out of the message.
            serde::de::Error::custom("blake3 is no hash, expected 64 hexadecimal digits")
        })?;
        Ok(Self(bytes.into()))
    }
}

/// Stations that a token opens.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// Every station of the server; never of a student or a display.
    Any,
    /// The station of this name.
    Station(String),
}

impl Place {
    /// Whether the place includes a station.
    pub fn includes(&self, station: &str) -> bool {
        match self {
            Place::Any => true,
            Place::Station(name) => name == station,
        }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Place::Any => "any",
            Place::Station(name) => name,
        })
    }
}

impl Serialize for Place {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for Place {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        Ok(match String::deserialize(from)? {
            any if any == "any" => Place::Any,
            name => Place::Station(name),
        })
    }
}

/// A stored token. The record holds no secret.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TokenRecord {
    /// Short public name, such as `t-7f3a`; never reused.
    pub id: String,
    /// Rights of the holder.
    pub role: Role,
    /// Stations that the token opens.
    pub station: Place,
    /// Opaque learner id; empty for roles other than the student's and for an anonymous student.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub learner: String,
    /// Name of the class for which the token was made; may be empty.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub class: String,
    /// Hash of the token.
    pub(crate) blake3: TokenHash,
    /// Time at which the token was made, seconds since 1970.
    pub created_unix_s: u64,
    /// Time from which the token is no longer valid, seconds since 1970.
    pub expires_unix_s: u64,
    /// Time of the revocation, seconds since 1970; `None`: not revoked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub revoked_unix_s: Option<u64>,
}

impl TokenRecord {
    /// Whether the token is neither revoked nor expired at a time in seconds since 1970.
    pub fn is_valid(&self, now_s: u64) -> bool {
        self.revoked_unix_s.is_none() && now_s < self.expires_unix_s
    }
}

/// Token that is asked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NewToken {
    /// Rights of the holder.
    pub role: Role,
    /// Stations that the token opens.
    pub station: Place,
    /// Opaque learner id; may be empty.
    pub learner: String,
    /// Name of the class; may be empty.
    pub class: String,
    /// Time from which the token is no longer valid, seconds since 1970.
    pub expires_unix_s: u64,
}

impl NewToken {
    /// Checks that the values fit each other.
    ///
    /// # Errors
    /// The first value that does not: field, value found, value expected.
    pub fn check(&self) -> Result<(), String> {
        let role = self.role;
        match &self.station {
            Place::Any if role.is_of_one_station() => {
                return Err(format!(
                    "station is `any`, expected the name of one station for a {role}"
                ));
            }
            Place::Station(name) if !is_station_name(name) => {
                let found = name.escape_debug();
                return Err(format!(
                    "station is `{found}`, expected {}",
                    crate::plan::names::EXPECTED
                ));
            }
            _ => {}
        }
        if !self.learner.is_empty() && role != Role::Student {
            return Err(format!(
                "learner is `{}`, expected none for a {role}",
                self.learner.escape_debug()
            ));
        }
        if let Err(expected) = learner::parse(&self.learner) {
            return Err(format!(
                "learner is `{}`: {expected}",
                self.learner.escape_debug()
            ));
        }
        let class = &self.class;
        if class.chars().count() > LONGEST_CLASS || class.contains(char::is_control) {
            return Err(format!(
                "class is `{}`, expected at most {LONGEST_CLASS} characters without line feeds",
                class.escape_debug()
            ));
        }
        Ok(())
    }
}
