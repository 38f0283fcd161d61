//! Configuration of a link.

use std::net::SocketAddr;
use std::time::Duration;

use sulcus_proto::control::DeviceInfo;
use sulcus_proto::{Role, Ticket};

use crate::at_hand::TickPlace;

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
    /// Haptic devices, in the order of the tool slots: at most two. The server records them, and takes their stiffest
    /// couplings into account.
    pub devices: Vec<DeviceInfo>,
    /// Opaque learner id, never a name; empty: the server's default.
    pub learner: String,
    /// Name of the exercise; empty: the server's exercise.
    pub exercise: String,
    /// Attach epoch of the connection that this one follows; 0 for the first connection of a program.
    pub follows: u32,
    /// Place of the ticks that the client asks for.
    pub tick: TickPlace,
    /// BLAKE3 hash of the compiled scene that the client has, for ticks at the hand; zeros without a scene.
    pub scene_hash: [u8; 32],
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
    ///
    /// `device` is the name of the device of both hands ([`LinkConfig::in_both_hands`]); empty for no device.
    pub fn new(server: SocketAddr, ticket: &Ticket, device: &str) -> Self {
        Self {
            server,
            others: Vec::new(),
            server_name: "localhost".into(),
            pin: Pin::Fingerprint(ticket.fingerprint),
            token: ticket.token.clone(),
            role: Role::Student,
            station: String::new(),
            devices: Self::in_both_hands(device),
            learner: String::new(),
            exercise: String::new(),
            follows: 0,
            tick: TickPlace::Server,
            scene_hash: [0; 32],
            timeout: Duration::from_secs(5),
        }
    }

    /// Description of a device without a model file, in both hands: the devices `simulated` and `mouse` by their axes,
    /// any other device by its name alone. An empty name is no device.
    pub fn in_both_hands(device: &str) -> Vec<DeviceInfo> {
        if device.is_empty() {
            return Vec::new();
        }
        let (library, axes) = match device {
            "simulated" => (device, 3),
            "mouse" => (device, 0),
            _ => ("", 0),
        };
        let info = DeviceInfo {
            library: library.to_owned(),
            motion_axes: if library.is_empty() { 0 } else { 6 },
            force_axes: axes,
            torque_axes: axes,
            ..DeviceInfo::named(device)
        };
        vec![info.clone(), info]
    }
}
