//! End of the time for which a class keeps recordings: which sessions go, which stay and why, and the removal.
//!
//! A session is removed only if everything speaks for it: the learner was in one class at its begin, this class has a
//! limit, and the begin in the recording's header is older. An exam before its release, a norm, a session that may go
//! on, and a file without a known learner stay. Grades, sheets and scores of persons always stay.
//!
//! The clock of the machine may be wrong. A clock behind an entry of the audit log or behind a recording is refused. So
//! is a clock that is more than a year ahead of all of them: it would make every recording old.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::path::{Path, PathBuf};

use sulcus_program::PathText;
use sulcus_sessions::record::read::Recording;

use super::index::{Entry, Index, sessions};
use super::norms::Norms;
use super::{GRADES, expired};
use crate::state::audit::Audit;
use crate::state::classes::archive::{Membership, kept_words};
use crate::state::classes::{Classes, Roll};
use crate::state::date::{DAY_S, day, minute};
use crate::state::{StateError, StateFolder};

/// Number of the newest entries of the audit log that are compared with the clock.
const ENTRIES: usize = 500;
/// Longest time without an entry and without a recording that is believed, seconds. Chosen: more than a school year.
const LONGEST_PAUSE_S: u64 = 400 * DAY_S;

/// Reason why recordings cannot be removed.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ExpiryError {
    /// The clock cannot be believed.
    #[error(
        "{0}; nothing is removed. Correct the clock, or give --clock-checked if the clock is right"
    )]
    Clock(String),
    /// A file of the state folder cannot be used.
    #[error(transparent)]
    State(#[from] StateError),
    /// A recording cannot be removed.
    #[error("cannot remove {}: {source}", path.shown())]
    Remove {
        /// Recording.
        path: PathBuf,
        /// Error of the system.
        source: std::io::Error,
    },
}

/// Reason why a session stays.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Kept {
    /// No class had the learner at the begin, or the recording names no learner.
    Unattributed,
    /// The class keeps recordings forever.
    NoLimit,
    /// The limit is not reached.
    Young,
    /// The recording is from the future.
    Future,
    /// An exam that is not released, or that nobody can release.
    Exam,
    /// A norm of its exercise.
    Norm,
    /// The session runs, or was interrupted and may go on.
    Open,
    /// Another session has a recording in common.
    Shared,
}

impl fmt::Display for Kept {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Unattributed => "no class had the learner",
            Self::NoLimit => "the class keeps recordings forever",
            Self::Young => "the limit of the class is not reached",
            Self::Future => "the recording is from the future",
            Self::Exam => "the exam is not released",
            Self::Norm => "the session is a norm",
            Self::Open => "the session runs or may go on",
            Self::Shared => "another session has the same recording",
        })
    }
}

/// A session, and whether its recordings go.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Judged {
    /// Newest recording of the session.
    pub entry: Entry,
    /// Learner to whom the session belongs now.
    pub learner: String,
    /// Recordings of the session, the oldest first.
    pub files: Vec<PathBuf>,
    /// Class and limit in days by which the recordings go, or the reason why they stay.
    pub verdict: Result<(String, u32), Kept>,
}

/// Facts by which sessions are judged.
struct Facts<'a> {
    roll: &'a Roll,
    memberships: Vec<Membership>,
    /// Learners by the name of the recording, where they are other ones than the recording says.
    moved: BTreeMap<String, String>,
    norms: BTreeSet<String>,
    /// Names of the recordings of sessions that may go on.
    open: &'a BTreeSet<String>,
    now_s: u64,
}

