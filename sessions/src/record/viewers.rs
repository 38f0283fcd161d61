//! Integrity of the channels for viewers.
//!
//! Chain and signatures cover the exact record alone. The channels for viewers (poses, forces, clouds)
//! can be computed again from that record, so a fault in them does not prevent a grade. Yet people look at these
//! channels. So the recorder writes a hash over all of them into the signed log at the end, and a reader compares the
//! hash. The hash covers topics, times, bytes and schemas. Under another schema a force could be shown as a torque.
//!
//! With the policy `on-demand` the recorder makes the same messages and writes only the kept ones. Its line has two
//! hashes: over all messages as they would have been recorded, and over the kept ones. So channels that are made again
//! later are compared with what the station has seen.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::record::policy::ViewersPolicy;

/// First words of the line in the log with the hash. No client can write such a line, because the line of a client
/// begins with one word.
const SAYS: &str = "what viewers read: ";
/// First words of the line where the policy leaves channels out. The first hash covers the channels as they would have
/// been recorded. A former version of this program sees no hash in the line.
const WOULD_SAY: &str = "what viewers would read: ";
/// Text between the two hashes in that line.
const KEPT: &str = "; of these in the recording: ";

/// Text between the number of messages and the hash in that line.
const OVER: &str = " messages with their schemas, blake3 ";

/// Hash over messages in their order, and the number of messages.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Sum {
    blake3: String,
    messages: u64,
}

impl Sum {
    /// Number of messages.
    pub fn messages(&self) -> u64 {
        self.messages
    }

    /// Sum in words.
    fn words(&self) -> String {
        format!("{}{OVER}{}", self.messages, self.blake3)
    }

    /// Sum of such words; `None` for other words.
    fn parse(words: &str) -> Option<Self> {
        let (messages, blake3) = words.split_once(OVER)?;
        Some(Self {
            blake3: blake3.to_owned(),
            messages: messages.parse().ok()?,
        })
    }
}

/// Sums that a station signs, by the policy of the recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Said {
    /// Sum over all channels, in the order of the file.
    Recorded(Sum),
    /// Sums by channel: over all channels as they would have been recorded, and over those in the recording.
    OnDemand { all: Sum, kept: Sum },
}

impl Said {
    /// Line of the log with the sums.
    pub fn line(&self) -> String {
        match self {
            Self::Recorded(sum) => format!("{SAYS}{}", sum.words()),
            Self::OnDemand { all, kept } => {
                format!("{WOULD_SAY}{}{KEPT}{}", all.words(), kept.words())
            }
        }
    }

    /// Sums in a line of the log; `None` for any other line.
    pub fn parse(line: &str) -> Option<Self> {
        if let Some(words) = line.strip_prefix(SAYS) {
            return Sum::parse(words).map(Self::Recorded);
        }
        let (all, kept) = line.strip_prefix(WOULD_SAY)?.split_once(KEPT)?;
        Some(Self::OnDemand {
            all: Sum::parse(all)?,
            kept: Sum::parse(kept)?,
        })
    }

    /// Sum over all channels, recorded or made again.
    pub fn all(&self) -> &Sum {
        match self {
            Self::Recorded(all) | Self::OnDemand { all, .. } => all,
        }
    }
}

/// Whether a line of the log is the sum over the channels for viewers. Such a line is for programs only.
pub fn is_sum(line: &str) -> bool {
    Said::parse(line).is_some()
}

/// Sum over messages for viewers during writing or reading.
///
/// With the policy `recorded` one hash covers all messages in their order. With `on-demand` each channel has a hash,
/// because the exact record does not tell the order of messages of two channels. The sum is then a hash over these, in
/// the order of the channels' own hashes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Summing {
    policy: ViewersPolicy,
    hasher: blake3::Hasher,
    /// Hash over the messages of each channel, by the channel's own hash; empty with the policy `recorded`.
    by_channel: BTreeMap<[u8; 32], blake3::Hasher>,
    messages: u64,
    /// Hash over each schema, by its number.
    schemas: BTreeMap<u16, [u8; 32]>,
    /// Hash over each channel and its schema, by its number.
    channels: BTreeMap<u16, [u8; 32]>,
}

impl Summing {
    /// Sum of no messages, for a recording of this policy.
    pub fn by(policy: ViewersPolicy) -> Self {
        Self {
            policy,
            ..Self::default()
        }
    }

    /// Whether a channel of this number was declared.
    pub fn knows(&self, channel: u16) -> bool {
        self.channels.contains_key(&channel)
    }

