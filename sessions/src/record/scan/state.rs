//! Facts known after a number of pieces of the file, and the gaps between them.

use crate::record::at_hand::divergence;
use crate::record::gap;
use crate::record::gap::Gap;
use crate::record::message::{MAX_TICK, Message};
use crate::record::policy::ViewersPolicy;
use crate::record::read::Facts;
use crate::record::unpack::Topics;
use crate::record::viewers::{Said, Summing};

/// Extent to which a file is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Depth {
    /// Up to the first damage.
    Strict,
    /// Every whole chunk, also behind damage: for a recovery.
    Salvage,
}

/// Facts known after a number of pieces. A piece is accepted as a whole or not at all.
#[derive(Clone, Default)]
pub(super) struct State {
    pub topics: Topics,
    pub facts: Facts,
    pub viewed: Summing,
    /// Tick of the last row or snapshot.
    pub tick: u64,
    /// Messages of the exact channels.
    pub messages: u64,
    /// Gaps so far.
    pub gaps: Vec<Gap>,
    /// Gap that no row or snapshot follows yet.
    open: Option<Gap>,
}

impl State {
    /// No facts, for a recording of this policy.
    pub fn by(policy: ViewersPolicy) -> Self {
        Self {
            viewed: Summing::by(policy),
            ..Self::default()
        }
    }

    /// Accepts a message. `first_gap` is the number of messages before the first gap that a recovery noted.
    ///
    /// # Errors
    /// The message breaks the order of a recording: a text that says how.
    pub fn take(
        &mut self,
        message: &Message,
        depth: Depth,
        first_gap: Option<u64>,
    ) -> Result<(), String> {
        if self.facts.end.is_some() {
            return Err("a message follows the station's last statement".to_owned());
        }
        let salvages = depth == Depth::Salvage;
        if salvages {
            self.close(message);
        }
        self.messages += 1;
        let facts = &mut self.facts;
        match message {
            Message::Row(row) => {
                let behind_gap = match first_gap {
                    _ if salvages => !self.gaps.is_empty(),
                    before => before.is_some_and(|before| before < self.messages),
                };
                if facts.snapshots == 0 && !behind_gap {
                    return Err("the first row comes before the first snapshot".to_owned());
                }
                if row.tick <= self.tick {
                    return Err(format!("tick {} comes after tick {}", row.tick, self.tick));
                }
                self.tick = row.tick;
                facts.rows += 1;
                facts.device_samples += row.device.iter().flatten().count() as u64;
                facts.ticks = Some((facts.ticks.map_or(row.tick, |t| t.0), row.tick));
                let time = row.time_unix_ns;
                facts.times_unix_ns = Some((facts.times_unix_ns.map_or(time, |t| t.0), time));
            }
            Message::Snapshot { tick: of, .. } => {
                if *of < self.tick {
                    return Err(format!(
                        "a snapshot of tick {of} comes after tick {}",
                        self.tick
                    ));
                }
                self.tick = *of;
                facts.snapshots += 1;
            }
            Message::Signed(signed) => {
                facts.signatures += 1;
                facts.end = signed.statement.end;
            }
            Message::Event(event) => match Said::parse(&event.text) {
                Some(said) => facts.viewers = Some(said),
                None => {
                    facts.events += 1;
                    let found = divergence(&event.text);
                    facts.diverged = facts.diverged.take().or(found);
                }
            },
        }
        Ok(())
    }

    /// Opens a gap from byte `from` to byte `to`, or extends the open gap to `to`.
    pub fn open_gap(&mut self, from: usize, to: usize) {
        match &mut self.open {
            Some(open) => open.bytes = (to as u64).saturating_sub(open.at_byte),
            None => {
                self.open = Some(Gap {
                    messages: self.messages,
                    from_tick: self.first_missing(),
                    to_tick: None,
                    bytes: (to - from) as u64,
                    at_byte: from as u64,
                });
            }
        }
    }

    /// Notes an open gap that no exact message follows. Behind the session's end nothing exact is missing.
    pub fn close_at_end(&mut self) {
        let open = self.open.take();
        if let Some(open) = open.filter(|_| self.facts.end.is_none()) {
            self.push(open);
        }
    }

    /// Ends a gap with the first message behind it that has a tick. Finds gaps without damage, too.
    fn close(&mut self, message: &Message) {
        let (last_missing, must_follow) = match message {
            // A tick that the session skipped is not missing.
            Message::Row(row) => (
                row.tick
                    .saturating_sub(1)
                    .saturating_sub(u64::from(row.input.skipped)),
                self.facts.rows + self.facts.snapshots > 0,
            ),
            Message::Snapshot { tick, .. } => (*tick, self.facts.rows > 0),
            // No row follows the last statement, so the statement's own tick is the last missing tick.
            Message::Signed(signed) if signed.statement.end.is_some() && self.open.is_some() => {
                (signed.statement.tick.min(MAX_TICK), self.messages > 0)
            }
            _ => return,
        };
        let open = self.open.take();
        let missing = must_follow && last_missing > self.tick;
        let gap = match open {
            Some(open) => Gap {
                from_tick: open.from_tick.filter(|_| missing),
                to_tick: Some(last_missing).filter(|to| missing || (!must_follow && *to > 0)),
                ..open
            },
            None if missing => Gap {
                messages: self.messages,
                from_tick: self.first_missing(),
                to_tick: Some(last_missing),
                bytes: 0,
                at_byte: 0,
            },
            None => return,
        };
        self.push(gap);
    }

    fn push(&mut self, gap: Gap) {
        if self.gaps.len() < gap::MOST {
            self.gaps.push(gap);
        }
    }

    /// Tick behind the last tick; `None` before the first message.
    fn first_missing(&self) -> Option<u64> {
        (self.messages > 0).then_some(self.tick + 1)
    }
}
