//! Recorded sessions and their grades, for the console.
//!
//! | module | content |
//! |---|---|
//! | `child` | the grading of one session, in a process of idle priority |
//! | `store` | grades in the state folder |
//! | `worker` | thread that grades what has no grade |
//! | `replay` | replay of a moment, drawn by `sulcus-review` |
//! | `table`, `archive` | table for spreadsheets, archive of a learner |

mod archive;
mod child;
mod replay;
mod store;
mod table;
mod worker;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread::JoinHandle;

use serde_json::Value;
use sulcus_console::house::{Erased, Grades, Recorded, Revised};
use sulcus_program::PathText;
use sulcus_sessions::cli::sibling;
use sulcus_sessions::grade::revision::{Proposal, Revision, Sidecar, beside};

use crate::recordings::norms::Norm;
use crate::state::StateFolder;
use crate::state::date::{day, now_s};
use crate::station::door::Door;
use store::Store;
use worker::Shared;

/// Number of exports since the start, for the names of their files.
static EXPORTS: AtomicU64 = AtomicU64::new(0);

/// Sentence for an unknown session.
const UNKNOWN: &str = "this server has no such recording";
/// Sentence for a session whose recording was removed.
const GONE: &str =
    "the recording was removed at the end of its time; the grade and the scores are kept";

/// Sessions and grades of a running server; none without a state folder.
#[derive(Default)]
pub(super) struct OwnGrades {
    shared: Option<Arc<Shared>>,
    thread: Option<JoinHandle<()>>,
}

impl OwnGrades {
    /// Starts the thread that grades. `key`: file of the key that signs recordings.
    pub fn start(
        recordings: &Path,
        key: Option<&Path>,
        state: Option<&StateFolder>,
        doors: &[Door],
    ) -> Self {
        let Some(state) = state else {
            return Self::default();
        };
        let store = match Store::open(state.path()) {
            Ok(store) => store,
            Err(error) => {
                tracing::error!("console: {error}");
                return Self::default();
            }
        };
        let program = sibling::find("sulcus-sessions", sibling::BUILDS_SESSIONS);
        let signer = key.map(|key| key.with_extension("pub"));
        let shared = Arc::new(Shared::new(
            recordings.to_owned(),
            store,
            doors.to_vec(),
            signer.filter(|file| file.is_file()),
            program.map_err(|error| error.to_string()),
        ));
        let owned = shared.clone();
        let thread = std::thread::Builder::new()
            .name("sulcus-grades".into())
            .spawn(move || owned.work());
        match thread {
            Ok(thread) => Self {
                shared: Some(shared),
                thread: Some(thread),
            },
            Err(error) => {
                tracing::error!("console: the thread of the grades cannot start: {error}");
                Self::default()
            }
        }
    }

    fn shared(&self) -> Result<&Shared, String> {
        let none = || "this server keeps no grades".to_owned();
        self.shared.as_deref().ok_or_else(none)
    }

    /// Recording of a session, and the proposal for it.
    fn proposed(&self, id: &str) -> Result<(PathBuf, Proposal), String> {
        let shared = self.shared()?;
        let (entry, _) = shared.session(id).ok_or(UNKNOWN)?;
        let grade = shared.store.grade(id, entry.bytes);
        let grade = grade.map_err(|error| {
            tracing::error!("console: {error}");
            "the grade cannot be read; tell an administrator".to_owned()
        })?;
        let none = "the session has no grade yet";
        let proposal = Proposal::of_json(&grade.ok_or(none)?).ok_or(none)?;
        Ok((entry.path, proposal))
    }
}

impl Drop for OwnGrades {
    fn drop(&mut self) {
        if let Some(shared) = &self.shared {
            shared.end();
        }
        if let Some(thread) = self.thread.take()
            && thread.join().is_err()
        {
            tracing::error!("console: the thread of the grades has failed");
        }
    }
}

impl Grades for OwnGrades {
    fn all(&self) -> Arc<Vec<Recorded>> {
        self.shared
            .as_ref()
            .map(|shared| shared.list())
            .unwrap_or_default()
    }

