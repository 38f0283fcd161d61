//! Thread that grades ended sessions, one after another, and keeps the list of sessions up to date.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use serde_json::Value;
use sulcus_console::house::{Grading, Recorded, Revised};
use sulcus_sessions::grade::revision::Sidecar;

use super::child::Job;
use super::store::Store;
use super::{GONE, UNKNOWN};
use crate::recordings::expired::Expired;
use crate::recordings::index::{Entry, Index, sessions};
use crate::state::date::minute;
use crate::station::door::Door;

/// Time between two looks at the folder of recordings.
const LOOK: Duration = Duration::from_secs(2);
/// Niceness of the thread: recordings are read in ordinary priority nowhere.
const NICE: i32 = 10;

/// Data of the thread and of the requests.
pub(super) struct Shared {
    pub recordings: PathBuf,
    pub store: Store,
    pub doors: Vec<Door>,
    /// Public key of the server's recordings.
    pub signer: Option<PathBuf>,
    /// Program that grades, or the reason why there is none.
    pub program: Result<PathBuf, String>,
    pub stop: Arc<AtomicBool>,
    inner: Mutex<Inner>,
    wake: Condvar,
}

#[derive(Default)]
struct Inner {
    index: Index,
    expired: Expired,
    /// Sessions whose recordings were removed at the end of their time.
    gone: BTreeSet<String>,
    sessions: Vec<(Entry, Vec<PathBuf>)>,
    list: Arc<Vec<Recorded>>,
    /// Parts of the grades that the list shows, by id, with the length of the recording.
    told: BTreeMap<String, (u64, Told)>,
    /// Session whose grading runs.
    running: Option<String>,
    /// Reasons of gradings that failed since the start.
    failed: BTreeMap<String, String>,
    /// Sessions that are graded again, before all others.
    again: BTreeSet<String>,
}

/// Part of a grade that the list shows.
#[derive(Clone, Debug, Default)]
struct Told {
    is_made: bool,
    score: Option<f64>,
    passed: Option<bool>,
    seconds: Option<f64>,
    reason: Option<String>,
}

impl Told {
    fn of(grade: &Value) -> Self {
        Self {
            is_made: true,
            score: grade["score"].as_f64(),
            passed: grade["passed"].as_bool(),
            seconds: grade["seconds"].as_f64(),
            reason: grade["reason"].as_str().map(str::to_owned),
        }
    }
}

impl Shared {
    pub fn new(
        recordings: PathBuf,
        store: Store,
        doors: Vec<Door>,
        signer: Option<PathBuf>,
        program: Result<PathBuf, String>,
    ) -> Self {
        Self {
            recordings,
            store,
            doors,
            signer,
            program,
            stop: Arc::default(),
            inner: Mutex::default(),
            wake: Condvar::new(),
        }
    }

    fn inner(&self) -> MutexGuard<'_, Inner> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Sessions, the newest first.
    pub fn list(&self) -> Arc<Vec<Recorded>> {
        self.inner().list.clone()
    }

    /// Recording of a session, and the recordings that it continues.
    pub fn session(&self, id: &str) -> Option<(Entry, Vec<PathBuf>)> {
        let inner = self.inner();
        inner
            .sessions
            .iter()
            .find(|(entry, _)| entry.id == id)
            .cloned()
    }

    /// Whether the recording of a session was removed at the end of its time.
    pub fn is_gone(&self, id: &str) -> bool {
        self.inner().gone.contains(id)
    }

    /// The same as [`Shared::session`], for an act that needs the recording.
    ///
    /// # Errors
    /// The session is unknown, or its recording was removed: one sentence.
    pub fn recorded(&self, id: &str) -> Result<(Entry, Vec<PathBuf>), String> {
        let found = self.session(id).ok_or(UNKNOWN)?;
        match self.is_gone(id) {
            true => Err(GONE.to_owned()),
            false => Ok(found),
        }
    }

