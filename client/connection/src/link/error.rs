//! Errors of a link.

use std::net::SocketAddr;

use sulcus_link::control::ReadError;
use sulcus_proto::{CodecError, PROTOCOL_VERSION};

/// Error of a link: no connection, a refusal, or a lost connection. Each message is one sentence.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LinkError {
    /// No answer within the timeout, to the connection or to the hello.
    #[error(
        "no server answers at {server}; check address, UDP port and firewall, and that the server runs"
    )]
    Absent {
        /// Address tried.
        server: SocketAddr,
    },
    /// No connection to any of several addresses, each with its error.
    #[error("no connection to the server at any of its addresses: {}; check address, UDP port and firewall, and that the server runs", each(.0))]
    Nowhere(Vec<(SocketAddr, LinkError)>),
    /// The server has another certificate than the pinned one.
    #[error(
        "the server at {server} has another certificate than the pinned one; a server has a new ticket after each rotation of its certificate: use the present one"
    )]
    WrongCertificate {
        /// Address tried.
        server: SocketAddr,
    },
    /// The server has another version of the protocol or of QUIC.
    #[error("protocol versions differ, this client has {PROTOCOL_VERSION}: {0}")]
    Version(String),
    /// The server refuses the token.
    #[error("refused: {0}")]
    WrongToken(String),
    /// The server refuses because another client uses the station.
    #[error("refused: {0}")]
    Busy(String),
    /// The server refuses for another reason: an invalid hello, or an exercise that the server does not offer.
    #[error("refused: {0}")]
    Refused(String),
    /// A message of the server does not decode, or a message of this client does not encode.
    #[error("the server violates the protocol: {0}")]
    Protocol(#[from] CodecError),
    /// A limit in the server's hello is not a finite number above zero.
    #[error("the server's hello has {field} {found}, expected {expected}")]
    BadHello {
        /// Field of the hello.
        field: &'static str,
        /// Value found.
        found: String,
        /// Values expected.
        expected: &'static str,
    },
    /// The connection was lost or closed.
    #[error("the connection to the server was lost: {0}")]
    Lost(String),
    /// No goodbye within the timeout after a stop.
    #[error(
        "the server sent no goodbye within the timeout; the recording may still be complete: see the server's log"
    )]
    NoGoodbye,
    /// TLS or QUIC cannot be configured, or the system refuses a socket, a thread or an event.
    #[error("cannot set up the link: {0}")]
    System(String),
}

/// Addresses with their errors, separated by semicolons.
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
    /// Whether a further attempt to return to the session may succeed: the network or the server may come back, and the
    /// station may become free.
    pub(super) fn may_pass(&self) -> bool {
        matches!(
            self,
            Self::Absent { .. }
                | Self::Nowhere(_)
                | Self::Lost(_)
                | Self::Busy(_)
                | Self::System(_)
        )
    }

    /// [`LinkError::Lost`] with a text that may hold words of the peer: control characters are escaped.
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
