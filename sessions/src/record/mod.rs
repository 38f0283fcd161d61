//! Recording of a session as one MCAP file: writing, reading, signatures, recovery of a damaged file.
//!
//! The file contains everything that a replay needs: the compiled scene, the initial state, and the input of every
//! tick. It also contains the output of every tick (wrench, status, chained state hash) and snapshots every ten
//! seconds. The station signs a chain of hashes over all of these.
//!
//! # Layout of a recording (format version 7)
//! - attachments `scene.bin`, `exercise`, `patient`, `rubric`, then metadata `sulcus`: versions, station, opaque
//!   learner id, mode, blake3 of every attachment, public key of the signer; as JSON, each if it is known: `devices`,
//!   `limits`, `plan`, `attach_epoch`, `predecessor`, `couplings`; `viewers` if the policy is `on-demand`
//!   ([`crate::SessionHeader`])
//! - the exact channels, on which a replay and a grade rest
//! - channels for viewers ([`channels`]), in chunks of their own, with one hash over all of them in the signed log;
//!   with the policy `on-demand` ([`policy`]) one of them, and a replay makes the others ([`crate::with_viewers`])
//! - metadata `sulcus.recovered` in a recovered file ([`crate::recover()`]): ending of the damaged file, missing part,
//!   gaps ([`crate::Gap`])
//!
//! The recorder writes in this order. A tool may write a file anew in any order and compression that MCAP allows. Only
//! the order of the messages within a channel must stay, and sorting by log time keeps it. The result is the same
//! recording with the same valid signatures.
//!
//! # Channels
//! Every message is protobuf, and its schema with comments is in the file. Python's `mcap-protobuf-support`, Foxglove
//! and Rerun decode all messages. The four exact messages have a field, number 1, of bytes:
//!
//! | topic | message | bytes in it |
//! |---|---|---|
//! | `/exact/ticks` | `sulcus.v1.ExactRow`, field `row`; field `samples` | [`crate::Row`]: 150 bytes, little-endian; [`sample::DeviceSample`] |
//! | `/exact/snapshots` | `sulcus.v1.ExactState`, field `state` | tick (u64, little-endian), then [`sulcus_core::State`] |
//! | `/exact/chain` | `sulcus.v1.ExactStatement`, field `statement` | [`crate::SignedStatement`]: 265 bytes, little-endian |
//! | `/events` | `sulcus.v1.ExactEvent`, field `event` | [`crate::Event`] as JSON |
//!
//! A row has a sample for each pose that its tick was the first to use: number, device time and age of the pose, and
//! the wrench that the hand felt. The samples are fields of protobuf, so that other programs plot them.
//!
//! Chain and signatures cover these inner bytes, because the protobuf message around them has many valid encodings. The
//! values of the samples are covered as bytes behind those of their row.
//! `proto/sulcus/v1/exact_*.proto` describes the layout of the inner bytes field by field. In Python:
//!
//! ```text
//! reader = make_reader(file, decoder_factories=[DecoderFactory()])
//! for schema, channel, message, decoded in reader.iter_decoded_messages():
//!     if schema.name == "sulcus.v1.ExactRow":
//!         tick, time_unix_ns = struct.unpack_from("<QQ", decoded.row)
//! ```
//!
//! # Gaps of the connection
//! The session goes on while a student is gone. Two lines of the log mark the gap ([`crate::Occurrence`]): `detached`
//! at the first tick without the student, with a `reason`; `attached` at the first tick with the student, with `epoch`
//! and `gap_ticks`. `devices_changed` follows if the student is back with other devices. A change of a level (`paused`,
//! `resumed`, `force_limit`) names its side: `by` is `station`, `student` or the opaque id of an instructor's token.
//!
//! # Sessions in several files
//! After a crash of the station's program the session goes on in a second file. The signed header of the second file
//! names the first one and its BLAKE3 hash ([`predecessor`]). Each file replays by itself; the grade takes all of them.
//!
//! # Couplings
//! A haptic device may display only a softer coupling than that of the scene. The session then runs with the softer
//! coupling, and the header contains it. [`crate::Recording::scene`] returns the scene with it. The attachment
//! `scene.bin` and its hash remain those of the compiled scene.
//!
//! # Former versions
//! Up to version 6 the couplings are those of the scene, and a device has fewer fields. Up to version 5 rows have no
//! samples, and the JSON fields of the header are absent. Up to version 4 the messages of these four channels were the
//! inner bytes alone, in encodings `sulcus-row`, `sulcus-state`, `sulcus-chain` and `json`. Both encodings are read,
//! because each channel names its encoding.
//!
//! # Invariants
//! - The file on disk is a clean prefix at any moment, because chunks are appended whole.
//! - No bytes make reading panic or take memory beyond a bound.
//! - The recorder never runs in the tick's thread. The owner of the queue between them counts dropped rows.

pub mod at_hand;
pub mod attach;
pub(crate) mod bytes;
pub(crate) mod chain;
pub mod channels;
pub(crate) mod coupling;
pub mod device;
pub mod ended;
pub(crate) mod envelope;
pub mod format;
pub mod gap;
pub mod header;
pub mod info;
pub mod key;
pub mod levels;
pub mod message;
pub mod mode;
pub mod naming;
pub(crate) mod note;
pub mod occurrence;
pub mod person;
pub mod plan;
pub mod policy;
pub mod predecessor;
pub mod program;
pub(crate) mod raw;
pub mod read;
pub mod recorder;
pub mod recover;
pub mod row;
pub mod sample;
pub(crate) mod sane;
pub(crate) mod scan;
pub(crate) mod schema;
pub mod signature;
pub mod sizes;
pub mod statement;
pub(crate) mod storage;
pub mod times;
pub(crate) mod unpack;
pub mod utc;
pub mod verify;
pub mod viewers;
pub(crate) mod walk;
pub mod writer;
pub mod written;
