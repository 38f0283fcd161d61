//! Whether what viewers read is what was recorded.
//!
//! The chain and its signatures are over the exact record alone. What viewers read beside it (poses, forces and clouds as
//! protobuf) can be made again from that, and a fault in it costs nobody a grade; yet it is what people look at. So the recorder
//! writes a hash over all of it into the signed log at the end, and whoever reads the file compares: topics, times and bytes,
//! and the schemas by which others make sense of the bytes (under another one a force may be read where a torque was written).

use std::collections::BTreeMap;

use serde::Serialize;

/// How the line in the log begins that holds the hash. (No client can write such a line: theirs begin with one word.)
const SAYS: &str = "what viewers read: ";

/// What stands in that line before the hash.
const OVER: &str = " messages with their schemas, blake3 ";

/// A hash over messages in their order, and how many there are.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Sum {
    blake3: String,
    messages: u64,
}

impl Sum {
    /// The line of the log that says so.
    pub fn line(&self) -> String {
        format!("{SAYS}{}{OVER}{}", self.messages, self.blake3)
    }

    /// What such a line says; none for any other.
    pub fn parse(line: &str) -> Option<Self> {
        let (messages, blake3) = line.strip_prefix(SAYS)?.split_once(OVER)?;
        Some(Self {
            blake3: blake3.to_owned(),
            messages: messages.parse().ok()?,
        })
    }
}

/// Whether a line of the log is the sum over the messages for viewers, which no person needs to read.
pub fn is_sum(line: &str) -> bool {
    Sum::parse(line).is_some()
}

/// Sums up messages for viewers as they are written or read.
#[derive(Clone, Debug, Default)]
pub(crate) struct Summing {
    hasher: blake3::Hasher,
    messages: u64,
    /// A hash over each schema, by its number.
    schemas: BTreeMap<u16, [u8; 32]>,
    /// A hash over each channel and its schema, by its number.
    channels: BTreeMap<u16, [u8; 32]>,
}

impl Summing {
    /// Learns what a schema is.
    pub fn schema(&mut self, id: u16, name: &str, encoding: &str, data: &[u8]) {
        let of = digest(&[name.as_bytes(), encoding.as_bytes(), data]);
        let before = self.schemas.insert(id, of);
        self.declared_twice(before.is_some_and(|before| before != of));
    }

    /// Learns what a channel is; its schema comes before it (none of that number: it has none).
    pub fn channel(&mut self, id: u16, schema: u16, topic: &str, encoding: &str) {
        let schema = self.schemas.get(&schema).map_or(&[][..], |of| &of[..]);
        let of = digest(&[topic.as_bytes(), encoding.as_bytes(), schema]);
        let before = self.channels.insert(id, of);
        self.declared_twice(before.is_some_and(|before| before != of));
    }

    /// Takes in a message, with the two times that a reader may sort it by.
    pub fn message(&mut self, channel: u16, times_unix_ns: [u64; 2], bytes: &[u8]) {
        let channel = self.channels.get(&channel).map_or(&[][..], |of| &of[..]);
        let [logged, published] = times_unix_ns.map(u64::to_le_bytes);
        for part in [channel, &logged, &published, bytes] {
            update(&mut self.hasher, part);
        }
        self.messages += 1;
    }

    /// A number that stands for two things is read in one way here and in another there: no recorder writes that.
    pub fn declared_twice(&mut self, otherwise: bool) {
        if otherwise {
            update(&mut self.hasher, b"declared twice");
        }
    }

    /// What came so far.
    pub fn sum(&self) -> Sum {
        Sum {
            blake3: self.hasher.finalize().to_hex().to_string(),
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

/// What of a recording viewers read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Viewers {
    /// It is what the station wrote.
    AsSigned,
    /// It is not: damaged, or edited. The exact record is judged by itself.
    Changed,
    /// Nobody vouches for it: the recording has no end, or was written before this was signed.
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
                "not signed (the recording has no valid signature or end, or was written before this was signed)"
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a file declares: schemas (number, name, data), then channels (number, schema, topic), then messages (channel, times, bytes).
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
        // Other numbers for the same, and the same said again, as in a file's summary, change nothing.
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
            // The last says what the first does, and one between them does not.
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
        assert_eq!(Sum::parse(&whole.line()), Some(whole.clone()));
        assert_eq!(Sum::parse("session ended"), None);
        let nothing = Summing::default().sum();
        assert_eq!(Viewers::of(None, &whole), Viewers::NotSigned);
        assert_eq!(Viewers::of(Some(&whole), &whole), Viewers::AsSigned);
        assert_eq!(Viewers::of(Some(&whole), &nothing), Viewers::Changed);
    }
}
