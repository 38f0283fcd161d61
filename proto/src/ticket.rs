//! What a student's station needs to join: the token, and whom to trust. One line of text,
//! `TOKEN.FINGERPRINT`, that a server prints and a person copies.

use std::fmt;
use std::str::FromStr;

/// Token and pinned certificate.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Ticket {
    /// Shared secret of the server; may hold dots.
    pub token: String,
    /// SHA-256 of the server's certificate (DER).
    pub fingerprint: [u8; 32],
}

/// The text is not a ticket.
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

/// Lower-case hexadecimal digits.
pub fn hex(bytes: &[u8]) -> String {
    use fmt::Write as _;
    bytes
        .iter()
        .fold(String::with_capacity(2 * bytes.len()), |mut text, byte| {
            let _ = write!(text, "{byte:02x}");
            text
        })
}

/// A fingerprint from its 64 digits.
pub fn parse_hex(digits: &str) -> Option<[u8; 32]> {
    // Checked first: `from_str_radix` also takes signs, and slicing needs single-byte characters.
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
