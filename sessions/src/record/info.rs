//! Summary of a recording, without a replay.

use std::fmt;
use std::path::Path;

use serde::Serialize;
use sulcus_core::Coupling;
use sulcus_program::PathText;

use crate::record::attach::Absence;
use crate::record::bytes::hex;
use crate::record::coupling;
use crate::record::device::{DeviceFacts, Limits};
use crate::record::format::Migration;
use crate::record::message::Message;
use crate::record::mode::Mode;
use crate::record::person::PersonFacts;
use crate::record::plan::PlanFacts;
use crate::record::policy::ViewersPolicy;
use crate::record::predecessor::Predecessor;
use crate::record::read::{Ending, ReadError, Recording};
use crate::record::signature::Signature;
use crate::record::sizes::{Sizes, sizes};
use crate::record::statement::SessionEnd;
use crate::record::verify::verify;
use crate::record::viewers::Viewers;

/// Content of a recording's file, as printed by `info`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Info {
    /// Name of the file.
    pub file: String,
    /// Length of the file, bytes.
    pub bytes: u64,
    /// Bytes per minute of the session, without the header; `None` for a session without duration.
    pub bytes_per_minute: Option<f64>,
    /// Bytes by part and channel, and a forecast per hour.
    pub sizes: Sizes,
    /// Time from the first row to the last, seconds.
    pub duration_s: f64,
    /// Number of rows.
    pub ticks: u64,
    /// First tick.
    pub first_tick: u64,
    /// Last tick.
    pub last_tick: u64,
    /// Number of snapshots of the state.
    pub snapshots: u64,
    /// Number of lines in the log.
    pub events: u64,
    /// Number of signed statements.
    pub signatures: u64,
    /// Name of the scene; `None` if this version cannot read the scene.
    pub scene: Option<String>,
    /// blake3 of the compiled scene.
    pub scene_blake3: String,
    /// Hash of the scene's sources.
    pub scene_source_hash: Option<String>,
    /// Name of the exercise.
    pub exercise: String,
    /// blake3 of the exercise's text.
    pub exercise_blake3: String,
    /// Seed of the simulated hand.
    pub seed: u64,
    /// Opaque id of the learner.
    pub learner_id: String,
    /// Name of the station.
    pub station: String,
    /// Mode of the session; null in recordings from before 24 November 2026.
    pub mode: Option<Mode>,
    /// Version of the recording program.
    pub program_version: String,
    /// `debug` or `release`.
    pub build: String,
    /// Processor and system, such as `x86_64-linux`.
    pub target: String,
    /// Migration of a recording of a former version of the format.
    pub migration: Option<Migration>,
    /// Version of the recording format.
    pub format: u32,
    /// BLAKE3 of all bytes of the file, hexadecimal.
    pub blake3: String,
    /// Recording that this one continues; null for the beginning of a session.
    pub predecessor: Option<Predecessor>,
    /// Devices, by slot.
    pub devices: Vec<DeviceFacts>,
    /// Other devices after a gap of the connection.
    pub later_devices: Vec<DeviceFacts>,
    /// Couplings in force, in the order of the tools; empty for those of the scene.
    pub couplings: Vec<Coupling>,
    /// Limits of the wrench that the station sent; null if unknown.
    pub limits: Option<Limits>,
    /// Facts of the station's plan; null without a plan.
    pub plan: Option<PlanFacts>,
    /// Session epoch of the client's first attachment; null without a connection.
    pub attach_epoch: Option<u32>,
    /// Number of samples of devices.
    pub device_samples: u64,
    /// Hand and finger rest that the screen told last; null without a screen.
    pub person: Option<PersonFacts>,
    /// Gaps of the connection.
    pub absences: Vec<Absence>,
    /// Start of the session, nanoseconds since the Unix epoch.
    pub started_unix_ns: u64,
    /// Ending of the file.
    pub ending: Ending,
    /// Counters of the station at the end of the session.
    pub end: Option<SessionEnd>,
    /// Policy about the channels for viewers.
    pub viewers_policy: ViewersPolicy,
    /// Public key that the recording names as its signer.
    pub signer: String,
    /// Result of the signatures, by the key that the recording names.
    pub signature: Signature,
    /// State of the channels for viewers.
    pub viewers: Viewers,
    /// Damaged chunks of the channels for viewers, which were skipped.
    pub damaged_views: u64,
}

