//! A recorded session for the eye: replayed, and written as a file for the Rerun viewer.
//!
//! Everything shown comes from the replay, so that it is what happened: a recording whose replay differs is not shown,
//! unless it is of a former version and stays close to it. What a client or the exercise said comes from the log.

mod follow;
mod frame;
mod picture;
mod tissue;
mod words;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::{Lane, Moment, ReviewFile, ReviewPicture, ViewError};
use serde::Serialize;
use sulcus_core::output::ForceZone;
use sulcus_core::{Scene, TickInput, TickOutput, Workspace};
use sulcus_program::PathText;

pub use crate::Slider;

use sulcus_sessions::exercise::Exercise;
use sulcus_sessions::record::occurrence::zone_name;
use sulcus_sessions::record::read::{ReadError, Recording};
use sulcus_sessions::record::times::longest_tick_us;
use sulcus_sessions::replay::{Difference, ReplayError, ReplayOptions, replay_observed};

use frame::Eyes;
use tissue::Tissues;
use words::Story;

/// Pictures of the mouth a second.
const FRAMES_PER_S: f64 = 30.0;

/// Which part of a session is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// From when, seconds of the session.
    pub from_s: f64,
    /// Up to when.
    pub to_s: f64,
}

impl Window {
    /// All of it.
    pub const ALL: Self = Self {
        from_s: 0.0,
        to_s: f64::INFINITY,
    };

    fn holds(&self, time_s: f64) -> bool {
        (self.from_s..=self.to_s).contains(&time_s)
    }
}

/// What was written.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ReviewReport {
    /// The file.
    #[serde(serialize_with = "sulcus_program::path::text")]
    pub out: PathBuf,
    /// Its length, bytes.
    pub bytes: u64,
    /// Ticks shown.
    pub ticks: u64,
    /// Pictures of the mouth.
    pub frames: u64,
    /// Shapes of tissue that is not at rest.
    pub shapes: u64,
    /// Lines of the log shown.
    pub events: u64,
    /// Whether the replay that it shows is the recorded session bit for bit; it need not be where the recording is of a former version.
    pub identical: bool,
    /// What is wrong with the recording itself ([`sulcus_sessions::ReplayReport::unsound`]).
    pub unsound: Option<String>,
    /// Longest tick of the session, CPU time, microseconds; none in a recording without channels for viewers.
    pub longest_tick_us: Option<f64>,
    /// Rows that have a time, by entity.
    pub rows: BTreeMap<String, u64>,
}

/// Why there is nothing to look at.
#[derive(Debug, thiserror::Error)]
pub enum ReviewError {
    /// The recording cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// It cannot be replayed.
    #[error(transparent)]
    Replay(#[from] ReplayError),
    /// Its replay is not what was recorded.
    #[error(
        "the replay differs from tick {tick} on ({what:?}): a review would show what did not happen; `replay` says more"
    )]
    Differs {
        /// First tick that differs.
        tick: u64,
        /// What differs first.
        what: Difference,
    },
    /// Nothing of it lies in the window.
    #[error("nothing from {from_s} s to {}: the session runs from {first_s} s to {last_s} s", if to_s.is_finite() { format!("{to_s} s") } else { "its end".into() })]
    Empty {
        /// From when was asked for, seconds.
        from_s: f64,
        /// Up to when.
        to_s: f64,
        /// When the recording begins.
        first_s: f64,
        /// When it ends.
        last_s: f64,
    },
    /// The file cannot be written.
    #[error(transparent)]
    View(#[from] ViewError),
    /// The system refused.
    #[error("cannot write `{}`: {source}", path.shown())]
    Io {
        /// Which file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
}

/// Replays a recording and writes what can be seen of it within `window` to `out`, to be opened with the
/// slider there; `progress` is told the number of ticks
/// done, now and then. The file is there when all of it is, and not before.
///
/// # Errors
/// When the recording cannot be replayed or its replay differs, nothing lies in the window, or the file cannot be written.
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

/// Ticks from one picture of the mouth to the next.
fn frames_every(scene: &Scene) -> u64 {
    (1.0 / (FRAMES_PER_S * scene.tick_s())).round().max(1.0) as u64
}

fn moment(scene: &Scene, tick: u64) -> Moment {
    Moment {
        tick: tick as i64,
        session_ns: (tick as f64 * scene.tick_s() * 1e9).round() as i64,
    }
}

/// First and last tick of a recording, in the session's seconds.
fn span(recording: &Recording, scene: &Scene) -> Window {
    let (first, last) = recording.facts().ticks.unwrap_or_default();
    Window {
        from_s: first as f64 * scene.tick_s(),
        to_s: last as f64 * scene.tick_s(),
    }
}

/// A file of its own in the same folder, until all is there.
fn beside(out: &Path) -> PathBuf {
    let mut name = out.file_name().unwrap_or_default().to_owned();
    name.push(".part");
    out.with_file_name(name)
}

/// What was begun is no use unless it is finished, and then it has another name.
struct Begun(PathBuf);

impl Drop for Begun {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

/// A replay as it is looked at.
struct Take {
    file: ReviewFile,
    window: Window,
    every: u64,
    next_frame: u64,
    eyes: Eyes,
    tissues: Tissues,
    /// Ticks and frames shown.
    counts: (u64, u64),
    /// Zone of force shown.
    zone: Option<ForceZone>,
    /// Gingiva and side whose sites are named.
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
            // Also before the window: it follows the hand smoothly.
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
        // The names stay until the tip is elsewhere.
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
