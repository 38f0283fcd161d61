//! Review of a recorded session: replayed, and written as a file for the Rerun viewer.
//!
//! All shapes and numbers come from the replay. A recording whose replay differs is not shown, unless it is of a former
//! version and stays close. Events of a client and of the exercise come from the log.

pub(crate) mod follow;
mod frame;
pub(crate) mod picture;
mod tissue;
mod units;
mod window;
mod words;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::error::ViewError;
use crate::review::{Lane, ReviewFile, ReviewPicture};
use serde::Serialize;
use sulcus_core::output::ForceZone;
use sulcus_core::{Scene, TickInput, TickOutput, Workspace};
use sulcus_program::PathText;

pub use crate::review::Slider;
pub use window::Window;

use sulcus_sessions::exercise::Exercise;
use sulcus_sessions::record::occurrence::zone_name;
use sulcus_sessions::record::read::{ReadError, Recording};
use sulcus_sessions::record::times::longest_tick_us;
use sulcus_sessions::replay::{Difference, ReplayError, ReplayOptions, replay_observed};

use frame::Eyes;
use tissue::Tissues;
use window::moment;
use words::Story;

/// Rate of pictures of the mouth, hertz.
const FRAMES_PER_S: f64 = 30.0;

/// Result of a review.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ReviewReport {
    /// Path of the file.
    #[serde(serialize_with = "sulcus_program::path::text")]
    pub out: PathBuf,
    /// Length of the file, bytes.
    pub bytes: u64,
    /// Number of ticks.
    pub ticks: u64,
    /// Number of pictures of the mouth.
    pub frames: u64,
    /// Number of shapes of tissue that is not at rest.
    pub shapes: u64,
    /// Number of lines of the log.
    pub events: u64,
    /// Whether the replay is identical to the record. A recording of a former version may differ.
    pub identical: bool,
    /// Fault of the recording itself ([`sulcus_sessions::ReplayReport::unsound`]).
    pub unsound: Option<String>,
    /// Longest tick of the session, CPU time, microseconds; `None` without channels for viewers.
    pub longest_tick_us: Option<f64>,
    /// Number of rows with a time, by entity.
    pub rows: BTreeMap<String, u64>,
}

/// Reason why no review was written.
#[derive(Debug, thiserror::Error)]
pub enum ReviewError {
    /// The recording cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The recording cannot be replayed.
    #[error(transparent)]
    Replay(#[from] ReplayError),
    /// The replay differs from the record.
    #[error(
        "the replay differs from tick {tick} on ({what:?}), so a review would not show the recorded session; `replay` reports the differences"
    )]
    Differs {
        /// First tick that differs.
        tick: u64,
        /// Kind of the first difference.
        what: Difference,
    },
    /// The window is outside of the session.
    #[error("window is {from_s} s to {}, expected a part of the session, {first_s} s to {last_s} s", if to_s.is_finite() { format!("{to_s} s") } else { "the end".into() })]
    Empty {
        /// Requested start, seconds.
        from_s: f64,
        /// Requested end, seconds.
        to_s: f64,
        /// Start of the recording, seconds.
        first_s: f64,
        /// End of the recording, seconds.
        last_s: f64,
    },
    /// The file cannot be written.
    #[error(transparent)]
    View(#[from] ViewError),
    /// The system cannot write the file.
    #[error("cannot write `{}`: {source}", path.shown())]
    Io {
        /// Path of the file.
        path: PathBuf,
        /// Error of the system.
        source: std::io::Error,
    },
}

