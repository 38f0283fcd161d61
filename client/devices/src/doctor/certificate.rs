//! Check of the ticket, which pins the server's certificate.

use super::check::{Check, part};

const NAME: &str = "certificate";

/// Says whether the ticket could be read, and what a ticket cannot show.
pub fn check(ticket: Option<&Result<String, String>>) -> Check {
    match ticket {
        None => Check::fine(
            NAME,
            "no ticket was given, so no certificate is checked. Set SULCUS_TICKET to the line that the server prints.",
        ),
        Some(Ok(text)) => Check::fine(
            NAME,
            format!(
                "the form of the ticket is right; fingerprint of the certificate: {}. A ticket shows no expiry: a run \
                 that connects checks whether the server still has this certificate.",
                part(text)
            ),
        ),
        Some(Err(reason)) => Check::wrong(
            NAME,
            format!(
                "the ticket cannot be read: {}. Copy the whole line that the server prints.",
                part(reason.trim_end_matches('.'))
            ),
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ticket_is_absent_right_or_wrong() {
        assert!(check(None).ok);
        let right = check(Some(&Ok("ab".repeat(32))));
        assert!(right.ok && right.message.contains(&"ab".repeat(32)));
        assert!(right.message.contains("no expiry"));
        let wrong = check(Some(&Err("y".repeat(900))));
        assert!(!wrong.ok && wrong.message.ends_with("that the server prints."));
        assert!(wrong.message.chars().count() <= 300 && right.message.chars().count() <= 300);
    }
}