    /// Names of the files that stations write.
    pub fn running(&self) -> BTreeSet<String> {
        let names = self.doors.iter().map(|door| door.status().recording);
        names.filter(|name| !name.is_empty()).collect()
    }

    /// Reads the folder again and makes the list anew.
    pub fn refresh(&self) {
        let running = self.running();
        let norms: BTreeSet<String> = match self.store.norms().list() {
            Ok(norms) => norms.into_iter().map(|norm| norm.id).collect(),
            Err(error) => {
                tracing::error!("console: {error}");
                BTreeSet::new()
            }
        };
        let mut inner = self.inner();
        let entries = inner.index.scan(&self.recordings, &running);
        inner.sessions = sessions(&entries);
        let mut present: BTreeSet<String> = entries.into_iter().map(|entry| entry.id).collect();
        let mut gone = inner.expired.scan(self.store.folder());
        // A recording that could not be removed is there.
        gone.retain(|entry| !present.contains(&entry.id));
        for entry in &mut gone {
            // The command may have named the folder by another path.
            let name = entry.path.file_name().unwrap_or_default().to_owned();
            entry.path = self.recordings.join(name);
        }
        inner.gone = gone.iter().map(|entry| entry.id.clone()).collect();
        present.extend(inner.gone.iter().cloned());
        if !gone.is_empty() {
            let without = gone.into_iter().map(|entry| (entry, Vec::new()));
            inner.sessions.extend(without);
            let newest = |(entry, _): &(Entry, Vec<PathBuf>)| {
                std::cmp::Reverse((entry.started_unix_ns, entry.id.clone()))
            };
            inner.sessions.sort_by_cached_key(newest);
        }
        inner.told.retain(|id, _| present.contains(id));
        inner.failed.retain(|id, _| present.contains(id));
        let all = inner.sessions.clone();
        let mut list = Vec::with_capacity(all.len());
        for (entry, _) in &all {
            let told = self.told(&mut inner, entry);
            let mut one = recorded(entry, &told, &inner);
            one.is_norm = norms.contains(&entry.id);
            list.push(one);
        }
        inner.list = Arc::new(list);
    }

    fn told(&self, inner: &mut Inner, entry: &Entry) -> Told {
        if let Some((bytes, told)) = inner.told.get(&entry.id)
            && *bytes == entry.bytes
        {
            return told.clone();
        }
        let told = match self.store.grade(&entry.id, entry.bytes) {
            Ok(grade) => grade.as_ref().map(Told::of).unwrap_or_default(),
            Err(error) => {
                // A damaged grade is made again.
                tracing::error!("console: {error}");
                Told::default()
            }
        };
        inner
            .told
            .insert(entry.id.clone(), (entry.bytes, told.clone()));
        told
    }

    /// Asks for another grade of a session.
    pub fn again(&self, id: &str) {
        let mut inner = self.inner();
        inner.failed.remove(id);
        inner.again.insert(id.to_owned());
        drop(inner);
        self.wake.notify_all();
    }

    /// Ends the thread, and the grading that runs.
    pub fn end(&self) {
        self.stop.store(true, Ordering::Release);
        self.wake.notify_all();
    }

    /// Session whose grade is made next: one that is asked for again, else the newest without a grade.
    fn next(&self) -> Option<(Entry, Vec<PathBuf>)> {
        let inner = self.inner();
        let asked = inner
            .sessions
            .iter()
            .find(|(entry, _)| inner.again.contains(&entry.id));
        let without = || {
            inner.sessions.iter().find(|(entry, _)| {
                let is_made = inner
                    .told
                    .get(&entry.id)
                    .is_some_and(|(_, told)| told.is_made);
                let is_there = !inner.gone.contains(&entry.id);
                is_there && !is_made && !inner.failed.contains_key(&entry.id)
            })
        };
        asked.or_else(without).cloned()
    }

