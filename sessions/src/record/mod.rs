//! The MCAP recording of a session: writing, reading, signatures, recovery of a damaged file.
//!
//! One file holds all it takes to run a session again: the compiled scene, the state it began with
//! and the input of every tick. Beside it stand what came out (wrench, status, chained state hash),
//! snapshots every ten seconds, and the station's signature over a chain of all of that.
//!
//! # Layout of a recording (format version 5)
//! - attachments `scene.bin`, `exercise`, `patient`, `rubric`, then metadata `sulcus`: versions,
//!   station, opaque learner id, mode, blake3 of every attachment, the signer's public key
//! - the exact channels, on which a replay and a grade rest
//! - channels for viewers ([`channels`]), in chunks of their own, vouched for by one hash in the signed log
//! - metadata `sulcus.recovered`, where a damaged file was written anew ([`crate::recover()`]): how it ended, what is missing, and where
//!   the gaps are ([`crate::Gap`])
//!
//! The recorder writes in this order. A tool may write a file anew in any order and packing that MCAP allows, as long as every
//! channel keeps its messages in their order: the recording stays the same, and so do its signatures. Sorting by log time keeps
//! that order.
//!
//! # Channels
//! Every message is protobuf, and its schema, with comments, stands in the file: Python's `mcap-protobuf-support`, Foxglove
//! and Rerun decode all of them. The four exact messages have one field, number 1, of bytes:
//!
//! | topic | message | bytes in it |
//! |---|---|---|
//! | `/exact/ticks` | `sulcus.v1.ExactRow`, field `row` | [`crate::Row`]: 150 bytes, little-endian |
//! | `/exact/snapshots` | `sulcus.v1.ExactState`, field `state` | tick (u64, little-endian), then [`sulcus_core::State`] |
//! | `/exact/chain` | `sulcus.v1.ExactStatement`, field `statement` | [`crate::SignedStatement`]: 265 bytes, little-endian |
//! | `/events` | `sulcus.v1.ExactEvent`, field `event` | [`crate::Event`] as JSON |
//!
//! The chain and its signatures cover these inner bytes, not the protobuf message around them, which has many valid
//! encodings. Their layout stands in `proto/sulcus/v1/exact_*.proto`, field by field. In Python:
//!
//! ```text
//! for schema, channel, message, decoded in make_reader(file, decoder_factories=[DecoderFactory()]).iter_decoded_messages():
//!     if schema.name == "sulcus.v1.ExactRow":
//!         tick, time_unix_ns = struct.unpack_from("<QQ", decoded.row)
//! ```
//!
//! Up to version 4 the messages of these four channels were the inner bytes alone, in encodings `sulcus-row`, `sulcus-state`,
//! `sulcus-chain` and `json`. Both are read: each channel names its encoding.
//!
//! # Invariants
//! - The file on disk is a clean prefix at any moment: chunks are appended whole.
//! - No bytes, whatever they are, make reading panic or take memory beyond a bound.
//! - Recording never touches the tick's thread; whoever owns the queue counts what it drops.

pub(crate) mod bytes;
pub(crate) mod chain;
pub mod channels;
pub mod ended;
pub(crate) mod envelope;
pub mod format;
pub mod gap;
pub mod header;
pub mod info;
pub mod key;
pub mod message;
pub mod mode;
pub(crate) mod naming;
pub mod occurrence;
pub mod program;
pub mod read;
pub mod recorder;
pub mod recover;
pub mod row;
pub(crate) mod scan;
pub mod sizes;
pub mod statement;
pub(crate) mod storage;
pub mod times;
pub mod verify;
pub mod viewers;
pub(crate) mod walk;
pub mod writer;
pub mod written;
