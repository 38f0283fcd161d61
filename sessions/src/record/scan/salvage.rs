//! Search for the next whole chunk behind damage, byte by byte.

use mcap::records::op;

use super::state::State;
use crate::record::message::{Message, Topic};
use crate::record::unpack::exact;
use crate::record::walk;
use crate::record::walk::{Framed, Walk};

/// Bound on the work for bytes that look like chunks. Crafted bytes could otherwise cost the square of their length.
pub(super) struct Budget(usize);

impl Budget {
    pub fn new(walk: &Walk<'_>) -> Self {
        Self(walk.length().saturating_mul(16).saturating_add(64 << 20))
    }

    /// Whether this many bytes more are within the budget.
    fn spend(&mut self, bytes: usize) -> bool {
        let left = self.0.checked_sub(bytes);
        self.0 = left.unwrap_or(0);
        left.is_some()
    }
}

/// Next byte behind the present position at which a whole chunk begins; `None` if there is no such byte.
/// With `loose`, a row outside of chunks counts, too.
pub(super) fn next_whole(
    walk: &Walk<'_>,
    state: &State,
    loose: bool,
    budget: &mut Budget,
) -> Option<usize> {
    for at in walk.at + 1..walk.length() {
        let opcode = walk.opcode_at(at);
        if !(opcode == Some(op::CHUNK) || (loose && opcode == Some(op::MESSAGE))) {
            continue;
        }
        let Ok(record) = walk.peek_at(at) else {
            continue;
        };
        let found = if record.opcode == op::CHUNK {
            let Some(cost) = walk::chunk_cost(record.body) else {
                continue;
            };
            if !budget.spend(cost) {
                return None;
            }
            walk::unpack(&record, |_, _| Ok(())).is_ok()
        } else {
            is_next_row(&record, state)
        };
        if found {
            return Some(at);
        }
    }
    None
}

/// Whether a record outside of chunks is a row behind the last tick.
fn is_next_row(record: &Framed<'_>, state: &State) -> bool {
    let Some((id, times, bytes)) = walk::message(record.body) else {
        return false;
    };
    let Some(Some((topic @ Topic::Ticks, layout))) = state.topics.get(&id) else {
        return false;
    };
    match exact(*topic, *layout, times[0], bytes) {
        Ok(Message::Row(row)) => row.tick > state.tick,
        _ => false,
    }
}