/// Summary of a recording. Checks the signatures, and runs no tick.
///
/// # Errors
/// The file has changed since it was opened.
pub fn info(path: &Path, recording: &Recording) -> Result<Info, ReadError> {
    let verdict = verify(recording, None)?;
    let (header, facts) = (recording.header(), recording.facts());
    let scene = recording.scene().ok();
    let (first_tick, last_tick) = facts.ticks.unwrap_or_default();
    let (from, to) = facts.times_unix_ns.unwrap_or_default();
    let duration_s = to.saturating_sub(from) as f64 * 1e-9;
    let sizes = sizes(recording, duration_s)?;
    let told = told(recording)?;
    // The header is stored once, however long the session is.
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
        format: recording.format(),
        blake3: hex(&recording.blake3()),
        predecessor: header.predecessor.clone(),
        devices: header.devices.clone(),
        later_devices: told.later_devices,
        couplings: header.couplings.clone(),
        limits: header.limits,
        plan: header.plan.clone(),
        attach_epoch: header.attach_epoch,
        device_samples: facts.device_samples,
        person: told.person,
        absences: told.absences,
        started_unix_ns: header.started_unix_ns,
        ending: recording.ending().clone(),
        end: facts.end,
        viewers_policy: header.viewers,
        signer: recording.signer().fingerprint(),
        viewers: recording.viewers_by(&verdict.signature),
        signature: verdict.signature,
        damaged_views: facts.damaged_views,
    })
}

/// Facts in the log of a recording.
#[derive(Default)]
struct Told {
    absences: Vec<Absence>,
    person: Option<PersonFacts>,
    later_devices: Vec<DeviceFacts>,
}

fn told(recording: &Recording) -> Result<Told, ReadError> {
    let mut told = Told::default();
    for message in recording.messages() {
        if let Message::Event(event) = message? {
            Absence::hear(&mut told.absences, &event.text);
            told.person = PersonFacts::hear(&event.text).or(told.person);
            let later = DeviceFacts::hear(&event.text);
            told.later_devices.extend(later.unwrap_or_default());
        }
    }
    Ok(told)
}

impl Info {
    /// Whether the file has a fault. A cut off end is no fault.
    pub fn is_finding(&self) -> bool {
        matches!(self.ending, Ending::Damaged { .. })
            || matches!(self.signature, Signature::Invalid { .. })
            || self.viewers == Viewers::Changed
            || self.damaged_views > 0
    }
}

impl Info {
    /// Lines about devices, couplings, limits, plan, gaps and predecessor.
    fn of_the_connection(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for device in &self.devices {
            writeln!(f, "  device     {device}")?;
        }
        for device in &self.later_devices {
            writeln!(f, "  later      {device}")?;
        }
        for (tool, coupling) in self.couplings.iter().enumerate() {
            writeln!(f, "  coupling   {}", coupling::words(tool, coupling))?;
        }
        if self.device_samples > 0 {
            writeln!(
                f,
                "  samples    {} poses with the displayed wrench",
                self.device_samples
            )?;
        }
        if let Some(limits) = &self.limits {
            writeln!(f, "  limits     {limits}")?;
        }
        if let Some(plan) = &self.plan {
            writeln!(f, "  plan       {plan}")?;
        }
        if let Some(PersonFacts { hand, finger_rest }) = &self.person {
            let [hand, rest] = [hand, finger_rest].map(|word| word.escape_debug());
            writeln!(
                f,
                "  student    probe in the {hand} hand, finger rest: {rest}"
            )?;
        }
        for Absence { from, to } in &self.absences {
            match to {
                Some(to) => writeln!(f, "  gap        ticks {from} to {}", to.saturating_sub(1))?,
                None => writeln!(f, "  gap        from tick {from} to the end")?,
            }
        }
        if let Some(before) = &self.predecessor {
            writeln!(f, "  continues  {before}")?;
        }
        Ok(())
    }
}

impl fmt::Display for Info {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Text from a file may contain control characters of a terminal.
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
        self.of_the_connection(f)?;
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
                "  damaged    {} chunks of the channels for viewers",
                self.damaged_views
            )?;
        }
        write!(f, "  viewers    {}", self.viewers)
    }
}
