//! What can keep a server from serving.

use std::net::SocketAddr;
use std::path::PathBuf;

use sulcus_program::PathText;

/// Why a server does not start, or has ended badly.
#[derive(Debug, thiserror::Error)]
pub enum ServerError {
    /// The port is taken.
    #[error(
        "cannot listen on {listen}: another program uses this port; stop it or choose another port"
    )]
    PortBusy {
        /// Address asked for.
        listen: SocketAddr,
    },
    /// The address cannot be used.
    #[error("cannot listen on {listen}: {source}")]
    Listen {
        /// Address asked for.
        listen: SocketAddr,
        /// What the system says.
        source: std::io::Error,
    },
    /// The folder of recordings cannot be used.
    #[error("cannot write recordings to {}: {source}", .path.shown())]
    Recordings {
        /// Folder asked for.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// Recordings cannot be signed.
    #[error("cannot sign recordings: {0}")]
    Key(#[from] sulcus_sessions::KeyError),
    /// A value in the configuration makes no sense.
    #[error("{field} is {found}, expected {expected}")]
    Config {
        /// Which value.
        field: &'static str,
        /// Value found.
        found: String,
        /// What it must be.
        expected: &'static str,
    },
    /// Certificate or TLS set-up failed.
    #[error("cannot set up the server's certificate: {0}")]
    Tls(String),
    /// The system refuses a thread, an event or a runtime.
    #[error("cannot start the server: {0}")]
    System(#[from] std::io::Error),
    /// The network thread panicked.
    #[error("the server's network thread ended unexpectedly")]
    Crashed,
}