impl Facts<'_> {
    fn learner<'a>(&'a self, entry: &'a Entry) -> &'a str {
        let moved = self.moved.get(&file_name(&entry.path));
        moved.map_or(entry.learner.as_str(), String::as_str)
    }

    /// Whether the results of an exam are open to its learners. The exams of both learners count: an entry about
    /// another learner must not open an exam.
    fn is_released(&self, entry: &Entry) -> bool {
        let learners = [entry.learner.as_str(), self.learner(entry)];
        let exams = learners.map(|id| self.roll.exam_of(id, began_s(entry)));
        let mut known = exams.iter().flatten().peekable();
        known.peek().is_some() && known.all(|exam| exam.released.is_some())
    }

    /// Class and limit of a session whose parts are `all`, the newest last.
    fn judge(&self, entry: &Entry, all: &[&Entry]) -> Result<(String, u32), Kept> {
        let learner = self.learner(entry);
        let began = began_s(entry);
        let is_other = |part: &&Entry| self.learner(part) != learner;
        if learner.is_empty() || all.iter().any(is_other) {
            return Err(Kept::Unattributed);
        }
        let is_of = |one: &&Membership| {
            one.learner == learner && (one.from_unix_s..one.until_unix_s).contains(&began)
        };
        let class = self.memberships.iter().find(is_of);
        let class = class.ok_or(Kept::Unattributed)?;
        let days = class.keep_recordings_days.ok_or(Kept::NoLimit)?;
        if all.iter().any(|part| began_s(part) > self.now_s) {
            return Err(Kept::Future);
        }
        if self.now_s - began < u64::from(days) * DAY_S {
            return Err(Kept::Young);
        }
        let is_closed = |part: &&Entry| part.mode == "exam" && !self.is_released(part);
        if all.iter().any(is_closed) {
            return Err(Kept::Exam);
        }
        if all.iter().any(|part| self.norms.contains(&part.id)) {
            return Err(Kept::Norm);
        }
        if all
            .iter()
            .any(|part| self.open.contains(&file_name(&part.path)))
        {
            return Err(Kept::Open);
        }
        Ok((class.class.clone(), days))
    }
}

/// Removal of old recordings from a folder.
pub(crate) struct Expiry<'a> {
    /// State folder.
    pub state: &'a StateFolder,
    /// Folder of recordings.
    pub recordings: &'a Path,
    /// Author: `shell (uid N)`.
    pub by: &'a str,
    /// Names of the recordings of running and of interrupted sessions.
    pub open: BTreeSet<String>,
}

