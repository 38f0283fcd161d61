//! Configuration of a link.

use std::net::SocketAddr;
use std::time::Duration;

use sulcus_proto::control::DeviceInfo;
use sulcus_proto::{Role, Ticket};

/// Pin of a server's certificate.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Pin {
    /// The whole certificate, DER.
    Certificate(Vec<u8>),
    /// SHA-256 of the certificate in DER.
    Fingerprint([u8; 32]),
}

/// Configuration of a link.
#[derive(Clone, Debug, PartialEq)]
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
    /// Role of the connection. The token's role must permit it.
    pub role: Role,
    /// Name of the station; empty: the station of the token.
    pub station: String,
    /// Haptic device, for the recording; its name has at most 256 bytes.
    pub device: DeviceInfo,
    /// Opaque learner id, never a name; empty: the server's default.
    pub learner: String,
    /// Name of the exercise; empty: the server's exercise.
    pub exercise: String,
    /// Attach epoch of the connection that this one follows; 0 for the first connection of a program.
    pub follows: u32,
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
            role: Role::Student,
            station: String::new(),
            device: DeviceInfo {
                name: device.into(),
                ..DeviceInfo::default()
            },
            learner: String::new(),
            exercise: String::new(),
            follows: 0,
            timeout: Duration::from_secs(5),
        }
    }
}
