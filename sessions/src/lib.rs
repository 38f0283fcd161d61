//! The MCAP record of a session, and what is found out from it: replay, signatures, summary.
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
//! - metadata `sulcus.recovered`, where a damaged file was written anew ([`recover()`]): how it ended, what is missing, and where
//!   the gaps are ([`Gap`])
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
//! | `/exact/ticks` | `sulcus.v1.ExactRow`, field `row` | [`Row`]: 150 bytes, little-endian |
//! | `/exact/snapshots` | `sulcus.v1.ExactState`, field `state` | tick (u64, little-endian), then [`sulcus_core::State`] |
//! | `/exact/chain` | `sulcus.v1.ExactStatement`, field `statement` | [`SignedStatement`]: 265 bytes, little-endian |
//! | `/events` | `sulcus.v1.ExactEvent`, field `event` | [`Event`] as JSON |
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

#![cfg_attr(not(test), warn(clippy::print_stdout, clippy::print_stderr))]

pub mod audit;
mod bytes;
mod cells;
mod chain;
pub mod channels;
pub mod cli;
pub mod compare;
pub mod ended;
mod envelope;
pub mod events;
pub mod exercise;
pub mod export;
pub mod format;
pub mod gap;
pub mod grade;
pub mod header;
pub mod info;
pub mod key;
pub mod message;
pub mod mode;
mod naming;
pub mod occurrence;
pub mod program;
pub mod read;
pub mod record;
pub mod recover;
pub mod replay;
pub mod row;
mod scan;
mod sentence;
mod sheet;
pub mod sizes;
pub mod statement;
mod storage;
pub mod times;
pub mod verify;
pub mod viewers;
mod walk;
pub mod whatif;
pub mod written;

pub use audit::{AuditReport, AuditRow, audit_tick};
pub use channels::{Sampler, Shapes, Views};
pub use cli::run;
pub use compare::{Apart, CompareError, ComparisonReport, Side, compare};
pub use events::Events;
pub use exercise::Exercise;
pub use gap::Gap;
pub use grade::{Grade, Rubric};
pub use header::SessionHeader;
pub use info::{Info, info};
pub use key::{KeyError, PublicKey, StationKey};
pub use message::{Event, Level, Message};
pub use mode::Mode;
pub use occurrence::Occurrence;
pub use program::Program;
pub use read::{Ending, Facts, ReadError, Recording};
pub use record::{Finished, RecordError, Recorder};
pub use recover::{Lost, LostChannel, RecoverError, Recovered, recover, recover_to};
pub use replay::{
    Deviation, Difference, Divergence, Part, ReplayError, ReplayOptions, ReplayReport, Span,
    Stretch, replay, replay_observed,
};
pub use row::Row;
pub use sentence::sentence;
pub use statement::{SessionEnd, SignedStatement, Statement};
pub use verify::{Signature, Signed, Verdict, verify};
pub use viewers::Viewers;
pub use whatif::{TissueChoice, WhatIf, WhatIfError};
pub use written::WrittenError;