impl Expiry<'_> {
    /// All sessions of the folder, the newest first, each with its verdict. Nothing is changed.
    ///
    /// # Errors
    /// A file of the state folder cannot be read.
    pub fn judged(&self, now_s: u64) -> Result<Vec<Judged>, ExpiryError> {
        let classes = Classes::of(self.state, self.by);
        let roll = classes.roll()?;
        let entries = classes.reassigned()?.into_iter();
        let open = self.with_predecessors();
        let facts = Facts {
            memberships: roll.memberships(),
            roll: &roll,
            // Later entries replace earlier ones.
            moved: entries.map(|one| (one.recording, one.learner)).collect(),
            norms: self.norms()?,
            open: &open,
            now_s,
        };
        let all = Index::default().scan(self.recordings, &BTreeSet::new());
        let by_path: BTreeMap<&Path, &Entry> = all
            .iter()
            .map(|entry| (entry.path.as_path(), entry))
            .collect();
        let mut uses: BTreeMap<PathBuf, usize> = BTreeMap::new();
        let found = sessions(&all);
        for path in found.iter().flat_map(|(_, before)| before) {
            *uses.entry(path.clone()).or_default() += 1;
        }
        let judged = found.into_iter().map(|(entry, before)| {
            let before_it = before.iter().filter_map(|path| by_path.get(path.as_path()));
            let parts: Vec<&Entry> = before_it.copied().chain([&entry]).collect();
            let mut verdict = facts.judge(&entry, &parts);
            if verdict.is_ok()
                && before
                    .iter()
                    .any(|path| uses.get(path).is_some_and(|n| *n > 1))
            {
                verdict = Err(Kept::Shared);
            }
            Judged {
                learner: facts.learner(&entry).to_owned(),
                files: before.into_iter().chain([entry.path.clone()]).collect(),
                verdict,
                entry,
            }
        });
        Ok(judged.collect())
    }

    /// Recordings of sessions that may go on, and those that they continue. The scan leaves out a file that is written.
    fn with_predecessors(&self) -> BTreeSet<String> {
        let mut open = BTreeSet::new();
        for name in &self.open {
            let mut next = Some(name.clone());
            // A name that is there already has been followed.
            while let Some(name) = next.filter(|name| open.insert(name.clone())) {
                let header = Recording::header_of(&self.recordings.join(&name));
                next = header
                    .ok()
                    .and_then(|header| header.predecessor)
                    .map(|one| one.file);
            }
        }
        open
    }

    fn grades(&self) -> PathBuf {
        self.state.file(GRADES)
    }

    fn norms(&self) -> Result<BTreeSet<String>, StateError> {
        let norms = Norms::of(&self.grades()).list()?;
        Ok(norms.into_iter().map(|norm| norm.id).collect())
    }

    /// Compares the clock with the audit log and with the recordings.
    ///
    /// # Errors
    /// The clock is earlier than one of them, or much later than all, or the audit log cannot be read.
    pub fn check_clock(&self, judged: &[Judged], now_s: u64) -> Result<(), ExpiryError> {
        let entries = Audit::of(self.state).newest(ENTRIES)?;
        let entry = entries.iter().map(|entry| entry.unix_s).max();
        let newest = judged.iter().max_by_key(|one| began_s(&one.entry));
        let recording = newest.map(|one| began_s(&one.entry));
        let clock = minute(now_s);
        if let Some(at) = entry.filter(|at| now_s < *at) {
            let why = format!(
                "the clock says {clock}, and the audit log has an entry of {}",
                minute(at)
            );
            return Err(ExpiryError::Clock(why));
        }
        if let (Some(at), Some(one)) = (recording.filter(|at| now_s < *at), newest) {
            let why = format!(
                "the clock says {clock}, and the recording {} is of {}",
                file_name(&one.entry.path),
                minute(at)
            );
            return Err(ExpiryError::Clock(why));
        }
        match entry.max(recording) {
            Some(at) if now_s - at > LONGEST_PAUSE_S => Err(ExpiryError::Clock(format!(
                "the clock says {clock}, and the newest entry or recording is of {}, more than a year before",
                minute(at)
            ))),
            _ => Ok(()),
        }
    }

    /// Removes the recordings of the sessions whose verdict is so. Each removal stands in the audit log before it is
    /// made. Returns the number of removed files.
    ///
    /// # Errors
    /// A file cannot be written or removed; the sessions before it are removed.
    pub fn remove(&self, judged: &[Judged], now_s: u64) -> Result<usize, ExpiryError> {
        let mut removed = 0;
        let audit = Audit::of(self.state);
        for one in judged {
            let Ok((class, days)) = &one.verdict else {
                continue;
            };
            let limit = kept_words(Some(*days));
            let began = day(began_s(&one.entry));
            let ids: Vec<String> = one.files.iter().map(|file| stem(file)).collect();
            // Under the lock of the norms nobody makes the session a norm meanwhile.
            removed += Norms::of(&self.grades()).change(|norms| {
                if norms.iter().any(|norm| ids.contains(&norm.id)) {
                    return Ok(0);
                }
                expired::keep(&self.grades(), &one.entry, now_s)?;
                for path in &one.files {
                    let name = file_name(path);
                    let object = format!(
                        "{name} of {}, class {class}, begun {began}, kept {limit}",
                        one.learner
                    );
                    audit.record(self.by, "expire recording", &object)?;
                    let gone = std::fs::remove_file(path);
                    gone.map_err(|source| ExpiryError::Remove {
                        path: path.clone(),
                        source,
                    })?;
                }
                Ok::<usize, ExpiryError>(one.files.len())
            })??;
        }
        // The entry also tells the next call that the clock went on.
        audit.record(self.by, "expire recordings", &format!("{removed} removed"))?;
        Ok(removed)
    }
}

/// Begin of a recording by its header, seconds since 1970.
pub(crate) fn began_s(entry: &Entry) -> u64 {
    entry.started_unix_ns / 1_000_000_000
}

/// Name of a file without its folder.
pub(crate) fn file_name(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default();
    name.to_string_lossy().into_owned()
}

/// Name of a file without its folder and its ending.
fn stem(path: &Path) -> String {
    let name = path.file_stem().unwrap_or_default();
    name.to_string_lossy().into_owned()
}

#[cfg(test)]
mod tests;
