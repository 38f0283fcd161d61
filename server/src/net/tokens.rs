//! Tokens of clients, as the network asks for them: at the hello, and once a second of each open connection.

use sulcus_proto::Role;

pub use crate::state::{Denied, Grant, Place};

/// Store of tokens.
pub trait Tokens: Send + Sync {
    /// Holder of the token with this secret. The comparison takes a time that does not depend on the secret.
    ///
    /// # Errors
    /// No token has the secret, or the token is no longer valid.
    fn find(&self, secret: &str) -> Result<Grant, Denied>;

    /// Rights of the token with this id, for a person whose password was right.
    ///
    /// # Errors
    /// No token has the id, or the token is no longer valid. The default knows no ids.
    fn holder(&self, id: &str) -> Result<Grant, Denied> {
        let _ = id;
        Err(Denied::Unknown)
    }

    /// Whether the token `id` of an open connection is still valid. The default never ends a connection.
    ///
    /// # Errors
    /// The token has expired or was revoked.
    fn still(&self, id: &str) -> Result<(), Denied> {
        let _ = id;
        Ok(())
    }
}

impl Tokens for crate::state::Tokens {
    fn find(&self, secret: &str) -> Result<Grant, Denied> {
        self.grant(secret, crate::state::date::now_s())
    }

    fn holder(&self, id: &str) -> Result<Grant, Denied> {
        crate::state::Tokens::holder(self, id, crate::state::date::now_s())
    }

    fn still(&self, id: &str) -> Result<(), Denied> {
        crate::state::Tokens::still(self, id, crate::state::date::now_s())
    }
}

/// Tokens that never change, held as hashes.
#[derive(Debug, Default)]
pub struct Fixed(Vec<(blake3::Hash, Grant)>);

impl Fixed {
    /// Adds a token of a role. `station`: `None` for every station.
    #[must_use]
    pub fn with(mut self, secret: &str, id: &str, role: Role, station: Option<&str>) -> Self {
        let grant = Grant {
            id: id.to_owned(),
            role,
            station: station.map_or(Place::Any, |name| Place::Station(name.to_owned())),
            learner: String::new(),
            class: String::new(),
        };
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
        let tokens = Fixed::default().with("secret", "t-1", Role::Student, Some("chair-1"));
        let grant = tokens.find("secret").expect("found");
        assert_eq!((grant.id.as_str(), grant.role), ("t-1", Role::Student));
        assert!(grant.station.includes("chair-1") && !grant.station.includes("chair-10"));
        assert_eq!(tokens.find("t-1"), Err(Denied::Unknown));
    }
}
