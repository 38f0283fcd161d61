//! Tokens of clients: who a secret stands for, and where it is valid.

use sulcus_proto::Role;

/// Holder of a token.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Grant {
    /// Opaque id of the token, for logs, recordings and other instructors.
    pub id: String,
    /// Role.
    pub role: Role,
    /// Station; `None`: every station.
    pub station: Option<String>,
    /// Opaque learner id; empty for an anonymous learner.
    pub learner: String,
}

impl Grant {
    /// Whether the token names the station.
    pub fn names(&self, station: &str) -> bool {
        self.station.as_deref().is_none_or(|own| own == station)
    }
}

/// Reason why a secret is not accepted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Denied {
    /// No token has this secret.
    Unknown,
    /// The token has expired or was revoked: one sentence.
    Over(String),
}

/// Store of tokens.
pub trait Tokens: Send + Sync {
    /// Holder of the token with this secret. The comparison takes a time that does not depend on the secret.
    ///
    /// # Errors
    /// No token has the secret, or the token is no longer valid.
    fn find(&self, secret: &str) -> Result<Grant, Denied>;
}

/// Tokens that never change, held as hashes.
#[derive(Debug, Default)]
pub struct Fixed(Vec<(blake3::Hash, Grant)>);

impl Fixed {
    /// Adds a token.
    #[must_use]
    pub fn with(mut self, secret: &str, grant: Grant) -> Self {
        self.0.push((blake3::hash(secret.as_bytes()), grant));
        self
    }
}

impl Tokens for Fixed {
    fn find(&self, secret: &str) -> Result<Grant, Denied> {
        // Hashes compare in constant time; strings do not.
        let asked = blake3::hash(secret.as_bytes());
        let found = self.0.iter().find(|(hash, _)| *hash == asked);
        found.map(|(_, grant)| grant.clone()).ok_or(Denied::Unknown)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_token_is_found_by_its_secret_alone() {
        let grant = Grant {
            id: "t-1".into(),
            role: Role::Instructor,
            station: None,
            learner: String::new(),
        };
        let tokens = Fixed::default().with("secret", grant.clone());
        assert_eq!(tokens.find("secret"), Ok(grant.clone()));
        assert_eq!(tokens.find("t-1"), Err(Denied::Unknown));
        assert!(grant.names("chair-1"));
        let bound = Grant {
            station: Some("chair-1".into()),
            ..grant
        };
        assert!(bound.names("chair-1") && !bound.names("chair-10"));
    }
}
