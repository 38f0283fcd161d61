//! A recording in a few lines.

use std::fmt;
use std::path::Path;

use serde::Serialize;
use sulcus_program::PathText;

use crate::record::bytes::hex;
use crate::record::format::Migration;
use crate::record::mode::Mode;
use crate::record::read::{Ending, ReadError, Recording};
use crate::record::sizes::{Sizes, sizes};
use crate::record::statement::SessionEnd;
use crate::record::verify::{Signature, verify};
use crate::record::viewers::Viewers;

/// What `info` says of a file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Info {
    /// The file.
    pub file: String,
    /// Its length, bytes.
    pub bytes: u64,
    /// Bytes for each minute of the session; `None` when it is too short to say.
    pub bytes_per_minute: Option<f64>,
    /// Where its bytes are, what a minute takes, and what an hour will.
    pub sizes: Sizes,
    /// From the first row to the last, seconds.
    pub duration_s: f64,
    /// Rows.
    pub ticks: u64,
    /// First tick.
    pub first_tick: u64,
    /// Last tick.
    pub last_tick: u64,
    /// Snapshots of the state.
    pub snapshots: u64,
    /// Lines in the log.
    pub events: u64,
    /// Signed statements.
    pub signatures: u64,
    /// Name of the scene; `None` when its bytes are not a scene of this version.
    pub scene: Option<String>,
    /// blake3 of the compiled scene.
    pub scene_blake3: String,
    /// Hash of what the scene was compiled from.
    pub scene_source_hash: Option<String>,
    /// Name of the exercise.
    pub exercise: String,
    /// blake3 of the exercise's text.
    pub exercise_blake3: String,
    /// Seed of the simulated hand.
    pub seed: u64,
    /// Opaque id of the learner.
    pub learner_id: String,
    /// Station.
    pub station: String,
    /// What the session was for; null in recordings of before it was said.
    pub mode: Option<Mode>,
    /// Version of the program that recorded.
    pub program_version: String,
    /// `debug` or `release`.
    pub build: String,
    /// Processor and system.
    pub target: String,
    /// What becomes of a recording of a former version of the format.
    pub migration: Option<Migration>,
    /// When the session began, nanoseconds since the Unix epoch.
    pub started_unix_ns: u64,
    /// How the file ends.
    pub ending: Ending,
    /// The station's counters at the end.
    pub end: Option<SessionEnd>,
    /// Public key that the recording names as its signer.
    pub signer: String,
    /// What the signatures say, with that key.
    pub signature: Signature,
    /// What viewers read of it.
    pub viewers: Viewers,
    /// Chunks of what viewers read that cannot be unpacked, and were passed over.
    pub damaged_views: u64,
}

/// Summarises a recording; checks its signatures, runs no tick.
///
/// # Errors
/// When the file changes meanwhile.
pub fn info(path: &Path, recording: &Recording) -> Result<Info, ReadError> {
    let verdict = verify(recording, None)?;
    let (header, facts) = (recording.header(), recording.facts());
    let scene = recording.scene().ok();
    let (first_tick, last_tick) = facts.ticks.unwrap_or_default();
    let (from, to) = facts.times_unix_ns.unwrap_or_default();
    let duration_s = to.saturating_sub(from) as f64 * 1e-9;
    let sizes = sizes(recording, duration_s)?;
    // Without the header, which is there once, however long the session.
    let body = recording.len() - sizes.header_bytes;
    Ok(Info {
        file: path.shown().to_string(),
        bytes: recording.len(),
        sizes,
        bytes_per_minute: (duration_s > 0.0).then(|| body as f64 / duration_s * 60.0),
        duration_s,
        ticks: facts.rows,
        first_tick,
        last_tick,
        snapshots: facts.snapshots,
        events: facts.events,
        signatures: facts.signatures,
        scene_blake3: hex(&header.scene_hash()),
        scene_source_hash: scene.as_ref().map(|scene| scene.source_hash.clone()),
        scene: scene.map(|scene| scene.name),
        exercise: header.exercise_name.clone(),
        exercise_blake3: hex(&header.exercise_hash()),
        seed: header.seed,
        learner_id: header.learner_id.clone(),
        station: header.station.clone(),
        mode: header.mode,
        program_version: header.program_version.clone(),
        build: header.build.clone(),
        target: header.target.clone(),
        migration: recording.migration(),
        started_unix_ns: header.started_unix_ns,
        ending: recording.ending().clone(),
        end: facts.end,
        signer: recording.signer().fingerprint(),
        viewers: recording.viewers_by(&verdict.signature),
        signature: verdict.signature,
        damaged_views: facts.damaged_views,
    })
}

impl Info {
    /// Whether something is wrong with the file; being cut off is not.
    pub fn is_finding(&self) -> bool {
        matches!(self.ending, Ending::Damaged { .. })
            || matches!(self.signature, Signature::Invalid { .. })
            || self.viewers == Viewers::Changed
            || self.damaged_views > 0
    }
}

impl fmt::Display for Info {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Text from a file may hold anything, also what a terminal obeys.
        let safe = |text: &str| text.escape_debug().to_string();
        let or = |text: &str, other: &str| {
            if text.is_empty() {
                other.to_owned()
            } else {
                safe(text)
            }
        };
        writeln!(f, "{}", self.file)?;
        writeln!(
            f,
            "  duration   {:.3} s, {} ticks ({} to {}), {} snapshots, {} events",
            self.duration_s,
            self.ticks,
            self.first_tick,
            self.last_tick,
            self.snapshots,
            self.events
        )?;
        let rate = self.bytes_per_minute.map_or(String::new(), |rate| {
            format!(", {:.2} MB per minute", rate * 1e-6)
        });
        writeln!(f, "  size       {:.2} MB{rate}", self.bytes as f64 * 1e-6)?;
        writeln!(f, "{}", self.sizes)?;
        match &self.scene {
            Some(name) => writeln!(
                f,
                "  scene      {}, blake3 {}",
                or(name, "(no name)"),
                self.scene_blake3
            )?,
            None => writeln!(
                f,
                "  scene      cannot be used by this version, blake3 {}",
                self.scene_blake3
            )?,
        }
        writeln!(
            f,
            "  exercise   {}, blake3 {}",
            or(&self.exercise, "(no name)"),
            self.exercise_blake3
        )?;
        writeln!(f, "  learner    {}", or(&self.learner_id, "(none)"))?;
        if let Some(mode) = self.mode {
            writeln!(f, "  mode       {mode}")?;
        }
        writeln!(f, "  station    {}", or(&self.station, "(none)"))?;
        writeln!(
            f,
            "  program    {} {}, {}",
            safe(&self.program_version),
            safe(&self.build),
            safe(&self.target)
        )?;
        if let Some(migration) = &self.migration {
            writeln!(f, "  migrated   {migration}")?;
        }
        writeln!(f, "  ending     {}", self.ending)?;
        if let Some(end) = &self.end {
            writeln!(
                f,
                "  counters   {} ticks, {} skipped, {} rows dropped, {} deadlines missed, {} exhausted, {} poses lost, {} late",
                end.ticks,
                end.skipped,
                end.dropped_rows,
                end.deadline_misses,
                end.exhausted,
                end.lost,
                end.late
            )?;
        }
        writeln!(
            f,
            "  signature  {} (the key is the recording's own)",
            self.signature
        )?;
        if self.damaged_views > 0 {
            writeln!(
                f,
                "  damaged    {} chunks of what viewers read",
                self.damaged_views
            )?;
        }
        write!(f, "  viewers    {}", self.viewers)
    }
}
