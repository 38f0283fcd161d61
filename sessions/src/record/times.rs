//! Durations of ticks while the session ran, from the channels for viewers: a replay does not know them.

use std::collections::BTreeMap;

use mcap::records::op;
use prost::Message as _;

use crate::record::channels::SESSION_METRICS;
use crate::record::channels::v1::SessionMetrics;
use crate::record::read::{ReadError, Recording};
use crate::record::walk;

/// Longest tick since the message before, CPU time of the thread, microseconds, by the number of the message's tick. Empty
/// where the recording has no such channel. Nothing rests on it: a message that cannot be read is left out.
///
/// # Errors
/// When the file is no MCAP, or a chunk changed since the file was opened.
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
