//! A recording as files for other programs: the ticks and the events as tables, the meshes as they were deformed. All of it
//! comes from a replay, so it is exact, and the recording need not hold it.

pub(crate) mod cells;
mod events;
mod mesh_file;
mod meshes;
mod ticks;

use std::path::{Path, PathBuf};

use serde::Serialize;
use sulcus_program::{PathText, disk};

use crate::record::message::Message;
use crate::record::read::Recording;
use crate::record::row::Row;
use crate::record::viewers::Sum;
use crate::replay::{ReplayError, ReplayOptions, replay_observed};

pub use mesh_file::MeshFormat;

use events::EventTable;
use meshes::Meshes;
use ticks::TickTable;

/// What to write.
#[derive(Clone, Debug, PartialEq)]
pub struct ExportOptions {
    /// Tables `ticks.csv` and `events.csv`.
    pub tables: bool,
    /// Every so many ticks a line of `ticks.csv`.
    pub every_ticks: u64,
    /// Meshes, in this format.
    pub meshes: Option<MeshFormat>,
    /// When: seconds from the first row.
    pub at_s: Vec<f64>,
    /// And every so many seconds.
    pub every_s: Option<f64>,
}

/// What was written.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Exported {
    /// Ticks replayed.
    pub ticks: u64,
    /// Lines of `ticks.csv`, without its head.
    pub tick_lines: u64,
    /// Lines of `events.csv`, without its head (nor the hash over what viewers read, which is no event).
    pub event_lines: u64,
    /// Times at which meshes were written.
    pub mesh_frames: u64,
    /// Mesh files.
    pub mesh_files: u64,
    /// Whether the replay gave what was recorded; if not, this is what the replay gave.
    pub identical: bool,
    /// Whether it did not for no other reason than that the recording is of a former version ([`crate::ReplayReport::is_close`]).
    pub close: bool,
    /// The first tick that it did not.
    pub first_divergent_tick: Option<u64>,
    /// What is wrong with the recording itself ([`crate::ReplayReport::unsound`]): the lines of `events.csv` are its own.
    pub unsound: Option<String>,
}

/// Why nothing, or not all, was written.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The recording cannot be replayed.
    #[error(transparent)]
    Replay(#[from] ReplayError),
    /// A file cannot be written.
    #[error("cannot write `{}`: {source}{}", path.shown(), disk::advice(source))]
    Write {
        /// Which.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A table is not asked for as it can be.
    #[error("{field} is {found}, expected {expected}")]
    Option {
        /// Which.
        field: &'static str,
        /// Its value.
        found: String,
        /// What it must be.
        expected: &'static str,
    },
}

impl ExportError {
    fn write(path: &Path, source: impl Into<std::io::Error>) -> Self {
        Self::Write {
            path: path.to_owned(),
            source: system(source.into()),
        }
    }
}

/// The system's own error, without the table writer's around it: its kind says whether the disk is full.
fn system(source: std::io::Error) -> std::io::Error {
    match source.downcast::<csv::Error>().map(csv::Error::into_kind) {
        Ok(csv::ErrorKind::Io(source)) => source,
        Ok(other) => std::io::Error::other(format!("{other:?}")),
        Err(source) => source,
    }
}

impl ExportOptions {
    fn check(&self) -> Result<(), ExportError> {
        let wrong = |field, found: String, expected| {
            Err(ExportError::Option {
                field,
                found,
                expected,
            })
        };
        if self.every_ticks == 0 {
            return wrong("every_ticks", "0".to_owned(), "1 or more");
        }
        if let Some(at) = self.at_s.iter().find(|at| !(at.is_finite() && **at >= 0.0)) {
            return wrong("at", at.to_string(), "seconds from the first tick on");
        }
        match self.every_s {
            Some(every) if !(every.is_finite() && every > 0.0) => {
                wrong("every", every.to_string(), "more than 0 seconds")
            }
            _ => Ok(()),
        }
    }
}

/// A file of its own: what is there is never overwritten.
fn create(path: &Path) -> Result<std::io::BufWriter<std::fs::File>, ExportError> {
    std::fs::OpenOptions::new()
        .write(true)
        .create_new(true)
        .open(path)
        .map(std::io::BufWriter::new)
        .map_err(|source| ExportError::write(path, source))
}

fn create_folder(path: &Path) -> Result<(), ExportError> {
    std::fs::create_dir_all(path).map_err(|source| ExportError::write(path, source))
}

/// Replays a recording and writes what was asked for into `folder`, which is made; `progress` is told the number of ticks done,
/// now and then.
///
/// # Errors
/// When the recording cannot be replayed, or a file exists or cannot be written.
pub fn export(
    recording: &Recording,
    options: &ExportOptions,
    folder: &Path,
    progress: &mut dyn FnMut(u64),
) -> Result<Exported, ExportError> {
    options.check()?;
    create_folder(folder)?;
    let scene = recording.scene().map_err(ReplayError::from)?;
    let began = recording.facts().times_unix_ns.unwrap_or_default().0;
    let mut exported = Exported::default();
    let mut ticks = if options.tables {
        let mut events = EventTable::create(folder, began)?;
        for message in recording.messages() {
            if let Message::Event(event) = message.map_err(ReplayError::from)?
                && Sum::parse(&event.text).is_none()
            {
                events.line(&event)?;
            }
        }
        exported.event_lines = events.finish()?;
        let ticks = TickTable::create(folder, &scene, began, options.every_ticks)?;
        Some(ticks)
    } else {
        None
    };
    let mut meshes = match options.meshes {
        Some(format) => Some(Meshes::create(folder, &scene, format, options)?),
        None => None,
    };
    // The replay hands out what a tick gave; its row, which knows the time, is read beside it.
    let mut rows = recording.messages().filter_map(|message| match message {
        Ok(Message::Row(row)) => Some(row),
        _ => None,
    });
    let mut failed = None;
    let replay_options = ReplayOptions::default();
    let report = replay_observed(
        recording,
        &replay_options,
        progress,
        &mut |scene, _, output, workspace| {
            // Rows behind a gap and before the next snapshot are not run.
            let next = if recording.gaps().is_empty() {
                rows.next()
            } else {
                rows.find(|row| row.tick == output.tick)
            };
            let Some(row) = next.filter(|_| failed.is_none()) else {
                return;
            };
            let Row { time_unix_ns, .. } = row;
            let seconds = time_unix_ns.saturating_sub(began) as f64 / 1e9;
            let written = match &mut ticks {
                Some(ticks) => ticks.line(&row, output),
                None => Ok(()),
            };
            let written = written.and_then(|()| match &mut meshes {
                Some(meshes) => meshes.tick(seconds, scene, output, workspace),
                None => Ok(()),
            });
            failed = written.err();
        },
    )?;
    if let Some(error) = failed {
        return Err(error);
    }
    if let Some(ticks) = ticks {
        exported.tick_lines = ticks.finish()?;
    }
    if let Some(meshes) = meshes {
        (exported.mesh_frames, exported.mesh_files) = meshes.finish()?;
    }
    exported.ticks = report.ticks;
    exported.identical = report.identical;
    exported.close = report.is_close();
    exported.first_divergent_tick = report.first_divergent_tick;
    exported.unsound = report.unsound();
    Ok(exported)
}
