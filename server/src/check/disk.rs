//! Folder of recordings and room on its disk.

use std::path::{Path, PathBuf};

use sulcus_program::PathText;

use super::Finding;
use super::plans::StationLoad;

/// Bytes of an hour of a station with two hands at 1 kHz, measured with viewers' channels in the whole mouth.
const TWO_HANDS_PER_HOUR: f64 = 1.2e9;
/// Bytes of an hour of a station with one hand at 1 kHz: exact record and half of the largest viewers' channels.
const ONE_HAND_PER_HOUR: f64 = 0.7e9;

/// Whether recordings can be written into the folder.
pub(super) fn recordings(folder: &Path) -> Finding {
    let advice = "Correct the rights of the folder, or choose another one with --recordings.";
    match is_writable_or_can_be(folder) {
        Ok(()) => Finding::ok(
            "recordings",
            format!("Recordings can be written to {}.", folder.shown()),
        ),
        Err(why) => Finding::problem(
            "recordings",
            format!("Recordings cannot be written to {}: {why}.", folder.shown()),
            advice,
        ),
    }
}

/// Whether the disk has room for the planned hours of all stations.
pub(super) fn room(folder: &Path, loads: &[StationLoad], stations: usize, hours: f64) -> Finding {
    let Some(at) = nearest(folder) else {
        return Finding::problem("disk", "The disk of the recordings is unknown.", "");
    };
    match rustix::fs::statvfs(&at) {
        Ok(disk) => {
            let free = disk.f_bavail as f64 * disk.f_frsize as f64;
            room_of(free, loads, stations, hours)
        }
        Err(error) => Finding::warning(
            "disk",
            format!("The free space of {} is unknown: {error}.", at.shown()),
            "Look at the free space by hand.",
        ),
    }
}

/// Finding for a number of free bytes. A station of `stations` without a known load counts with two hands.
pub(super) fn room_of(free: f64, loads: &[StationLoad], stations: usize, hours: f64) -> Finding {
    let unknown = stations.saturating_sub(loads.len()) as f64 * TWO_HANDS_PER_HOUR;
    let per_hour = loads
        .iter()
        .map(bytes_per_hour)
        .fold(unknown, |sum, one| sum + one);
    let needed = per_hour * hours;
    let text = format!(
        "{} for {hours} h: {:.1} GB needed, {:.1} GB free.",
        super::number(stations, "station"),
        needed / 1e9,
        free / 1e9
    );
    if needed <= free {
        return Finding::ok("disk", text);
    }
    let advice = if per_hour > 0.0 {
        format!(
            "Free space, or plan at most {:.1} h; --recordings names a folder on another disk.",
            free / per_hour
        )
    } else {
        "Free space.".to_owned()
    };
    Finding::problem("disk", text, advice)
}

/// Bytes that a station records in an hour; the exact record grows with the rate.
fn bytes_per_hour(station: &StationLoad) -> f64 {
    let at_1_khz = if station.tools > 1 {
        TWO_HANDS_PER_HOUR
    } else {
        ONE_HAND_PER_HOUR
    };
    at_1_khz * (f64::from(station.load.rate_hz) / 1000.0).max(1.0)
}

/// Whether files can be made in a folder, or the folder can be made.
///
/// # Errors
/// The reason, without a full stop.
pub(super) fn is_writable_or_can_be(folder: &Path) -> Result<(), String> {
    let at = nearest(folder).ok_or("no folder above it exists")?;
    if !at.is_dir() {
        return Err(format!("{} is no folder", at.shown()));
    }
    // The rights alone do not tell of a disk that is mounted for reading.
    let probe = at.join(format!(".sulcus-check-{}", std::process::id()));
    let made = std::fs::OpenOptions::new()
        .write(true)
        .create_new(true)
        .open(&probe);
    let _ = std::fs::remove_file(&probe);
    made.map(|_| ())
        .map_err(|error| format!("{}: {error}", at.shown()))
}

/// The folder, or the nearest one above it that exists.
fn nearest(folder: &Path) -> Option<PathBuf> {
    let absolute = std::path::absolute(folder).ok()?;
    let found = absolute.ancestors().find(|above| above.exists())?;
    Some(found.to_owned())
}