/// Replays a recording and writes the review of `window` to `out`. `slider` is the position of the slider when the file
/// is opened. `progress` gets the number of finished ticks from time to time. The file appears at `out` only when it is
/// complete.
///
/// # Errors
/// The recording cannot be replayed, its replay differs, the window is outside of the session, or the file cannot be
/// written.
pub fn review(
    recording: &Recording,
    out: &Path,
    window: Window,
    slider: Slider,
    progress: &mut dyn FnMut(u64),
) -> Result<ReviewReport, ReviewError> {
    let scene = recording.scene()?;
    let exercise = Exercise::recorded(&recording.header().exercise);
    let story = Story::read(recording)?;
    let whole = span(recording, &scene);
    if !(whole.from_s <= window.to_s && window.from_s <= whole.to_s) {
        return Err(ReviewError::Empty {
            from_s: window.from_s,
            to_s: window.to_s,
            first_s: whole.from_s,
            last_s: whole.to_s,
        });
    }
    let begun = Begun(beside(out));
    let picture = ReviewPicture {
        slider,
        span_ns: [whole.from_s.max(window.from_s), whole.to_s.min(window.to_s)]
            .map(|seconds| (seconds * 1e9).round() as i64),
        ..picture::of(recording, &scene, &exercise)
    };
    let times = longest_tick_us(recording)?;
    let longest_tick_us = times.values().copied().reduce(f64::max);
    let file = ReviewFile::create(&begun.0, picture)?;
    let mut take = Take {
        every: frames_every(&scene),
        eyes: Eyes::new(&scene, times),
        tissues: Tissues::new(&scene),
        file,
        window,
        next_frame: 0,
        counts: (0, 0),
        zone: None,
        side: None,
        failed: None,
    };
    let options = ReplayOptions::default();
    let report = replay_observed(
        recording,
        &options,
        progress,
        &mut |scene, input, output, ws| {
            if take.failed.is_none() {
                take.failed = take.tick(scene, input, output, ws).err();
            }
        },
    )?;
    let Take {
        mut file,
        tissues,
        counts: (ticks, frames),
        failed,
        ..
    } = take;
    if let (Some(tick), Some(divergence), false) = (
        report.first_divergent_tick,
        &report.divergence,
        report.is_close(),
    ) {
        let what = divergence.what;
        return Err(ReviewError::Differs { tick, what });
    }
    if let Some(error) = failed {
        return Err(error.into());
    }
    let events = story.tell(&mut file, &scene, window);
    let rows = file.finish()?;
    let failed = |path: &Path| {
        let path = path.to_owned();
        move |source| ReviewError::Io { path, source }
    };
    let bytes = std::fs::metadata(&begun.0).map_err(failed(&begun.0))?.len();
    std::fs::rename(&begun.0, out).map_err(failed(out))?;
    Ok(ReviewReport {
        out: out.to_owned(),
        bytes,
        ticks,
        frames,
        shapes: tissues.shapes(),
        events,
        identical: report.identical,
        unsound: report.unsound(),
        longest_tick_us,
        rows,
    })
}

/// Number of ticks from one picture of the mouth to the next.
fn frames_every(scene: &Scene) -> u64 {
    (1.0 / (FRAMES_PER_S * scene.tick_s())).round().max(1.0) as u64
}

/// First and last tick of a recording, in seconds of the session.
fn span(recording: &Recording, scene: &Scene) -> Window {
    let (first, last) = recording.facts().ticks.unwrap_or_default();
    Window {
        from_s: first as f64 * scene.tick_s(),
        to_s: last as f64 * scene.tick_s(),
    }
}

/// Path of the incomplete file, in the same folder.
fn beside(out: &Path) -> PathBuf {
    let mut name = out.file_name().unwrap_or_default().to_owned();
    name.push(".part");
    out.with_file_name(name)
}

/// Incomplete file, which is removed when dropped. A complete file has been renamed before.
struct Begun(PathBuf);

impl Drop for Begun {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

/// State of a review during the replay.
struct Take {
    file: ReviewFile,
    window: Window,
    every: u64,
    next_frame: u64,
    eyes: Eyes,
    tissues: Tissues,
    /// Number of ticks and of frames.
    counts: (u64, u64),
    /// Last zone of force.
    zone: Option<ForceZone>,
    /// Gingiva and side with named sites.
    side: Option<(u16, bool)>,
    failed: Option<ViewError>,
}

impl Take {
    fn tick(
        &mut self,
        scene: &Scene,
        input: &TickInput,
        output: &TickOutput,
        ws: &Workspace,
    ) -> Result<(), ViewError> {
        let shown = self.window.holds(output.tick as f64 * scene.tick_s());
        let frame = output.tick >= self.next_frame;
        if frame {
            self.next_frame = (output.tick / self.every + 1) * self.every;
            // The frame also follows the hand before the window, so that its motion is smooth.
            self.eyes
                .follow(scene, output, self.every as f64 * scene.tick_s());
        }
        if !shown {
            return Ok(());
        }
        let at = moment(scene, output.tick);
        self.counts.0 += 1;
        self.file
            .tick(at, &self.eyes.numbers(scene, input, output))?;
        let zone = self.eyes.zone(output);
        if zone != self.zone {
            let name = zone.map_or(String::new(), |zone| zone_name(zone).replace('_', " "));
            self.file.state(at, Lane::Zone, &name);
            self.zone = zone;
        }
        // The texts stay until the tip is at another side.
        let side = self.eyes.side(scene, output);
        if let Some((object, buccal)) = side.filter(|_| side != self.side) {
            self.file.sites(at, &picture::sites(scene, object, buccal));
            self.side = side;
        }
        if frame {
            self.counts.1 += 1;
            self.file
                .frame(at, &self.eyes.frame(scene, input, output, ws))?;
            self.tissues.frame(scene, ws, at, &mut self.file)?;
        }
        Ok(())
    }
}
