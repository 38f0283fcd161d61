//! File of stations for `serve --config`: one server, its stations and their plans.
//!
//! ```toml
//! listen = "0.0.0.0:4433"            # may be left out, as all that follows but the stations
//! recordings = "/srv/recordings"     # relative paths are relative to this file's folder
//! viewers = "on-demand"              # channels for viewers: recorded or on-demand
//! recordings_quota_gb = 500          # no session begins that would exceed it
//!
//! [class]
//! name = "2026 autumn"
//! hours = 40                         # planned hours of each station, for the check of the disk
//!
//! [defaults]                         # any parts of a plan, for all stations
//! exercise = "probing"
//! resume_within_s = 60
//!
//! [[station]]
//! name = "room3-1"
//!
//! [[station]]
//! name = "room3-2"
//! plan = { mode = "exam", time_limit_s = 1800 }
//! ```

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use serde::Deserialize;
use serde::de::IgnoredAny;
use sulcus_sessions::ViewersPolicy;

use super::Plan;
use super::change::PlanChange;
use super::error::{PlanError, content, line_of};
use super::fields::{plain, viewers};
use super::names::{EXPECTED, is_station_name};

/// Largest number of stations of one server.
pub const MOST_STATIONS: usize = 64;
/// Largest file that is read, bytes.
const MOST_BYTES: u64 = 256 * 1024;
/// Planned hours of a station unless the file says otherwise. Chosen: a school day.
pub const HOURS: f64 = 8.0;

/// Quotas of the folder of recordings that are valid, gigabytes.
const QUOTA_GB: RangeInclusive<f64> = 0.001..=1_000_000.0;

/// A station and its plan.
#[derive(Clone, Debug, PartialEq)]
pub struct Station {
    /// Name of the station, by [`is_station_name`].
    pub name: String,
    /// Plan of the file.
    pub plan: Plan,
}