    fn grade(&self, id: &str) -> Option<Arc<Value>> {
        let shared = self.shared.as_ref()?;
        let (entry, _) = shared.session(id)?;
        shared.store.grade(id, entry.bytes).ok()?.map(Arc::new)
    }

    fn sheet(&self, id: &str) -> Option<String> {
        let shared = self.shared.as_ref()?;
        shared.session(id)?;
        shared.store.sheet(id)
    }

    fn file(&self, id: &str) -> Option<PathBuf> {
        let shared = self.shared.as_ref()?;
        let (entry, _) = shared.session(id)?;
        (!shared.is_gone(id)).then_some(entry.path)
    }

    fn replay(&self, id: &str, at_ms: u64) -> Result<Vec<u8>, String> {
        let shared = self.shared()?;
        let (entry, _) = shared.recorded(id)?;
        replay::drawn(&shared.store, &entry.path, at_ms, &shared.stop)
    }

    fn revise(&self, id: &str, revised: Revised) -> Result<(), String> {
        let (path, proposal) = self.proposed(id)?;
        let Revised {
            score,
            passed,
            by,
            at,
            reason,
        } = revised;
        let revision = Revision {
            score,
            passed,
            by,
            at: if at.is_empty() { day(now_s()) } else { at },
            reason,
        };
        Sidecar::add(&path, &proposal, revision).map_err(|error| error.to_string())?;
        self.shared()?.refresh();
        Ok(())
    }

    fn assess(&self, id: &str, own: f64) -> Result<(), String> {
        let (path, proposal) = self.proposed(id)?;
        Sidecar::assess(&path, &proposal, own).map_err(|error| error.to_string())?;
        self.shared()?.refresh();
        Ok(())
    }

    fn again(&self, id: &str) -> Result<(), String> {
        let shared = self.shared()?;
        shared.recorded(id)?;
        if let Err(why) = &shared.program {
            return Err(why.clone());
        }
        shared.again(id);
        Ok(())
    }

    fn set_norm(&self, id: &str, is_norm: bool, by: &str) -> Result<(), String> {
        let shared = self.shared()?;
        shared.recorded(id)?;
        let changed = shared.store.norms().change(|norms| {
            norms.retain(|norm| norm.id != id);
            if is_norm {
                norms.push(Norm {
                    id: id.to_owned(),
                    by: by.to_owned(),
                    at_unix_s: now_s(),
                });
            }
        });
        changed.map_err(|error| error.to_string())?;
        shared.refresh();
        Ok(())
    }

    fn table(&self, rows: &[Recorded], name: &dyn Fn(&str) -> String) -> Result<String, String> {
        let row = |one: &Recorded| {
            let grade = self.grade(&one.id).map(Arc::unwrap_or_clone);
            (one.clone(), grade)
        };
        let rows: Vec<(Recorded, Option<Value>)> = rows.iter().map(row).collect();
        table::table(&rows, name).map_err(|error| error.to_string())
    }

    fn export(&self, ids: &[String]) -> Result<PathBuf, String> {
        let shared = self.shared()?;
        let sessions: Vec<(String, Vec<PathBuf>)> = ids
            .iter()
            .filter_map(|id| {
                let (entry, mut files) = shared.session(id)?;
                files.push(entry.path);
                Some((entry.id, files))
            })
            .collect();
        let count = EXPORTS.fetch_add(1, Ordering::Relaxed);
        let name = format!("export-{}-{count}.zip", std::process::id());
        let path = shared.store.folder().join(name);
        archive::write(&path, &shared.store, &sessions).map_err(|error| {
            tracing::error!("console: an export cannot be written: {error}");
            let _ = std::fs::remove_file(&path);
            "the export cannot be written; is the disk full?".to_owned()
        })?;
        Ok(path)
    }

