//! Reasons why the channels for viewers cannot be made.

use std::path::PathBuf;

use sulcus_program::{PathText, disk};

use crate::record::header::FORMAT_VERSION;
use crate::record::program::Program;
use crate::record::read::{Ending, ReadError};
use crate::record::recorder::RecordError;
use crate::replay::error::ReplayError;

/// Reason why the channels for viewers cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum ViewersError {
    /// The recording cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The recording cannot be replayed.
    #[error(transparent)]
    Replay(#[from] ReplayError),
    /// The recording has the channels.
    #[error(
        "channels for viewers are in the recording, expected a recording of the policy `on-demand` without them: open this file in the viewer"
    )]
    There,
    /// The recording is cut off, damaged or recovered.
    #[error(
        "recording is {0}, expected a finished one: its hash over the channels for viewers is missing, and made channels could not be compared"
    )]
    NotWhole(Ending),
    /// The recording is of a former version of the format.
    #[error(
        "recording has format {0}, expected format {FORMAT_VERSION}: former programs wrote other channels for viewers"
    )]
    Former(u32),
    /// The signature is invalid.
    #[error("signature is invalid, expected a valid one: {0}")]
    Signature(String),
    /// The channels in the recording differ from the signed hash.
    #[error(
        "channels for viewers in the recording differ from the signed hash, expected the signed ones: the file is damaged or edited"
    )]
    Changed,
    /// The signed log has no hash over the channels.
    #[error("signed log has no hash over the channels for viewers, expected one at its end")]
    NotSigned,
    /// The replay differs from the record.
    #[error(
        "replay differs from the record at tick {tick}: {what}{}",
        programs(recorded_by, replayed_by)
    )]
    Differs {
        /// First tick that differs.
        tick: u64,
        /// Difference.
        what: String,
        /// Recording program.
        recorded_by: Box<Program>,
        /// This program.
        replayed_by: Box<Program>,
    },
    /// The made channels differ from those of the live session.
    #[error(
        "made channels differ from the signed hash: {found} messages made, {expected} expected{}",
        programs(recorded_by, replayed_by)
    )]
    Others {
        /// Messages made.
        found: u64,
        /// Messages of the live session.
        expected: u64,
        /// Recording program.
        recorded_by: Box<Program>,
        /// This program.
        replayed_by: Box<Program>,
    },
    /// The new file cannot be written.
    #[error("cannot write `{}`: {source}{}", path.shown(), disk::advice(source))]
    Write {
        /// Path of the file.
        path: PathBuf,
        /// Error of the system.
        source: std::io::Error,
    },
    /// Writing of the new file failed.
    #[error(transparent)]
    Record(#[from] RecordError),
}

impl ViewersError {
    /// Whether the recording could be replayed, and differs. Any other error is wrong usage or bad input.
    pub fn is_finding(&self) -> bool {
        matches!(
            self,
            Self::Signature(_) | Self::Changed | Self::Differs { .. } | Self::Others { .. }
        )
    }
}

/// Words about two programs; empty for the same program.
fn programs(recorded_by: &Program, replayed_by: &Program) -> String {
    if recorded_by == replayed_by {
        return String::new();
    }
    format!(", recorded by {recorded_by}, replayed by {replayed_by}: use the recording program")
}
