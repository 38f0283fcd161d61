//! Errors of a server.

use std::net::SocketAddr;
use std::path::PathBuf;

use sulcus_program::PathText;

/// Error that keeps a server from starting, or ends it.
#[derive(Debug, thiserror::Error)]
pub enum ServerError {
    /// Another socket is bound to the port.
    #[error(
        "cannot listen on {listen}: another program uses this UDP port; stop it, or choose another port with --listen"
    )]
    PortBusy {
        /// Address asked for.
        listen: SocketAddr,
    },
    /// The system refuses the address for any other reason.
    #[error(
        "cannot listen on {listen}: {source}; choose an address of this machine and a permitted port"
    )]
    Listen {
        /// Address asked for.
        listen: SocketAddr,
        /// Error of the system.
        source: std::io::Error,
    },
    /// The address of the metrics cannot be used.
    #[error("cannot serve metrics: {source}; choose another address with --metrics")]
    Metrics {
        /// Error of the system.
        source: std::io::Error,
    },
    /// The folder of recordings does not exist and cannot be created.
    #[error("cannot create the folder for recordings {}: {source}", .path.shown())]
    Recordings {
        /// Folder asked for.
        path: PathBuf,
        /// Error of the system.
        source: std::io::Error,
    },
    /// The key that signs recordings cannot be read or created.
    #[error("cannot sign recordings: {0}")]
    Key(#[from] sulcus_sessions::KeyError),
    /// A value of the configuration is out of its range.
    #[error("{field} is {found}, expected {expected}")]
    Config {
        /// Name of the value, for people.
        field: &'static str,
        /// Value found.
        found: String,
        /// Range of the value.
        expected: &'static str,
    },
    /// The certificate cannot be made, or TLS or QUIC cannot be configured.
    #[error("cannot set up certificate and TLS of the server: {0}")]
    Tls(String),
    /// The system refuses a thread, a socket's registration, random numbers or a runtime.
    #[error("cannot start the server: {0}")]
    System(#[from] std::io::Error),
    /// The network thread panicked.
    #[error("the server's network thread ended unexpectedly")]
    Crashed,
}
