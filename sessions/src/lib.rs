//! The MCAP record of a session, and what is found out from it: replay, signatures, summary.
//!
//! One file holds all it takes to run a session again: the compiled scene, the state it began with
//! and the input of every tick. Beside it stand what came out (wrench, status, chained state hash),
//! snapshots every ten seconds, and the station's signature over a chain of all of that.
//!
//! # Layout of a recording (format version 4)
//! - attachments `scene.bin`, `exercise`, `patient`, `rubric`, then metadata `sulcus`: versions,
//!   station, opaque learner id, mode, blake3 of every attachment, the signer's public key
//! - `/exact/ticks`: [`Row`]; `/exact/snapshots`: tick and state; `/exact/chain`:
//!   [`SignedStatement`]; `/events`: [`Event`]; the layouts stand in the file, as schemas
//! - the rest is for viewers ([`channels`]), in chunks of its own, not signed, and skipped here: what a replay and a grade rest
//!   on are the exact channels
//! - metadata `sulcus.recovered`, where a torn file was written anew ([`recover()`]): how it ended, and what is missing
//!
//! # Invariants
//! - The file on disk is a clean prefix at any moment: chunks are appended whole.
//! - No bytes, whatever they are, make reading panic or take memory beyond a bound.
//! - Recording never touches the tick's thread; whoever owns the queue counts what it drops.

pub mod audit;
mod bytes;
mod cells;
mod chain;
pub mod channels;
pub mod cli;
pub mod compare;
pub mod ended;
pub mod events;
pub mod exercise;
pub mod export;
pub mod format;
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
    replay, replay_observed,
};
pub use row::Row;
pub use sentence::sentence;
pub use statement::{SessionEnd, SignedStatement, Statement};
pub use verify::{Signature, Verdict, verify};
pub use viewers::Viewers;
pub use whatif::{TissueChoice, WhatIf, WhatIfError};
pub use written::WrittenError;
