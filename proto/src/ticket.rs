//! Ticket with which a student's client joins a server: access token and pinned certificate.
//!
//! A ticket is a line of text, `TOKEN.FINGERPRINT`. The server prints the line and a person copies it.

use std::fmt;
use std::str::FromStr;

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
        let fingerprint = parse_hex(digits).ok_or(TicketError)?;
        if token.is_empty() {
            return Err(TicketError);
        }
        Ok(Ticket {
            token: token.to_owned(),
            fingerprint,
        })
    }
}

/// Formats bytes as lower-case hexadecimal digits.
pub fn hex(bytes: &[u8]) -> String {
    use fmt::Write as _;
    bytes
        .iter()
        .fold(String::with_capacity(2 * bytes.len()), |mut text, byte| {
            let _ = write!(text, "{byte:02x}");
            text
        })
}

/// Parses a fingerprint of 64 hexadecimal digits; `None` if invalid.
pub fn parse_hex(digits: &str) -> Option<[u8; 32]> {
    // This check comes first: `from_str_radix` also accepts signs, and slicing needs single-byte characters.
    if digits.len() != 64 || !digits.bytes().all(|b| b.is_ascii_hexdigit()) {
        return None;
    }
    let mut bytes = [0; 32];
    for (byte, at) in bytes.iter_mut().zip((0..).step_by(2)) {
        *byte = u8::from_str_radix(&digits[at..at + 2], 16).ok()?;
    }
    Some(bytes)
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
