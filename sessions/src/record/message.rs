//! The channels of a recording, and what one message of each says.

use serde::{Deserialize, Serialize};

use crate::record::bytes::Cut;
use crate::record::chain::Link;
use crate::record::channels::{Schema, exact};
use crate::record::envelope;
use crate::record::format::Layout;
use crate::record::row::Row;
use crate::record::statement::SignedStatement;

/// Channels that this crate writes and reads. Others in a file are for viewers, and are skipped.
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

    /// Encoding of the messages in this layout.
    pub fn encoding(self, layout: Layout) -> &'static str {
        match (layout, self) {
            (Layout::Protobuf, _) => "protobuf",
            (Layout::Bare, Self::Ticks) => "sulcus-row",
            (Layout::Bare, Self::Snapshots) => "sulcus-state",
            (Layout::Bare, Self::Chain) => "sulcus-chain",
            (Layout::Bare, Self::Events) => "json",
        }
    }

    /// Layout of the messages of a channel of this encoding; `None` where it is none of this topic's.
    pub fn layout(self, encoding: &str) -> Option<Layout> {
        let known = [Layout::Protobuf, Layout::Bare];
        known
            .into_iter()
            .find(|layout| self.encoding(*layout) == encoding)
    }

    /// Schema of the messages in the present layout.
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

/// How much an event matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Level {
    /// Good to know.
    Info,
    /// Something was not as it should be.
    Warning,
    /// Something failed.
    Error,
}

/// A line in the session's log.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Event {
    /// Session clock, nanoseconds since the Unix epoch.
    pub time_unix_ns: u64,
    /// How much it matters.
    pub level: Level,
    /// What happened.
    pub text: String,
}

impl Event {
    pub(crate) fn to_bytes(&self) -> Vec<u8> {
        // Integers and strings always serialise.
        serde_json::to_vec(self).unwrap_or_default()
    }
}

/// A message of one of this crate's channels.
#[derive(Clone, Debug, PartialEq)]
pub enum Message {
    /// A tick.
    Row(Row),
    /// The state after a tick.
    Snapshot {
        /// The tick.
        tick: u64,
        /// Bytes of [`sulcus_core::State`].
        state: Vec<u8>,
    },
    /// A signed head of the chain.
    Signed(SignedStatement),
    /// A line in the log.
    Event(Event),
}

/// Ticks beyond this (nine thousand years) are damage, and would overflow a counter somewhere.
pub(crate) const MAX_TICK: u64 = 1 << 58;

impl Message {
    /// Decodes a message in this layout; `None` when its bytes are not of their kind.
    pub(crate) fn decode(topic: Topic, layout: Layout, bytes: &[u8]) -> Option<Self> {
        let bytes = match layout {
            Layout::Protobuf => envelope::open(bytes)?,
            Layout::Bare => bytes,
        };
        match topic {
            Topic::Ticks => Row::from_bytes(bytes)
                .filter(|row| row.tick <= MAX_TICK)
                .map(Self::Row),
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

    /// What the chain covers of this message: kind, tick and bytes; `None` for what signs it.
    pub(crate) fn chained(&self) -> Option<(Link, Option<u64>, Vec<u8>)> {
        match self {
            Self::Row(row) => Some((Link::Row, Some(row.tick), row.to_bytes().to_vec())),
            Self::Snapshot { tick, state } => {
                let bytes = [&tick.to_le_bytes(), state.as_slice()].concat();
                Some((Link::Snapshot, Some(*tick), bytes))
            }
            Self::Event(event) => Some((Link::Event, None, event.to_bytes())),
            Self::Signed(_) => None,
        }
    }
}
