//! Present plans of all stations of a server.

use std::path::Path;

use serde::{Deserialize, Serialize};
use sulcus_sessions::Mode;

use super::change::PlanChange;
use super::error::{PlanError, content};
use super::names::is_station_name;
use super::revision::Revision;
use super::stations::Station;
use super::{Plan, fields};
use crate::state::{StateError, StateFolder, read_private, write_private};

/// Folder of plans in the state folder.
const FOLDER: &str = "plans";
/// Version of the layout of a plan's file.
const VERSION: u32 = 1;
/// Largest file that is read, bytes.
const MOST_BYTES: u64 = 256 * 1024;
/// Number of former revisions that are kept.
const MOST_HISTORY: usize = 100;

/// Session that runs at a station.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Running {
    /// Mode of the session's own plan.
    pub mode: Mode,
}

/// Plan of a station with its origin, for display.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StationPlan {
    /// Name of the station.
    pub station: String,
    /// Plan of the next session.
    pub plan: Plan,
    /// State of the plan.
    pub revision: Revision,
    /// Former states, oldest first.
    pub history: Vec<Revision>,
    /// Whether the plan was set at run time and differs in origin from the file.
    pub is_set: bool,
    /// When the plan takes effect, a sentence.
    pub effect: String,
}

/// Plans of all stations. The owner serialises access, for example by a mutex.
#[derive(Debug)]
pub struct PlanBook {
    /// Place of plans that were set at run time; `None` keeps them in memory alone.
    folder: Option<StateFolder>,
    entries: Vec<Entry>,
}

#[derive(Debug)]
struct Entry {
    station: String,
    /// Plan of the file or the command line.
    given: Plan,
    /// Plan set at run time.
    set: Option<Plan>,
    revision: Revision,
    history: Vec<Revision>,
}

/// Layout of a plan's file in the state folder.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Stored {
    version: u32,
    station: String,
    revision: Revision,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    history: Vec<Revision>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    plan: Option<Plan>,
}

impl PlanBook {
    /// Plans of `stations`. A plan that was set at run time and is kept in `folder` replaces the given one.
    ///
    /// # Errors
    /// A kept plan cannot be read or is not valid.
    pub fn open(stations: &[Station], folder: Option<&StateFolder>) -> Result<Self, PlanError> {
        let folder = folder.map(|state| state.inside(FOLDER)).transpose()?;
        let mut entries = Vec::with_capacity(stations.len());
        for station in stations {
            let mut entry = Entry {
                station: station.name.clone(),
                given: station.plan.clone(),
                set: None,
                revision: Revision::first(),
                history: Vec::new(),
            };
            if let Some(folder) = &folder
                && let Some(stored) = load(folder, &station.name)?
            {
                entry.set = stored.plan;
                entry.revision = stored.revision;
                entry.history = stored.history;
            }
            entries.push(entry);
        }
        Ok(Self { folder, entries })
    }

    /// Names of the stations with a kept plan, in alphabetical order. Files with other names are ignored.
    ///
    /// # Errors
    /// The folder of plans cannot be listed.
    pub fn kept(state: &StateFolder) -> Result<Vec<String>, PlanError> {
        let path = state.file(FOLDER);
        let entries = match std::fs::read_dir(&path) {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(Vec::new()),
            entries => entries.map_err(StateError::io("list", &path))?,
        };
        let mut names: Vec<String> = entries
            .filter_map(|entry| {
                let name = entry.ok()?.file_name().into_string().ok()?;
                let name = name.strip_suffix(".toml")?;
                is_station_name(name).then(|| name.to_owned())
            })
            .collect();
        names.sort();
        Ok(names)
    }

    /// Whether the plan of a station was set at run time.
    pub fn is_set(&self, station: &str) -> bool {
        let found = self.entries.iter().find(|entry| entry.station == station);
        found.is_some_and(|entry| entry.set.is_some())
    }

