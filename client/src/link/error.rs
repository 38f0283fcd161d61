//! Why there is no link, or no longer.

use std::net::SocketAddr;

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
    /// The connection was lost.
    #[error("the connection to the server was lost: {0}")]
    Lost(String),
    /// The server did not confirm the end.
    #[error("the server said no goodbye; its recording may still be whole")]
    NoGoodbye,
    /// TLS or the system refuses something.
    #[error("cannot set up the link: {0}")]
    System(String),
}

impl From<std::io::Error> for LinkError {
    fn from(error: std::io::Error) -> Self {
        Self::System(error.to_string())
    }
}
