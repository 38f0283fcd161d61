//! Why there is no link, or no longer.

use std::net::SocketAddr;

use sulcus_link::control::ReadError;
use sulcus_proto::{CodecError, PROTOCOL_VERSION};

/// Why there is no link, or no longer. One sentence each.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LinkError {
    /// Nothing answers.
    #[error(
        "no server answers at {server}; check address, port and firewall, and that the server runs"
    )]
    Absent {
        /// Address tried.
        server: SocketAddr,
    },
    /// A name has several addresses, and no connection to any of them came about.
    #[error("no connection to the server at any of its addresses: {}; check address, port and firewall, and that the server runs", each(.0))]
    Nowhere(Vec<(SocketAddr, LinkError)>),
    /// Someone answers, but not the server that was pinned.
    #[error(
        "the server at {server} has another certificate than the pinned one; use the ticket that it prints now"
    )]
    WrongCertificate {
        /// Address tried.
        server: SocketAddr,
    },
    /// The server speaks another version of the protocol.
    #[error("protocol versions differ, this client speaks {PROTOCOL_VERSION}: {0}")]
    Version(String),
    /// The token is not the server's.
    #[error("refused: {0}")]
    WrongToken(String),
    /// Another client uses the station.
    #[error("refused: {0}")]
    Busy(String),
    /// Any other refusal.
    #[error("refused: {0}")]
    Refused(String),
    /// The server broke the protocol.
    #[error("the server does not speak this protocol: {0}")]
    Protocol(#[from] CodecError),
    /// The server's hello holds a value that no device can keep to.
    #[error("the server's hello has {field} {found}, expected {expected}")]
    BadHello {
        /// Field of the hello.
        field: &'static str,
        /// Value found.
        found: String,
        /// Values expected.
        expected: &'static str,
    },
    /// The connection was lost.
    #[error("the connection to the server was lost: {0}")]
    Lost(String),
    /// The server did not confirm the end.
    #[error(
        "the connection ended without the goodbye of the server; the recording may still be complete"
    )]
    NoGoodbye,
    /// TLS or the system refuses something.
    #[error("cannot set up the link: {0}")]
    System(String),
}

/// Each address with its reason.
fn each(tried: &[(SocketAddr, LinkError)]) -> String {
    let reasons: Vec<String> = tried
        .iter()
        .map(|(server, error)| match error {
            LinkError::Absent { .. } => format!("{server}: no answer"),
            LinkError::WrongCertificate { .. } => {
                format!("{server}: another certificate than the pinned one")
            }
            error => format!("{server}: {error}"),
        })
        .collect();
    reasons.join("; ")
}

impl LinkError {
    /// The connection was lost, in words that may be the other side's: they stay on one line.
    pub(super) fn lost(error: &impl std::fmt::Display) -> Self {
        let mut text = String::new();
        for c in error.to_string().chars() {
            if c.is_control() {
                text.extend(c.escape_default());
            } else {
                text.push(c);
            }
        }
        Self::Lost(text)
    }
}

impl From<ReadError> for LinkError {
    fn from(error: ReadError) -> Self {
        match error {
            ReadError::Closed(text) => Self::lost(&text),
            ReadError::Codec(error) => error.into(),
        }
    }
}

impl From<std::io::Error> for LinkError {
    fn from(error: std::io::Error) -> Self {
        Self::System(error.to_string())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_address_has_its_reason() {
        let [first, second] =
            ["[::1]:4433", "127.0.0.1:4433"].map(|text| text.parse().expect("an address"));
        let error = LinkError::Nowhere(vec![
            (first, LinkError::Absent { server: first }),
            (second, LinkError::WrongCertificate { server: second }),
        ]);
        let told = error.to_string();
        assert!(
            told.contains("[::1]:4433: no answer; 127.0.0.1:4433: another certificate"),
            "{told}"
        );
    }

    #[test]
    fn a_peers_reason_with_newlines_stays_on_one_line() {
        let error = LinkError::lost(&"closed: it's\nERROR \u{1b}[2Jall is well");
        assert_eq!(
            error,
            LinkError::Lost("closed: it's\\nERROR \\u{1b}[2Jall is well".into())
        );
    }
}
