//! Sessions after the tick: the recording, exercises and the events found in ticks, replay, grade, pages and export.
//!
//! - [`record`]: the MCAP recording, its signatures and its recovery
//! - [`exercise`]: exercise files, and the events that live sessions and grades find in ticks
//! - [`mod@replay`]: deterministic replay, comparison of two recordings, audit by an independent solver
//! - [`grade`]: the measures of a session, rubrics, scores
//! - [`pages`]: HTML of one session and of a class
//! - [`export`]: tables and meshes for other programs
//! - [`cli`]: the program `sulcus-sessions`
//!
//! ```
//! use sulcus_sessions::{Recording, ReplayOptions, replay};
//!
//! let recording = Recording::open("tests/corpus/hard-wedge.mcap".as_ref())?;
//! let report = replay(&recording, &ReplayOptions::default(), &mut |_| ())?;
//! assert!(report.identical && report.chain_ok);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![cfg_attr(not(test), warn(clippy::print_stdout, clippy::print_stderr))]

pub mod cli;
pub mod exercise;
pub mod export;
pub mod grade;
pub mod pages;
pub mod record;
pub mod replay;
mod sentence;

pub use cli::run;
pub use exercise::Exercise;
pub use exercise::events::Events;
pub use grade::{Grade, Rubric};
pub use record::attach::{Absence, Detached};
pub use record::channels::{Cadence, FRAMES_HZ, Moved, MovedTissue, Sampler, Shapes, Views};
pub use record::device::{DeviceFacts, Limits};
pub use record::gap::Gap;
pub use record::header::SessionHeader;
pub use record::info::{Info, info};
pub use record::key::{KeyError, PublicKey, StationKey};
pub use record::levels::By;
pub use record::message::{Event, Level, Message};
pub use record::mode::Mode;
pub use record::occurrence::Occurrence;
pub use record::person::PersonFacts;
pub use record::plan::{PlanChange, PlanFacts};
pub use record::policy::ViewersPolicy;
pub use record::predecessor::Predecessor;
pub use record::program::Program;
pub use record::read::{Ending, Facts, ReadError, Recording};
pub use record::recorder::{Finished, RecordError, Recorder};
pub use record::recover::{Lost, LostChannel, RecoverError, Recovered, recover, recover_to};
pub use record::row::Row;
pub use record::sample::{DeviceSample, DeviceSamples};
pub use record::signature::{Signature, Signed, Verdict};
pub use record::statement::{SessionEnd, SignedStatement, Statement};
pub use record::verify::verify;
pub use record::viewers::Viewers;
pub use record::writer::{RecordedTick, SessionWriter};
pub use record::written::WrittenError;
pub use replay::audit::{AuditReport, AuditRow, audit_tick};
pub use replay::compare::{Apart, CompareError, ComparisonReport, Side, compare};
pub use replay::viewers::{ViewersError, compare_viewers, with_viewers};
pub use replay::whatif::{TissueChoice, WhatIf, WhatIfError};
pub use replay::{
    Deviation, Difference, Divergence, Part, ReplayError, ReplayOptions, ReplayReport, Span,
    Stretch, replay, replay_observed,
};
pub use sentence::sentence;
