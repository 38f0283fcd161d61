//! Whether what viewers read is what was recorded.
//!
//! The chain and its signatures are over the exact record alone. What viewers read beside it (poses, forces and clouds as
//! protobuf) can be made again from that, and a fault in it costs nobody a grade; yet it is what people look at. So the recorder
//! writes a hash over all of it into the signed log at the end, and whoever reads the file compares.

use std::collections::BTreeMap;

use serde::Serialize;

/// How the line in the log begins that holds the hash. (No client can write such a line: theirs begin with one word.)
const SAYS: &str = "what viewers read: ";

/// A hash over messages in their order, and how many there are.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Sum {
    blake3: String,
    messages: u64,
}

impl Sum {
    /// The line of the log that says so.
    pub fn line(&self) -> String {
        format!("{SAYS}{} messages, blake3 {}", self.messages, self.blake3)
    }

    /// What such a line says; none for any other.
    pub fn parse(line: &str) -> Option<Self> {
        let (messages, blake3) = line.strip_prefix(SAYS)?.split_once(" messages, blake3 ")?;
        Some(Self {
            blake3: blake3.to_owned(),
            messages: messages.parse().ok()?,
        })
    }
}

/// Sums up messages for viewers as they are written or read.
#[derive(Clone, Debug, Default)]
pub(crate) struct Summing {
    hasher: blake3::Hasher,
    messages: u64,
    topics: BTreeMap<u16, String>,
}

impl Summing {
    /// Learns which topic a channel is.
    pub fn channel(&mut self, id: u16, topic: &str) {
        self.topics.insert(id, topic.to_owned());
    }

    /// Takes in a message.
    pub fn message(&mut self, channel: u16, time_unix_ns: u64, bytes: &[u8]) {
        let topic = self.topics.get(&channel).map_or("", String::as_str);
        for part in [topic.as_bytes(), &time_unix_ns.to_le_bytes(), bytes] {
            self.hasher.update(&(part.len() as u64).to_le_bytes());
            self.hasher.update(part);
        }
        self.messages += 1;
    }

    /// What came so far.
    pub fn sum(&self) -> Sum {
        Sum {
            blake3: self.hasher.finalize().to_hex().to_string(),
            messages: self.messages,
        }
    }
}

/// What of a recording viewers read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Viewers {
    /// It is what the station wrote.
    AsSigned,
    /// It is not: damaged, or edited. The exact record is judged by itself.
    Changed,
    /// Nobody vouches for it: the recording has no end, or is of a former version.
    NotSigned,
}

impl Viewers {
    /// From what the log says and what is there.
    pub(crate) fn of(said: Option<&Sum>, found: &Sum) -> Self {
        match said {
            None => Self::NotSigned,
            Some(said) if said == found => Self::AsSigned,
            Some(_) => Self::Changed,
        }
    }
}

impl std::fmt::Display for Viewers {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::AsSigned => "as the station signed it",
            Self::Changed => {
                "CHANGED: what Rerun, Foxglove and other readers show of this file is not what was recorded"
            }
            Self::NotSigned => {
                "not signed (the recording has no valid signature or end, or is of a former version)"
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_change_of_topic_time_bytes_or_order_changes_the_sum() {
        let sum = |messages: &[(u16, u64, &[u8])]| {
            let mut summing = Summing::default();
            summing.channel(1, "/a");
            summing.channel(2, "/b");
            for (channel, time, bytes) in messages {
                summing.message(*channel, *time, bytes);
            }
            summing.sum()
        };
        let whole = sum(&[(1, 5, b"xy"), (2, 5, b"z")]);
        assert_eq!(whole, sum(&[(1, 5, b"xy"), (2, 5, b"z")]));
        for other in [
            &[(2, 5, &b"z"[..]), (1, 5, b"xy")][..],
            &[(1, 5, b"xy")],
            &[(1, 6, b"xy"), (2, 5, b"z")],
            &[(2, 5, b"xy"), (2, 5, b"z")],
            &[(1, 5, b"x"), (2, 5, b"yz")],
        ] {
            assert_ne!(whole, sum(other));
        }
        assert_eq!(Sum::parse(&whole.line()), Some(whole.clone()));
        assert_eq!(Sum::parse("session ended"), None);
        let nothing = Summing::default().sum();
        assert_eq!(Viewers::of(None, &whole), Viewers::NotSigned);
        assert_eq!(Viewers::of(Some(&whole), &whole), Viewers::AsSigned);
        assert_eq!(Viewers::of(Some(&whole), &nothing), Viewers::Changed);
    }
}
