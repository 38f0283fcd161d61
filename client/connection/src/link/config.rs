//! Configuration of a link.

use std::net::SocketAddr;
use std::time::Duration;

use sulcus_proto::Ticket;

/// Pin of a server's certificate.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Pin {
    /// The whole certificate, DER.
    Certificate(Vec<u8>),
    /// SHA-256 of the certificate in DER.
    Fingerprint([u8; 32]),
}

/// Configuration of a link.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LinkConfig {
    /// Address of the server.
    pub server: SocketAddr,
    /// Further addresses of the same server, as a name may have. Each is tried 250 ms after the address before it, or
    /// at once when that one has failed.
    pub others: Vec<SocketAddr>,
    /// Name sent in the TLS handshake. The pin alone decides whether the server is trusted.
    pub server_name: String,
    /// Certificate or fingerprint of the trusted server.
    pub pin: Pin,
    /// Token of the server, at most 256 bytes.
    pub token: String,
    /// Kind of haptic device, for the recording; at most 256 bytes.
    pub device: String,
    /// Opaque learner id, never a name; empty: the server's default.
    pub learner: String,
    /// Name of the exercise; empty: the server's exercise.
    pub exercise: String,
    /// Timeout of the connection at each address, and again of the server's hello.
    pub timeout: Duration,
}

impl LinkConfig {
    /// All addresses, each once, in the order of the attempts.
    pub(super) fn servers(&self) -> Vec<SocketAddr> {
        let mut servers = vec![self.server];
        for other in &self.others {
            if !servers.contains(other) {
                servers.push(*other);
            }
        }
        servers
    }

    /// Configuration for a server's ticket: one address, no learner, the server's exercise, a timeout of 5 s.
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