    fn erase(&self, learner: &str, ids: &[String]) -> Result<Erased, String> {
        let shared = self.shared()?;
        if learner.is_empty() {
            return Err("the learner's id is empty".into());
        }
        let runs = |door: &Door| {
            let status = door.status();
            status.learner == learner && !status.recording.is_empty()
        };
        if shared.doors.iter().any(runs) {
            return Err("a session of this learner runs; end the session first".into());
        }
        let mut erased = Erased::default();
        for id in ids {
            let Some((entry, before)) = shared.session(id) else {
                continue;
            };
            if shared.is_gone(id) {
                // The facts go last, for the same reason.
                let scores = beside(&entry.path);
                if scores.exists() {
                    let removed = std::fs::remove_file(&scores);
                    removed.map_err(|error| format!("{}: {error}", scores.shown()))?;
                    erased.files += 1;
                }
                let removed = shared.store.remove(id);
                erased.files += removed.map_err(|error| error.to_string())?;
                continue;
            }
            // The recordings go last: a failure before leaves the session in the list, and the next attempt goes on.
            let removed = shared.store.remove(id);
            erased.files += removed.map_err(|error| error.to_string())?;
            for path in before.iter().chain([&entry.path]) {
                let failed = |error: std::io::Error| {
                    format!("a file of session {id} cannot be removed: {error}")
                };
                if beside(path).exists() {
                    std::fs::remove_file(beside(path)).map_err(failed)?;
                    erased.files += 1;
                }
                std::fs::remove_file(path).map_err(failed)?;
                erased.recordings += 1;
            }
        }
        shared.refresh();
        Ok(erased)
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::child::Made;
    use super::*;
    use crate::recordings::expired;
    use crate::recordings::index::Entry;
    use crate::state::folder::fresh;

    #[test]
    fn a_session_without_its_recording_keeps_its_grade_until_the_learner_is_erased() {
        let (place, state) = fresh();
        let recordings = place.path().join("recordings");
        std::fs::create_dir(&recordings).expect("makes");
        let store = Store::open(state.path()).expect("opens");
        let entry = |id: &str| Entry {
            id: id.into(),
            // The path is that of a command in another folder.
            path: format!("recordings/{id}.mcap").into(),
            bytes: 7,
            station: "a".into(),
            learner: "s-1".into(),
            exercise: "probing".into(),
            mode: "practice".into(),
            scene: "00".into(),
            started_unix_ns: 1_795_651_200_000_000_000,
            continues: None,
        };
        let made = Made {
            object: json!({ "score": 61.5, "passed": true }),
            page: "<html>".into(),
        };
        store.keep("x", 7, &made).expect("keeps");
        for id in ["x", "y"] {
            expired::keep(store.folder(), &entry(id), 9).expect("keeps");
        }
        std::fs::write(recordings.join("y.mcap.grade.json"), "{}").expect("writes");
        let none = Err("no program".to_owned());
        let shared = Shared::new(recordings, store, Vec::new(), None, none);
        shared.refresh();
        let grades = OwnGrades {
            shared: Some(Arc::new(shared)),
            thread: None,
        };
        let all = grades.all();
        let told: Vec<(&str, Option<f64>)> =
            all.iter().map(|one| (one.id.as_str(), one.score)).collect();
        assert_eq!(told, [("y", None), ("x", Some(61.5))]);
        assert!(matches!(
            all[0].grading,
            sulcus_console::house::Grading::Ungradable(_)
        ));
        assert_eq!(grades.grade("x").as_deref(), Some(&made.object));
        assert_eq!(grades.sheet("x").as_deref(), Some("<html>"));
        assert_eq!(grades.file("x"), None);
        grades.set_norm("x", true, "t-1").expect_err("no values");
        grades.again("x").expect_err("no recording");
        let archive = grades.export(&["x".into(), "y".into()]).expect("writes");
        std::fs::remove_file(archive).expect("made");
        let ids = ["x".to_owned(), "y".to_owned()];
        let erased = grades.erase("s-1", &ids).expect("erases");
        // Grade, sheet and facts of the one; score and facts of the other.
        assert_eq!((erased.recordings, erased.files), (0, 5));
        assert!(grades.all().is_empty());
    }
}
