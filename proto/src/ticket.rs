//! Ticket with which a student's client joins a server: access token and pinned certificate.
//!
//! A ticket is a line of text, `TOKEN.FINGERPRINT`. The server prints the line and a person copies it.

use std::fmt;
use std::str::FromStr;

use crate::hex::{from_hex32, hex};

/// Access token and fingerprint of the pinned certificate.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Ticket {
    /// Shared secret of the server; may contain dots.
    pub token: String,
    /// SHA-256 hash of the server's certificate in DER form.
    pub fingerprint: [u8; 32],
}

/// Error of a text that is no valid ticket.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "a ticket reads TOKEN.FINGERPRINT with 64 hexadecimal digits after the last dot; copy the whole line that the server prints"
)]
pub struct TicketError;

impl fmt::Display for Ticket {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}.{}", self.token, hex(&self.fingerprint))
    }
}

impl FromStr for Ticket {
    type Err = TicketError;

    fn from_str(text: &str) -> Result<Self, TicketError> {
        let (token, digits) = text.trim().rsplit_once('.').ok_or(TicketError)?;
        let fingerprint = from_hex32(digits).ok_or(TicketError)?;
        if token.is_empty() {
            return Err(TicketError);
        }
        Ok(Ticket {
            token: token.to_owned(),
            fingerprint,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn tickets_survive_text(token in "[a-z0-9.]{1,20}", fingerprint in any::<[u8; 32]>()) {
            let ticket = Ticket { token, fingerprint };
            prop_assert_eq!(ticket.to_string().parse(), Ok(ticket));
        }

        #[test]
        fn no_text_panics(text in "\\PC*") {
            let _ = text.parse::<Ticket>();
        }
    }
}