    /// Makes the grade of a session.
    fn make(&self, program: &Path, entry: &Entry, before: &[PathBuf]) {
        {
            let mut inner = self.inner();
            inner.again.remove(&entry.id);
            inner.running = Some(entry.id.clone());
        }
        self.refresh();
        let made = self.store.work().map_err(|error| error.to_string());
        let made = made.and_then(|work| {
            // The console asks for the own score itself, before it shows the grade.
            let own_first = entry.mode == "self-assessment";
            let job = Job {
                program,
                recording: &entry.path,
                before,
                signer: self.signer.as_deref(),
                mode: own_first.then_some("practice"),
                work: &work,
            };
            let made = job.run(&self.stop);
            let _ = std::fs::remove_dir_all(&work);
            let made = made?;
            let kept = self.store.keep(&entry.id, entry.bytes, &made);
            kept.map_err(|error| error.to_string()).map(|()| made)
        });
        let mut inner = self.inner();
        inner.running = None;
        match made {
            Ok(made) => {
                let told = Told::of(&made.object);
                inner.told.insert(entry.id.clone(), (entry.bytes, told));
            }
            // The end of the server is no fault of the recording.
            Err(_) if self.stop.load(Ordering::Acquire) => {}
            Err(why) => {
                tracing::warn!("console: no grade of {}: {why}", entry.id);
                inner.failed.insert(entry.id.clone(), why);
            }
        }
    }

    /// Work of the thread, until [`Shared::end`].
    pub fn work(&self) {
        if let Err(error) = rustix::process::nice(NICE) {
            tracing::debug!("console: niceness stays: {error}");
        }
        if let Err(why) = &self.program {
            tracing::warn!("console: sessions are not graded: {why}");
        }
        while !self.stop.load(Ordering::Acquire) {
            self.refresh();
            let next = self.program.as_ref().ok().zip(self.next());
            if let Some((program, (entry, before))) = next {
                self.make(program, &entry, &before);
                continue;
            }
            let inner = self.inner();
            // A wake-up without a reason reads the folder once more.
            drop(self.wake.wait_timeout(inner, LOOK));
        }
    }
}

/// Session of the list.
fn recorded(entry: &Entry, told: &Told, inner: &Inner) -> Recorded {
    let grading = if inner.running.as_deref() == Some(&entry.id) {
        Grading::Running
    } else if let Some(why) = inner.failed.get(&entry.id) {
        Grading::Failed(why.clone())
    } else if !told.is_made && inner.gone.contains(&entry.id) {
        let why = "the recording was removed at the end of its time, before a grade was made";
        Grading::Ungradable(why.to_owned())
    } else if !told.is_made {
        Grading::Waiting
    } else if told.score.is_some() {
        Grading::Graded
    } else {
        let none = || "the session has no grade".to_owned();
        Grading::Ungradable(told.reason.clone().unwrap_or_else(none))
    };
    let (own_score, revised) = match Sidecar::read(&entry.path) {
        Ok(Some(sidecar)) => {
            let revised = sidecar.revisions.into_iter().map(|said| Revised {
                score: said.score,
                passed: said.passed,
                by: said.by,
                at: said.at,
                reason: said.reason,
            });
            (sidecar.self_score, revised.collect())
        }
        Ok(None) => (None, Vec::new()),
        Err(error) => {
            tracing::error!("console: {error}");
            (None, Vec::new())
        }
    };
    Recorded {
        id: entry.id.clone(),
        station: entry.station.clone(),
        learner: entry.learner.clone(),
        exercise: entry.exercise.clone(),
        mode: entry.mode.clone(),
        scene: entry.scene.clone(),
        started: minute(entry.started_unix_ns / 1_000_000_000),
        started_unix_s: entry.started_unix_ns / 1_000_000_000,
        seconds: told.seconds,
        grading,
        score: told.score,
        passed: told.passed,
        own_score,
        revised,
        is_norm: false,
    }
}