    /// Adds the declaration of a schema.
    pub fn schema(&mut self, id: u16, name: &str, encoding: &str, data: &[u8]) {
        let of = digest(&[name.as_bytes(), encoding.as_bytes(), data]);
        let before = self.schemas.insert(id, of);
        self.declared_twice(before.is_some_and(|before| before != of));
    }

    /// Adds the declaration of a channel. Its schema must have been added before; otherwise the channel counts as one
    /// without schema.
    pub fn channel(&mut self, id: u16, schema: u16, topic: &str, encoding: &str) {
        let schema = self.schemas.get(&schema).map_or(&[][..], |of| &of[..]);
        let of = digest(&[topic.as_bytes(), encoding.as_bytes(), schema]);
        let before = self.channels.insert(id, of);
        self.declared_twice(before.is_some_and(|before| before != of));
    }

    /// Adds a message, with both times by which a reader may sort.
    pub fn message(&mut self, channel: u16, times_unix_ns: [u64; 2], bytes: &[u8]) {
        let of = self.channels.get(&channel);
        let hasher = match (self.policy, of) {
            (ViewersPolicy::OnDemand, Some(of)) => self.by_channel.entry(*of).or_default(),
            _ => &mut self.hasher,
        };
        let [logged, published] = times_unix_ns.map(u64::to_le_bytes);
        for part in [of.map_or(&[][..], |of| &of[..]), &logged, &published, bytes] {
            update(hasher, part);
        }
        self.messages += 1;
    }

    /// Marks a number with two meanings. Readers could differ about such a number, and no recorder writes it.
    pub fn declared_twice(&mut self, otherwise: bool) {
        if otherwise {
            update(&mut self.hasher, b"declared twice");
        }
    }

    /// Sum so far.
    pub fn sum(&self) -> Sum {
        let mut hasher = self.hasher.clone();
        for of_channel in self.by_channel.values() {
            update(&mut hasher, of_channel.finalize().as_bytes());
        }
        Sum {
            blake3: hasher.finalize().to_hex().to_string(),
            messages: self.messages,
        }
    }
}

fn update(hasher: &mut blake3::Hasher, part: &[u8]) {
    hasher.update(&(part.len() as u64).to_le_bytes());
    hasher.update(part);
}

fn digest(parts: &[&[u8]]) -> [u8; 32] {
    let mut hasher = blake3::Hasher::new();
    for part in parts {
        update(&mut hasher, part);
    }
    *hasher.finalize().as_bytes()
}

/// State of a recording's channels for viewers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Viewers {
    /// The channels are as the station signed them.
    AsSigned,
    /// The recording has what a replay cannot make, as the station signed it. `sulcus-sessions viewers` makes the rest.
    OnDemand,
    /// The channels differ from the signed sum: damaged or edited. The exact record is judged by itself.
    Changed,
    /// No sum is signed: the recording has no end, or dates from before the sum was introduced.
    NotSigned,
}

impl Viewers {
    /// State by the sum in the log and the sum over the file.
    pub(crate) fn of(said: Option<&Said>, found: &Sum) -> Self {
        match said {
            None => Self::NotSigned,
            Some(said) if said.all() == found => Self::AsSigned,
            Some(Said::OnDemand { kept, .. }) if kept == found => Self::OnDemand,
            Some(_) => Self::Changed,
        }
    }
}

