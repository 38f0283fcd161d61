//! Measurement of the path to a server: round trip, its variation and losses, without a session.
//!
//! The client connects, sends datagrams like those of a session at a quarter of its rate, and says no hello. QUIC
//! acknowledges them. The server ignores the datagrams and closes the connection of a client without a hello later than
//! the measurement ends.

use std::time::Duration;

use quinn::Connection;
use sulcus_proto::PoseDatagram;

use super::{LinkConfig, LinkError, reach};

/// Length of the measurement.
const LENGTH: Duration = Duration::from_secs(3);
/// Interval between two datagrams.
const PACE: Duration = Duration::from_millis(4);
/// Number of datagrams of a short measurement.
const PROBES: u32 = 50;
/// Part of the measurement before the first sample, in which the round trip settles.
const SETTLES: Duration = Duration::from_millis(300);

/// Figures of a path.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct PathFigures {
    /// Median of the smoothed round trip, milliseconds.
    pub rtt_ms: f64,
    /// Difference between the largest and the least smoothed round trip, milliseconds.
    pub variation_ms: f64,
    /// Share of the packets that were lost, 0 to 1.
    pub lost_share: f64,
    /// Number of packets sent.
    pub packets: u64,
}

/// Least smoothed round trip of a connection without a hello, in 0.2 s: packets of a handshake wait for cryptography,
/// and on a busy machine for a core.
pub(super) async fn least_rtt(connection: &Connection) -> Result<Duration, LinkError> {
    let datagram = PoseDatagram::default().to_bytes()?;
    let mut interval = tokio::time::interval(PACE);
    let mut least = connection.rtt();
    for _ in 0..PROBES {
        interval.tick().await;
        connection
            .send_datagram(datagram.to_vec().into())
            .map_err(|error| LinkError::Lost(error.to_string()))?;
        least = least.min(connection.rtt());
    }
    Ok(least)
}

/// Measures the path to the server of `config`, for three seconds.
///
/// # Errors
/// The server does not answer, or has another certificate.
pub fn measure_path(config: &LinkConfig) -> Result<PathFigures, LinkError> {
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build()?;
    runtime.block_on(measure(config))
}

async fn measure(config: &LinkConfig) -> Result<PathFigures, LinkError> {
    let (endpoint, connection) = reach::reach(config).await?;
    let before = connection.stats().path;
    let datagram = PoseDatagram::default().to_bytes()?;
    let mut interval = tokio::time::interval(PACE);
    let begun = tokio::time::Instant::now();
    let mut trips: Vec<f64> = Vec::new();
    while begun.elapsed() < LENGTH {
        interval.tick().await;
        connection
            .send_datagram(datagram.to_vec().into())
            .map_err(|error| LinkError::Lost(error.to_string()))?;
        if begun.elapsed() >= SETTLES {
            trips.push(connection.rtt().as_secs_f64() * 1e3);
        }
    }
    // Losses are known a round trip and some milliseconds later.
    tokio::time::sleep(connection.rtt() * 2).await;
    let after = connection.stats().path;
    connection.close(0u32.into(), b"measured");
    let _ = tokio::time::timeout(super::LAST_PACKETS, endpoint.wait_idle()).await;
    trips.sort_by(f64::total_cmp);
    let packets = after.sent_packets - before.sent_packets;
    let lost = after.lost_packets - before.lost_packets;
    let [least, most] = [trips.first(), trips.last()].map(|trip| trip.copied().unwrap_or(0.0));
    Ok(PathFigures {
        rtt_ms: trips.get(trips.len() / 2).copied().unwrap_or(0.0),
        variation_ms: most - least,
        lost_share: lost as f64 / packets.max(1) as f64,
        packets,
    })
}
