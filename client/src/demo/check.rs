//! The check at the end of a demo: the recording replayed, every tick observed.

use std::path::Path;

use sulcus_cases::{Measures, Observer};
use sulcus_sessions::{Recording, ReplayOptions, ReplayReport, Signature, replay_observed};

use crate::progress::Steps;

/// What the replay found.
pub struct Checked {
    /// The replay's own report.
    pub report: ReplayReport,
    /// The measures of the session, by full queries of all pairs.
    pub measures: Measures,
    /// Size of the file.
    pub bytes: u64,
}

impl Checked {
    /// Whether the signatures hold.
    pub fn signature_valid(&self) -> bool {
        matches!(self.report.signature, Signature::Valid { .. }) && self.report.chain_ok
    }
}

/// Replays the recording at `path`.
///
/// # Errors
/// When it cannot be read.
pub fn check(path: &Path, steps: &Steps) -> anyhow::Result<Checked> {
    let recording = Recording::open(path)?;
    let scene = recording.scene()?;
    let mut observer = Observer::new(&scene);
    let rows = recording.len().max(1) as f64;
    let bar = steps.bar("replaying");
    let report = replay_observed(
        &recording,
        &ReplayOptions::default(),
        &mut |ticks| bar.set("replaying", ticks as f64 / rows),
        &mut |scene, input, output, ws| observer.observe(scene, input, output, ws),
    )?;
    bar.done();
    let bytes = std::fs::metadata(path)?.len();
    Ok(Checked {
        report,
        measures: observer.measures(),
        bytes,
    })
}
