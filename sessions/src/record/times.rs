//! Durations of ticks during the session, from the channels for viewers. A replay does not have them.

use std::collections::BTreeMap;

use mcap::records::op;
use prost::Message as _;

use crate::record::channels::topics::SESSION_METRICS;
use crate::record::channels::v1::SessionMetrics;
use crate::record::read::{ReadError, Recording};
use crate::record::walk;

/// Longest tick since the previous message, CPU time of the thread, microseconds, by the tick of the message. Empty
/// without that channel. Only displays use these numbers, so a message that cannot be decoded is left out.
///
/// # Errors
/// The file is no MCAP, or a chunk has changed since the file was opened.
pub fn longest_tick_us(recording: &Recording) -> Result<BTreeMap<u64, f64>, ReadError> {
    let (mut times, mut ours) = (BTreeMap::new(), None);
    for piece in &recording.pieces {
        walk::visit(&recording.bytes[piece.clone()], |opcode, body| {
            match opcode {
                op::CHANNEL => {
                    let named = walk::channel(body);
                    ours = named
                        .filter(|(_, _, topic, _)| *topic == SESSION_METRICS)
                        .map_or(ours, |(id, ..)| Some(id));
                }
                op::MESSAGE => {
                    let message = walk::message(body);
                    let metrics = message
                        .filter(|(id, ..)| Some(*id) == ours)
                        .and_then(|(_, _, bytes)| SessionMetrics::decode(bytes).ok());
                    times.extend(metrics.map(|m| (m.tick, f64::from(m.longest_tick_us))));
                }
                _ => {}
            }
            Ok(())
        })
        .map_err(|what| ReadError::Changed { what })?;
    }
    Ok(times)
}