    /// Present plan of a station and its revision; `None` for an unknown station.
    pub fn plan(&self, station: &str) -> Option<(&Plan, &Revision)> {
        let entry = self.entries.iter().find(|entry| entry.station == station)?;
        Some((entry.plan(), &entry.revision))
    }

    /// Plans of all stations, in the order of the file. `running` gives the session of a station.
    pub fn all(&self, running: impl Fn(&str) -> Option<Running>) -> Vec<StationPlan> {
        let shown = |entry: &Entry| entry.shown(running(&entry.station));
        self.entries.iter().map(shown).collect()
    }

    /// Changes the plan of a station from its next session on. A change that changes nothing makes no revision.
    ///
    /// # Errors
    /// The station is unknown, an exam runs there, the parts do not fit each other, or the plan cannot be kept. The
    /// plan stays as before then.
    pub fn set(
        &mut self,
        station: &str,
        change: &PlanChange,
        by: &str,
        running: Option<Running>,
        now_ns: u64,
    ) -> Result<StationPlan, PlanError> {
        let entry = self.entry(station)?;
        let plan = entry
            .plan()
            .with(change)
            .map_err(|fault| PlanError::Fault {
                station: station.to_owned(),
                fault,
            })?;
        self.replace(station, Some(plan), by, running, now_ns)
    }

    /// Returns the plan of a station to the plan of the file, from the next session on.
    ///
    /// # Errors
    /// The errors of [`PlanBook::set`].
    pub fn reset(
        &mut self,
        station: &str,
        by: &str,
        running: Option<Running>,
        now_ns: u64,
    ) -> Result<StationPlan, PlanError> {
        self.replace(station, None, by, running, now_ns)
    }

    fn replace(
        &mut self,
        station: &str,
        set: Option<Plan>,
        by: &str,
        running: Option<Running>,
        now_ns: u64,
    ) -> Result<StationPlan, PlanError> {
        if running.is_some_and(|session| session.mode == Mode::Exam) {
            return Err(PlanError::ExamRuns {
                station: station.to_owned(),
            });
        }
        let folder = self.folder.clone();
        let entry = self.entry(station)?;
        let new = set.as_ref().unwrap_or(&entry.given);
        let fields = new.differences(entry.plan());
        if fields.is_empty() && set.is_some() == entry.set.is_some() {
            return Ok(entry.shown(running));
        }
        let mut changed = Entry {
            station: entry.station.clone(),
            given: entry.given.clone(),
            set,
            revision: entry.revision.next(by, fields, now_ns),
            history: entry.history.clone(),
        };
        changed.history.push(entry.revision.clone());
        let surplus = changed.history.len().saturating_sub(MOST_HISTORY);
        changed.history.drain(..surplus);
        if let Some(folder) = &folder {
            changed.keep(folder)?;
        }
        *entry = changed;
        Ok(entry.shown(running))
    }

    fn entry(&mut self, station: &str) -> Result<&mut Entry, PlanError> {
        let names = || {
            let names: Vec<&str> = self.entries.iter().map(|e| e.station.as_str()).collect();
            names.join(", ")
        };
        match self
            .entries
            .iter()
            .position(|entry| entry.station == station)
        {
            Some(at) => Ok(&mut self.entries[at]),
            None => Err(PlanError::Unknown {
                found: station.escape_debug().to_string(),
                known: names(),
            }),
        }
    }
}

impl Entry {
    fn plan(&self) -> &Plan {
        self.set.as_ref().unwrap_or(&self.given)
    }

    fn shown(&self, running: Option<Running>) -> StationPlan {
        let effect = match running {
            None => "takes effect with the next session",
            Some(Running { mode: Mode::Exam }) => {
                "an exam runs, and the plan cannot be changed until its session has ended"
            }
            Some(_) => "takes effect with the session after the running one",
        };
        StationPlan {
            station: self.station.clone(),
            plan: self.plan().clone(),
            revision: self.revision.clone(),
            history: self.history.clone(),
            is_set: self.set.is_some(),
            effect: effect.to_owned(),
        }
    }