/// Stations of a server.
#[derive(Clone, Debug, PartialEq)]
pub struct StationsFile {
    /// UDP address to listen on; `None`: the address of the command line or its default.
    pub listen: Option<String>,
    /// Folder for recordings; `None`: the folder of the command line or its default.
    pub recordings: Option<PathBuf>,
    /// Policy of the recordings about the channels for viewers; `None`: that of the command line or its default.
    pub viewers: Option<ViewersPolicy>,
    /// Bytes that the folder of recordings may have; `None`: no quota.
    pub recordings_quota: Option<u64>,
    /// Name of the class; may be empty.
    pub class: String,
    /// Planned hours of each station.
    pub hours: f64,
    /// Stations in the order of the file, 1 to [`MOST_STATIONS`], with unique names.
    pub stations: Vec<Station>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Raw {
    listen: Option<String>,
    recordings: Option<PathBuf>,
    #[serde(default, deserialize_with = "viewers")]
    viewers: Option<ViewersPolicy>,
    recordings_quota_gb: Option<f64>,
    #[serde(default)]
    class: RawClass,
    #[serde(default)]
    defaults: PlanChange,
    #[serde(default)]
    station: Vec<RawStation>,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct RawClass {
    name: String,
    hours: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawStation {
    name: String,
    #[serde(default)]
    plan: PlanChange,
}

/// Places of the stations in the text, for messages.
#[derive(Deserialize)]
struct Outline {
    #[serde(default)]
    station: Vec<toml::Spanned<IgnoredAny>>,
}

impl StationsFile {
    /// Stations of the file at `path`.
    ///
    /// # Errors
    /// The file cannot be read, or is not valid: file, line, name, value found, value expected.
    pub fn open(path: &Path) -> Result<Self, PlanError> {
        let text = read(path)?;
        Self::parse(&text, path)
    }

    /// Stations of a text. `path` is its name in messages, and its folder has the files that the text names.
    ///
    /// # Errors
    /// The errors of [`StationsFile::open`].
    pub fn parse(text: &str, path: &Path) -> Result<Self, PlanError> {
        let raw: Raw = crate::exact::read(text).map_err(|error| content(path, text, &error))?;
        let wrong = |line: usize, why: String| PlanError::Content {
            path: path.to_owned(),
            line,
            why,
        };
        let line_with = |key: &str| {
            let begins = |line: &str| {
                let rest = line.trim_start().strip_prefix(key);
                rest.is_some_and(|rest| rest.trim_start().starts_with('='))
            };
            text.lines().position(begins).map_or(1, |line| line + 1)
        };
        for (field, value) in [
            ("listen", raw.listen.as_deref()),
            (
                "recordings",
                raw.recordings.as_ref().and_then(|dir| dir.to_str()),
            ),
        ] {
            if let Some(value) = value {
                plain(field, value).map_err(|why| wrong(line_with(field), why))?;
            }
        }
        if raw.class.name.len() > 256 || raw.class.name.contains(char::is_control) {
            let why =
                "class.name is too long or has line feeds, expected at most 256 bytes in one line";
            return Err(wrong(line_with("name"), why.into()));
        }
        let hours = raw.class.hours.unwrap_or(HOURS);
        if !(hours.is_finite() && (0.1..=10_000.0).contains(&hours)) {
            let why = format!("class.hours is {hours}, expected 0.1 to 10000 h");
            return Err(wrong(line_with("hours"), why));
        }
        let quota = raw.recordings_quota_gb;
        if let Some(gb) = quota.filter(|gb| !(gb.is_finite() && QUOTA_GB.contains(gb))) {
            let (least, most) = (QUOTA_GB.start(), QUOTA_GB.end());
            let why = format!("recordings_quota_gb is {gb}, expected {least} to {most} GB");
            return Err(wrong(line_with("recordings_quota_gb"), why));
        }
        let found = raw.station.len();
        if found == 0 || found > MOST_STATIONS {
            let why = format!(
                "station has {found} entries, expected 1 to {MOST_STATIONS} tables `[[station]]`"
            );
            return Err(wrong(1, why));
        }
        // The text is valid, and the outline reads less of it.
        let outline: Vec<usize> = crate::exact::outline::<Outline>(text)
            .map(|outline| outline.station)
            .unwrap_or_default()
            .iter()
            .map(|station| line_of(text, station.span().start))
            .collect();
        let folder = path.parent().unwrap_or(Path::new("."));
        let defaults = raw.defaults.based(folder);
        let mut stations: Vec<Station> = Vec::with_capacity(found);
        for (k, raw) in raw.station.into_iter().enumerate() {
            let line = outline.get(k).copied().unwrap_or(1);
            let name = raw.name;
            if !is_station_name(&name) {
                let why = format!("name is `{}`, expected {EXPECTED}", name.escape_debug());
                return Err(wrong(line, why));
            }
            // Some file systems do not tell capitals apart.
            let same = |other: &Station| other.name.eq_ignore_ascii_case(&name);
            if let Some(first) = stations.iter().position(same) {
                let before = outline.get(first).copied().unwrap_or(1);
                let why =
                    format!("name is `{name}`, expected another name than that of line {before}");
                return Err(wrong(line, why));
            }
            let plan = Plan::of(&defaults)
                .and_then(|plan| plan.with(&raw.plan.based(folder)))
                .map_err(|fault| wrong(line, format!("plan of station `{name}`: {fault}")))?;
            stations.push(Station { name, plan });
        }
        Ok(Self {
            listen: raw.listen,
            recordings: raw.recordings.map(|recordings| folder.join(recordings)),
            viewers: raw.viewers,
            recordings_quota: quota.map(|gb| (gb * 1e9) as u64),
            class: raw.class.name,
            hours,
            stations,
        })
    }
}

impl PlanChange {
    /// Parts of a plan in a text. `path` is its name in messages.
    ///
    /// # Errors
    /// The text is not valid: line, name, value found, value expected.
    pub fn parse(text: &str, path: &Path) -> Result<Self, PlanError> {
        crate::exact::read(text).map_err(|error| content(path, text, &error))
    }

    /// Parts of a plan in a file for `plan set --file`. Relative paths are relative to the file's folder.
    ///
    /// # Errors
    /// The file cannot be read, or is not valid: file, line, name, value found, value expected.
    pub fn open(path: &Path) -> Result<Self, PlanError> {
        let change = Self::parse(&read(path)?, path)?;
        // An absolute path holds for a server with another working folder, too.
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        Ok(change.based(path.parent().unwrap_or(Path::new("."))))
    }
}

fn read(path: &Path) -> Result<String, PlanError> {
    let unread = |source| PlanError::Read {
        path: path.to_owned(),
        source,
    };
    let length = std::fs::metadata(path).map_err(unread)?.len();
    if length > MOST_BYTES {
        let why = format!("{length} bytes long, expected at most 256 KiB");
        return Err(unread(std::io::Error::other(why)));
    }
    std::fs::read_to_string(path).map_err(unread)
}
