//! What a link is told before it connects.

use std::net::SocketAddr;
use std::time::Duration;

use sulcus_proto::Ticket;

/// How the server is recognised.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Pin {
    /// By its whole certificate, DER.
    Certificate(Vec<u8>),
    /// By the SHA-256 of its certificate.
    Fingerprint([u8; 32]),
}

/// Everything a link is told.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LinkConfig {
    /// Where the server listens.
    pub server: SocketAddr,
    /// Further addresses of the same server, as a name may have; tried when the first does not answer at once.
    pub others: Vec<SocketAddr>,
    /// Name sent in the TLS handshake; the pin decides, not the name.
    pub server_name: String,
    /// How the server is recognised.
    pub pin: Pin,
    /// The server's token.
    pub token: String,
    /// Kind of haptic device, for the record.
    pub device: String,
    /// Opaque learner id, never a name; may be empty.
    pub learner: String,
    /// Exercise asked for; empty: the server's choice.
    pub exercise: String,
    /// How long to wait for an answer at each address.
    pub timeout: Duration,
}

impl LinkConfig {
    /// All addresses to try, each once.
    pub(super) fn servers(&self) -> Vec<SocketAddr> {
        let mut servers = vec![self.server];
        for other in &self.others {
            if !servers.contains(other) {
                servers.push(*other);
            }
        }
        servers
    }

    /// Joins with a server's ticket; five seconds to answer.
    pub fn new(server: SocketAddr, ticket: &Ticket, device: &str) -> Self {
        Self {
            server,
            others: Vec::new(),
            server_name: "localhost".into(),
            pin: Pin::Fingerprint(ticket.fingerprint),
            token: ticket.token.clone(),
            device: device.into(),
            learner: String::new(),
            exercise: String::new(),
            timeout: Duration::from_secs(5),
        }
    }
}
