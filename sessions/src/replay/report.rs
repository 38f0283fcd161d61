//! Options and result of a replay.

use serde::Serialize;

use super::audit::AuditReport;
use super::close::CLOSE;
use super::deviation::Deviation;
use super::span::{Part, Span};
use super::stretch::Stretch;
use crate::record::format::Migration;
use crate::record::key::PublicKey;
use crate::record::program::Program;
use crate::record::read::Ending;
use crate::record::signature::Signature;
use crate::record::viewers::Viewers;

/// Options of a replay.
#[derive(Clone, Copy, Debug, Default)]
pub struct ReplayOptions {
    /// Whether the judge solves every tick's problem again.
    pub audit: bool,
    /// Only accepted signer; `None` accepts the key that the recording names.
    pub trust: Option<PublicKey>,
    /// Part of the session; by default all of it.
    pub span: Span,
}

/// Kind of the first difference.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Difference {
    /// The tick's number differs, because rows are missing.
    Tick,
    /// The hash of the state differs, and so input, state or program.
    Hash,
    /// The wrench or the status differs, with the same state.
    Output,
    /// The recorded snapshot differs from the state of the replay.
    Snapshot,
}

/// First difference of a replay, and the number of differing ticks.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Divergence {
    /// Kind of the first difference.
    pub what: Difference,
    /// Recorded state hash of the tick, hexadecimal.
    pub hash_recorded: String,
    /// State hash of the replay, hexadecimal.
    pub hash_replayed: String,
    /// Ticks that differ. At a snapshot the replay continues from the recorded state.
    pub ticks: u64,
}

/// Result of a replay.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ReplayReport {
    /// Ticks run.
    pub ticks: u64,
    /// Whether every tick gave the recorded hash, wrench and status, and every snapshot the state.
    pub identical: bool,
    /// First tick that differs.
    pub first_divergent_tick: Option<u64>,
    /// First difference.
    pub divergence: Option<Divergence>,
    /// Largest difference between recorded and replayed force over all ticks, newtons.
    pub max_force_deviation_n: f64,
    /// Deviation from the record; zero if identical.
    pub deviation: Deviation,
    /// Migration of a recording of a former version. Its replay differs, and a grade may rest on it as long as it stays
    /// close ([`CLOSE`]).
    pub migration: Option<Migration>,
    /// Simulated time divided by the time of the replay.
    pub realtime_factor: f64,
    /// Part that was run; `None` for the whole session.
    pub part: Option<Part>,
    /// Stretches between the gaps; empty without gaps.
    pub stretches: Vec<Stretch>,
    /// Recording program.
    pub recorded_by: Program,
    /// Replaying program.
    pub replayed_by: Program,
    /// Result of the signatures.
    pub signature: Signature,
    /// Whether the key was given from outside rather than taken from the recording.
    pub signer_trusted: bool,
    /// Whether every recorded head of the chain equals the head over the messages before it.
    pub chain_ok: bool,
    /// State of the channels for viewers.
    pub viewers: Viewers,
    /// Ending of the recording's file.
    pub ending: Ending,
    /// Whether a grade may rest on the session.
    pub gradable: bool,
    /// Reason against a grade.
    pub reason: Option<String>,
    /// Result of the judge, if requested.
    pub audit: Option<AuditReport>,
}

impl ReplayReport {
    /// Whether the replay has a finding: it differs, a signature is invalid, bytes are damaged, or the session cannot
    /// be graded. A recording that was cut off cannot be graded. A requested part is never graded, so this alone is no
    /// finding.
    pub fn is_finding(&self) -> bool {
        (!self.gradable && self.part.is_none())
            || !(self.identical || self.is_close())
            || !self.chain_ok
            || matches!(self.signature, Signature::Invalid { .. })
            || matches!(self.ending, Ending::Damaged { .. })
            || self.viewers == Viewers::Changed
    }

    /// Fault of the file itself, independent of the part: an invalid signature, or another ending than the session's
    /// own. Displays and exports must show the fault.
    pub fn unsound(&self) -> Option<String> {
        if let Signature::Invalid { .. } = &self.signature {
            return Some(format!("signature {}", self.signature));
        }
        if !self.chain_ok {
            return Some("the messages differ from the signed messages".to_owned());
        }
        (self.ending != Ending::Finished).then(|| self.ending.to_string())
    }

    /// Whether the recording is of a former version, and the replay within the tolerance of its migration.
    pub fn is_close(&self) -> bool {
        self.migration.is_some() && CLOSE.holds(&self.deviation)
    }
}
