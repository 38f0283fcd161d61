//! Folder of recordings and room on its disk.

use std::path::{Path, PathBuf};

use sulcus_program::PathText;
use sulcus_sessions::ViewersPolicy;

use super::Finding;
use super::plans::StationLoad;
use crate::station::quota::{Quota, bytes_per_hour, gb};

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
pub(super) fn room(
    folder: &Path,
    viewers: ViewersPolicy,
    loads: &[StationLoad],
    stations: usize,
    hours: f64,
) -> Finding {
    let Some(at) = nearest(folder) else {
        return Finding::problem("disk", "The disk of the recordings is unknown.", "");
    };
    match rustix::fs::statvfs(&at) {
        Ok(disk) => {
            let free = disk.f_bavail as f64 * disk.f_frsize as f64;
            room_of(free, viewers, loads, stations, hours)
        }
        Err(error) => Finding::warning(
            "disk",
            format!("The free space of {} is unknown: {error}.", at.shown()),
            "Look at the free space by hand.",
        ),
    }
}

/// Finding for a number of free bytes. A station of `stations` without a known load counts with two hands.
pub(super) fn room_of(
    free: f64,
    viewers: ViewersPolicy,
    loads: &[StationLoad],
    stations: usize,
    hours: f64,
) -> Finding {
    let unknown = stations.saturating_sub(loads.len()) as f64 * bytes_per_hour(viewers, 2, 1000);
    let all_per_hour = loads
        .iter()
        .map(|load| per_hour(viewers, load))
        .fold(unknown, |sum, one| sum + one);
    let needed = all_per_hour * hours;
    let text = format!(
        "{} for {hours} h: {:.1} GB needed, {:.1} GB free.",
        super::number(stations, "station"),
        needed / 1e9,
        free / 1e9
    );
    if needed <= free {
        return Finding::ok("disk", text);
    }
    let advice = if all_per_hour > 0.0 {
        let policy = match viewers {
            ViewersPolicy::Recorded => "; --viewers on-demand needs about half",
            ViewersPolicy::OnDemand => "",
        };
        format!(
            "Free space, or plan at most {:.1} h; --recordings names a folder on another disk{policy}.",
            free / all_per_hour
        )
    } else {
        "Free space.".to_owned()
    };
    Finding::problem("disk", text, advice)
}

/// Bytes that a station records in an hour.
fn per_hour(viewers: ViewersPolicy, station: &StationLoad) -> f64 {
    bytes_per_hour(viewers, station.tools, station.load.rate_hz)
}

/// Rest of the folder's quota, for the planned hours of all stations.
pub(super) fn quota(
    folder: &Path,
    quota: Option<u64>,
    viewers: ViewersPolicy,
    loads: &[StationLoad],
    hours: f64,
) -> Finding {
    let Some(most) = quota else {
        return Finding::ok(
            "quota",
            "The recordings have no quota: recordings_quota_gb of the file of stations sets one.",
        );
    };
    // The start makes a missing folder.
    let (used, left) = match folder.is_dir() {
        true => {
            let quota = Quota::new(folder, most);
            (quota.used(), quota.left())
        }
        false => (0, most),
    };
    let needed = loads
        .iter()
        .map(|load| per_hour(viewers, load))
        .sum::<f64>()
        * hours;
    let text = format!(
        "Quota of the recordings: {} used, {} left of {}.",
        gb(used),
        gb(left),
        gb(most)
    );
    let advice = "Raise recordings_quota_gb, or remove recordings: `sulcus-server class expire`.";
    if left == 0 {
        Finding::problem("quota", text, advice)
    } else if needed > left as f64 {
        let more = format!("{text} The planned {hours} h need {}.", gb(needed as u64));
        Finding::warning("quota", more, advice)
    } else {
        Finding::ok("quota", text)
    }
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
