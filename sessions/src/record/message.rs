//! Exact channels of a recording, and their messages.

use serde::{Deserialize, Serialize};

use crate::record::bytes::Cut;
use crate::record::chain::Link;
use crate::record::envelope;
use crate::record::format::Layout;
use crate::record::row::Row;
use crate::record::schema::{Schema, exact};
use crate::record::statement::SignedStatement;

/// Exact channels, which this crate writes and reads. Other channels are for viewers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Topic {
    Ticks,
    Snapshots,
    Chain,
    Events,
}

impl Topic {
    pub const ALL: [Self; 4] = [Self::Ticks, Self::Snapshots, Self::Chain, Self::Events];

    pub fn name(self) -> &'static str {
        match self {
            Self::Ticks => "/exact/ticks",
            Self::Snapshots => "/exact/snapshots",
            Self::Chain => "/exact/chain",
            Self::Events => "/events",
        }
    }

    /// Encoding of the topic's messages in a layout.
    pub fn encoding(self, layout: Layout) -> &'static str {
        match (layout, self) {
            (Layout::Protobuf, _) => "protobuf",
            (Layout::Bare, Self::Ticks) => "sulcus-row",
            (Layout::Bare, Self::Snapshots) => "sulcus-state",
            (Layout::Bare, Self::Chain) => "sulcus-chain",
            (Layout::Bare, Self::Events) => "json",
        }
    }

    /// Layout of a channel with this encoding; `None` for an encoding that the topic never has.
    pub fn layout(self, encoding: &str) -> Option<Layout> {
        let known = [Layout::Protobuf, Layout::Bare];
        known
            .into_iter()
            .find(|layout| self.encoding(*layout) == encoding)
    }

    /// Schema of the topic's messages in the present layout.
    pub fn schema(self) -> Schema {
        match self {
            Self::Ticks => exact::ROW,
            Self::Snapshots => exact::STATE,
            Self::Chain => exact::STATEMENT,
            Self::Events => exact::EVENT,
        }
    }

    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|topic| topic.name() == name)
    }
}

/// Importance of an event.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Level {
    /// Information.
    Info,
    /// A deviation from the expected course.
    Warning,
    /// A failure.
    Error,
}

/// Line in the session's log.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Event {
    /// Session clock, nanoseconds since the Unix epoch.
    pub time_unix_ns: u64,
    /// Importance.
    pub level: Level,
    /// Text of the line.
    pub text: String,
}

impl Event {
    pub(crate) fn to_bytes(&self) -> Vec<u8> {
        // Integers and strings always serialise.
        serde_json::to_vec(self).unwrap_or_default()
    }
}

/// Message of an exact channel.
#[derive(Clone, Debug, PartialEq)]
pub enum Message {
    /// Row of a tick.
    Row(Row),
    /// State after a tick.
    Snapshot {
        /// Number of the tick.
        tick: u64,
        /// Bytes of [`sulcus_core::State`].
        state: Vec<u8>,
    },
    /// Signed head of the chain.
    Signed(SignedStatement),
    /// Line in the log.
    Event(Event),
}

/// Largest valid tick: nine thousand years at 1 kHz. A larger number is damage and could overflow a counter.
pub(crate) const MAX_TICK: u64 = 1 << 58;

impl Message {
    /// Decodes a message of this layout; `None` for invalid bytes.
    pub(crate) fn decode(topic: Topic, layout: Layout, bytes: &[u8]) -> Option<Self> {
        if topic == Topic::Ticks {
            let row = match layout {
                Layout::Protobuf => envelope::open_row(bytes),
                Layout::Bare => Row::from_bytes(bytes),
            };
            return row.filter(|row| row.tick <= MAX_TICK).map(Self::Row);
        }
        let bytes = match layout {
            Layout::Protobuf => envelope::open(bytes)?,
            Layout::Bare => bytes,
        };
        match topic {
            Topic::Ticks => None,
            Topic::Snapshots => {
                let mut cut = Cut(bytes);
                let tick = cut.u64().filter(|tick| *tick <= MAX_TICK)?;
                Some(Self::Snapshot {
                    tick,
                    state: cut.0.to_vec(),
                })
            }
            Topic::Chain => SignedStatement::from_bytes(bytes).map(Self::Signed),
            Topic::Events => serde_json::from_slice(bytes).ok().map(Self::Event),
        }
    }

    /// Part of the message that the chain covers: kind, tick and bytes; `None` for a signed statement.
    pub(crate) fn chained(&self) -> Option<(Link, Option<u64>, Vec<u8>)> {
        match self {
            Self::Row(row) => {
                let mut bytes = Vec::with_capacity(Row::BYTES);
                row.chained(&mut bytes);
                Some((Link::Row, Some(row.tick), bytes))
            }
            Self::Snapshot { tick, state } => {
                let bytes = [&tick.to_le_bytes(), state.as_slice()].concat();
                Some((Link::Snapshot, Some(*tick), bytes))
            }
            Self::Event(event) => Some((Link::Event, None, event.to_bytes())),
            Self::Signed(_) => None,
        }
    }
}