    fn keep(&self, folder: &StateFolder) -> Result<(), PlanError> {
        let stored = Stored {
            version: VERSION,
            station: self.station.clone(),
            revision: self.revision.clone(),
            history: self.history.clone(),
            plan: self.set.clone(),
        };
        let path = folder.file(&format!("{}.toml", self.station));
        let text = toml::to_string(&stored)
            .map_err(|error| StateError::content(&path, error.to_string()))?;
        let text =
            format!("# Plan set at run time. Change it with `sulcus-server plan set`.\n{text}");
        Ok(write_private(&path, text.as_bytes())?)
    }
}

/// Kept plan of a station; `None` if none was set.
fn load(folder: &StateFolder, station: &str) -> Result<Option<Stored>, PlanError> {
    debug_assert!(is_station_name(station), "checked by the file of stations");
    let path = folder.file(&format!("{station}.toml"));
    match read_private(&path, MOST_BYTES)? {
        Some(bytes) => parse(&bytes, &path, station).map(Some),
        None => Ok(None),
    }
}

fn parse(bytes: &[u8], path: &Path, station: &str) -> Result<Stored, PlanError> {
    let wrong = |why: String| StateError::content(path, why);
    let text = std::str::from_utf8(bytes).map_err(|_| wrong("no text, expected a plan".into()))?;
    let stored: Stored = crate::exact::read(text).map_err(|error| content(path, text, &error))?;
    if stored.version != VERSION {
        let found = stored.version;
        let why = format!(
            "version is {found}, expected {VERSION}; install the program that wrote the file"
        );
        return Err(wrong(why).into());
    }
    if stored.station != station {
        let found = stored.station.escape_debug();
        let why =
            format!("station is `{found}`, expected `{station}`; files of plans cannot be renamed");
        return Err(wrong(why).into());
    }
    Ok(stored)
}

impl StationPlan {
    /// Lines for people: station, plan, revision.
    pub fn lines(&self) -> String {
        let plan = &self.plan;
        let mut text = format!(
            "{}: exercise {}, mode {}",
            self.station, plan.exercise, plan.mode
        );
        let mut part = |name: &str, value: Option<String>| {
            if let Some(value) = value {
                text.push_str(&format!(", {name} {value}"));
            }
        };
        use sulcus_program::PathText as _;
        part(
            "scene",
            plan.scene.as_ref().map(|path| path.shown().to_string()),
        );
        part(
            "patient seed",
            plan.patient_seed.map(|seed| seed.to_string()),
        );
        part("rate", plan.rate_hz.map(|rate| format!("{rate} Hz")));
        part(
            "learner",
            (!plan.learner.is_empty()).then(|| plan.learner.clone()),
        );
        part(
            "rubric",
            plan.rubric.as_ref().map(|path| path.shown().to_string()),
        );
        part(
            "time limit",
            plan.time_limit_s.map(|limit| format!("{limit} s")),
        );
        part(
            "resumed within",
            Some(format!("{} s", plan.resume_within_s)),
        );
        let clock = match plan.clock_in_gap {
            fields::ClockInGap::Runs => "runs",
            fields::ClockInGap::Stops => "stops",
        };
        part("clock in a gap", Some(clock.into()));
        part(
            "force limit",
            plan.force_limit_n.map(|limit| format!("{limit} N")),
        );
        let at_hand = plan.tick_at_hand;
        let ends = at_hand.map(|may| if may { "server or hand" } else { "server" });
        part("ticks at", ends.map(str::to_owned));
        part(
            "detail budget",
            plan.detail_budget_us.map(|budget| format!("{budget} us")),
        );
        let changes = self.history.len();
        text.push_str(&format!("\n  {}; {}", self.revision, self.effect));
        if changes > 1 {
            text.push_str(&format!("; {changes} changes in all"));
        }
        text
    }
}
