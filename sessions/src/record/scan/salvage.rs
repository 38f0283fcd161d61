//! Reading on behind damage: the next whole chunk is looked for, byte by byte, and every gap is noted.

use mcap::records::op;

use super::pass::{Pass, State};
use super::unpack::exact;
use crate::record::gap;
use crate::record::gap::Gap;
use crate::record::message::{MAX_TICK, Message, Topic};
use crate::record::read::{ReadError, Recording};
use crate::record::verify::Verifier;
use crate::record::walk;
use crate::record::walk::{Framed, Walk};

/// Bounds the work on what looks like chunks and is none: bytes that are made such could cost the square of their length.
pub(super) struct Budget(usize);

impl Budget {
    pub fn new(walk: &Walk<'_>) -> Self {
        Self(walk.length().saturating_mul(16).saturating_add(64 << 20))
    }

    /// Whether so much more may be spent.
    fn spend(&mut self, bytes: usize) -> bool {
        let left = self.0.checked_sub(bytes);
        self.0 = left.unwrap_or(0);
        left.is_some()
    }
}

impl Pass<'_> {
    /// Goes to the next place behind the present one at which a whole chunk begins, or a row outside of chunks, and notes the gap;
    /// `false` where there is none.
    pub fn resume(&mut self, walk: &mut Walk<'_>, budget: &mut Budget) -> bool {
        self.learn_from_summary(walk);
        let from = walk.at;
        for at in from + 1..walk.length() {
            let opcode = walk.opcode_at(at);
            if !(opcode == Some(op::CHUNK) || (self.loose && opcode == Some(op::MESSAGE))) {
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
                    return false;
                }
                walk::unpack(&record, |_, _| Ok(())).is_ok()
            } else {
                self.is_next_row(&record)
            };
            if found {
                walk.at = at;
                self.open_gap(from, at);
                return true;
            }
        }
        false
    }

    /// Whether a record outside of chunks is a row that may come next.
    fn is_next_row(&self, record: &Framed<'_>) -> bool {
        let Some((id, times, bytes)) = walk::message(record.body) else {
            return false;
        };
        let Some(Some((topic @ Topic::Ticks, layout))) = self.state.topics.get(&id) else {
            return false;
        };
        match exact(*topic, *layout, times[0], bytes) {
            Ok(Message::Row(row)) => row.tick > self.state.tick,
            _ => false,
        }
    }

    fn open_gap(&mut self, from: usize, to: usize) {
        let state = &mut self.state;
        let bytes = (to - from) as u64;
        match &mut state.open {
            Some(open) => open.bytes = (to as u64).saturating_sub(open.at_byte),
            None => {
                state.open = Some(Gap {
                    messages: state.messages,
                    from_tick: first_missing(state),
                    to_tick: None,
                    bytes,
                    at_byte: from as u64,
                });
            }
        }
    }

    /// Notes a gap behind which nothing exact follows.
    pub fn close_at_end(&mut self) {
        let state = &mut self.state;
        let open = state.open.take();
        // Behind the session's end nothing exact is missing.
        if let Some(open) = open.filter(|_| state.facts.end.is_none()) {
            push(state, open);
        }
    }
}

/// The tick behind the last one, where there is one.
fn first_missing(state: &State) -> Option<u64> {
    (state.messages > 0).then_some(state.tick + 1)
}

/// Ends a gap with the first message behind it that has a tick; finds gaps that no damage explains.
pub(super) fn close(message: &Message, state: &mut State) {
    let (last_missing, must_follow) = match message {
        // A tick that the session itself skipped is not missing.
        Message::Row(row) => (
            row.tick
                .saturating_sub(1)
                .saturating_sub(u64::from(row.input.skipped)),
            state.facts.rows + state.facts.snapshots > 0,
        ),
        Message::Snapshot { tick, .. } => (*tick, state.facts.rows > 0),
        // Nothing follows the last statement: what is missing before it is known from the tick that it covers.
        Message::Signed(signed) if signed.statement.end.is_some() && state.open.is_some() => {
            (signed.statement.tick.min(MAX_TICK), state.messages > 0)
        }
        _ => return,
    };
    let open = state.open.take();
    let missing = must_follow && last_missing > state.tick;
    let gap = match open {
        Some(open) => Gap {
            from_tick: open.from_tick.filter(|_| missing),
            to_tick: Some(last_missing).filter(|to| missing || (!must_follow && *to > 0)),
            ..open
        },
        None if missing => Gap {
            messages: state.messages,
            from_tick: first_missing(state),
            to_tick: Some(last_missing),
            bytes: 0,
            at_byte: 0,
        },
        None => return,
    };
    push(state, gap);
}

fn push(state: &mut State, gap: Gap) {
    if state.gaps.len() < gap::MOST {
        state.gaps.push(gap);
    }
}

/// The gaps of a recording that was recovered before and is damaged again: those that were found now, and of the former ones what the
/// ticks alone do not show.
pub(super) fn with_former(mut found: Vec<Gap>, former: Vec<Gap>, messages: u64) -> Vec<Gap> {
    for old in former {
        if old.from_tick.is_none() && found.len() < gap::MOST {
            // Its bytes are of another file.
            found.push(Gap {
                messages: old.messages.min(messages),
                bytes: 0,
                at_byte: 0,
                ..old
            });
        }
    }
    found.sort_by_key(|gap| gap.messages);
    found
}

/// Forgets the gaps at which nothing exact is missing: the chain goes on over them to a signed statement.
pub(super) fn forget_bridged_gaps(recording: &mut Recording) -> Result<(), ReadError> {
    let bridged = {
        let mut verifier = Verifier::new(recording);
        for message in recording.messages() {
            verifier.message(&message?);
        }
        verifier.bridged_gaps().to_vec()
    };
    let mut k = 0;
    recording.gaps.retain(|_| {
        k += 1;
        !bridged.contains(&(k - 1))
    });
    Ok(())
}
