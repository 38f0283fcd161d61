//! Export of a recording for other programs: ticks, events and samples of devices as tables, deformed meshes. Ticks and
//! meshes come from a replay, so they are exact and the recording need not contain them.

pub mod cells;
mod devices;
mod error;
mod events;
mod mesh_file;
mod meshes;
mod options;
mod table;
mod ticks;

use std::path::Path;

use serde::Serialize;

use crate::record::message::Message;
use crate::record::read::Recording;
use crate::record::row::Row;
use crate::record::viewers::is_sum;
use crate::replay::{ReplayError, ReplayOptions, replay_observed};

pub use error::ExportError;
pub use mesh_file::MeshFormat;
pub use options::ExportOptions;

use devices::DeviceTable;
use error::create_folder;
use events::EventTable;
use meshes::Meshes;
use ticks::TickTable;

/// Result of an export.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Exported {
    /// Ticks replayed.
    pub ticks: u64,
    /// Lines of `ticks.csv`, without the head.
    pub tick_lines: u64,
    /// Lines of `events.csv`, without the head and without the hash over the channels for viewers.
    pub event_lines: u64,
    /// Lines of `devices.csv`, without the head. Without a sample there is no such table.
    pub device_lines: u64,
    /// Number of times with meshes.
    pub mesh_frames: u64,
    /// Number of mesh files.
    pub mesh_files: u64,
    /// Whether the replay is identical to the record. The export is always of the replay.
    pub identical: bool,
    /// Whether the replay differs only as a recording of a former version may ([`crate::ReplayReport::is_close`]).
    pub close: bool,
    /// First tick that differs.
    pub first_divergent_tick: Option<u64>,
    /// Fault of the recording itself ([`crate::ReplayReport::unsound`]). The lines of `events.csv` come from the
    /// recording.
    pub unsound: Option<String>,
}

/// Replays a recording and writes the requested files into `folder`, which is made. `progress` gets the number of
/// finished ticks from time to time.
///
/// # Errors
/// The recording cannot be replayed, or a file exists or cannot be written.
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
        let mut devices = match recording.facts().device_samples {
            0 => None,
            _ => Some(DeviceTable::create(folder, &scene, began)?),
        };
        for message in recording.messages() {
            match message.map_err(ReplayError::from)? {
                Message::Event(event) if !is_sum(&event.text) => events.line(&event)?,
                Message::Row(row) => devices.as_mut().map_or(Ok(()), |table| table.row(&row))?,
                _ => {}
            }
        }
        exported.event_lines = events.finish()?;
        exported.device_lines = devices.map_or(Ok(0), DeviceTable::finish)?;
        let ticks = TickTable::create(folder, &scene, began, options.every_ticks)?;
        Some(ticks)
    } else {
        None
    };
    let mut meshes = match options.meshes {
        Some(format) => Some(Meshes::create(folder, &scene, format, options)?),
        None => None,
    };
    // The replay gives the output of a tick. Its time is in the row, which is read in parallel.
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