impl std::fmt::Display for Viewers {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::AsSigned => "as the station signed it",
            Self::OnDemand => {
                "not in the recording: `sulcus-sessions viewers FILE --out FILE2` makes a recording with them for Rerun, Foxglove and other readers"
            }
            Self::Changed => {
                "CHANGED: Rerun, Foxglove and other readers show other data of this file than were recorded"
            }
            Self::NotSigned => {
                "not signed (the recording has no valid signature or end, or dates from before this hash)"
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Declarations and messages of a file: schemas (number, name, data), channels (number, schema, topic), messages
    /// (channel, times, bytes).
    type File<'a> = (
        &'a [(u16, &'a str, &'a [u8])],
        &'a [(u16, u16, &'a str)],
        &'a [(u16, [u64; 2], &'a [u8])],
    );

    fn sum((schemas, channels, messages): File<'_>) -> Sum {
        let mut summing = Summing::default();
        for (id, name, data) in schemas {
            summing.schema(*id, name, "protobuf", data);
        }
        for (id, schema, topic) in channels {
            summing.channel(*id, *schema, topic, "protobuf");
        }
        for (channel, times, bytes) in messages {
            summing.message(*channel, *times, bytes);
        }
        summing.sum()
    }

    #[test]
    fn any_change_of_topic_schema_time_bytes_or_order_changes_the_sum() {
        let schemas = &[(1, "A", &b"a"[..]), (2, "B", b"b")][..];
        let channels = &[(1, 1, "/a"), (2, 2, "/b")][..];
        let messages = &[(1, [5, 5], &b"xy"[..]), (2, [5, 5], b"z")][..];
        let whole = sum((schemas, channels, messages));
        assert_eq!(whole, sum((schemas, channels, messages)));
        // Other numbers for the same channels, and repeated declarations as in a file's summary, change nothing.
        let again = &[(7, 1, "/a"), (2, 2, "/b"), (7, 1, "/a")][..];
        let renamed = &[(7, [5, 5], &b"xy"[..]), (2, [5, 5], b"z")][..];
        assert_eq!(whole, sum((schemas, again, renamed)));
        for other in [
            &[(2, [5, 5], &b"z"[..]), (1, [5, 5], b"xy")][..],
            &[(1, [5, 5], b"xy")],
            &[(1, [6, 5], b"xy"), (2, [5, 5], b"z")],
            &[(1, [5, 6], b"xy"), (2, [5, 5], b"z")],
            &[(2, [5, 5], b"xy"), (2, [5, 5], b"z")],
            &[(1, [5, 5], b"x"), (2, [5, 5], b"yz")],
        ] {
            assert_ne!(whole, sum((schemas, channels, other)));
        }
        for other in [
            &[(1, 1, "/a"), (2, 2, "/c")][..],
            &[(1, 1, "/a"), (2, 1, "/b")],
            &[(1, 1, "/a"), (2, 0, "/b")],
            // The last declaration equals the first, and a declaration between them differs.
            &[(1, 1, "/a"), (2, 2, "/b"), (1, 2, "/b"), (1, 1, "/a")],
        ] {
            assert_ne!(whole, sum((schemas, other, messages)));
        }
        for other in [
            &[(1, "A", &b"a"[..]), (2, "B", b"c")][..],
            &[(1, "A", b"a"), (2, "C", b"b")],
            &[
                (1, "A", b"a"),
                (2, "B", b"b"),
                (2, "B", b"c"),
                (2, "B", b"b"),
            ],
        ] {
            assert_ne!(whole, sum((other, channels, messages)));
        }
    }

    #[test]
    fn a_line_of_the_log_says_the_sum() {
        let whole = sum((&[], &[], &[(1, [5, 5], b"xy")]));
        let nothing = Summing::default().sum();
        let recorded = Said::Recorded(whole.clone());
        let on_demand = Said::OnDemand {
            all: whole.clone(),
            kept: nothing.clone(),
        };
        for said in [&recorded, &on_demand] {
            assert_eq!(Said::parse(&said.line()).as_ref(), Some(said));
            assert!(is_sum(&said.line()));
        }
        assert_eq!(Said::parse("session ended"), None);
        assert_eq!(Viewers::of(None, &whole), Viewers::NotSigned);
        assert_eq!(Viewers::of(Some(&recorded), &whole), Viewers::AsSigned);
        assert_eq!(Viewers::of(Some(&recorded), &nothing), Viewers::Changed);
        assert_eq!(Viewers::of(Some(&on_demand), &whole), Viewers::AsSigned);
        assert_eq!(Viewers::of(Some(&on_demand), &nothing), Viewers::OnDemand);
        let other = sum((&[], &[], &[(1, [5, 6], b"xy")]));
        assert_eq!(Viewers::of(Some(&on_demand), &other), Viewers::Changed);
    }

    #[test]
    fn on_demand_the_order_of_two_channels_does_not_count() {
        let of = |messages: &[(u16, u64, &[u8])]| {
            let mut summing = Summing::by(ViewersPolicy::OnDemand);
            for id in [1, 2] {
                summing.schema(id, "A", "protobuf", b"a");
                summing.channel(id, id, &format!("/{id}"), "protobuf");
            }
            for (channel, time, bytes) in messages {
                summing.message(*channel, [*time; 2], bytes);
            }
            summing.sum()
        };
        let one = of(&[(1, 5, b"x"), (1, 6, b"y"), (2, 5, b"z")]);
        assert_eq!(one, of(&[(2, 5, b"z"), (1, 5, b"x"), (1, 6, b"y")]));
        for other in [
            &[(1, 6, &b"y"[..]), (1, 5, b"x"), (2, 5, b"z")][..],
            &[(1, 5, b"x"), (1, 6, b"y"), (1, 5, b"z")],
            &[(1, 5, b"x"), (2, 6, b"y"), (2, 5, b"z")],
            &[(1, 5, b"x"), (1, 6, b"y")],
        ] {
            assert_ne!(one, of(other));
        }
    }
}
