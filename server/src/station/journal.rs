//! Journal: a note on the running session of each station, in a file. After a crash of the server the same token
//! continues the session in a second recording, which names the first one's hash.
//!
//! The note is written at the start of a session and removed at its end. A note that a server finds when it starts
//! therefore belongs to a session without an end.

use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use sulcus_program::PathText;

use crate::station::config::SessionPlan;

/// Note on a running session.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Note {
    /// File name of the recording.
    recording: String,
    /// Opaque id of the student's token.
    token: String,
    /// Opaque learner id.
    learner: String,
    /// Name of the exercise.
    exercise: String,
    /// Mode of the session.
    mode: String,
    /// BLAKE3 hash of the compiled scene, hexadecimal.
    scene: String,
}

/// Journal of a station.
pub(crate) struct Journal {
    /// File of the note; `None`: no journal.
    file: Option<PathBuf>,
    /// Session without an end, until the next session.
    interrupted: Option<Note>,
}

impl Journal {
    /// Journal of a station in `folder`. An unreadable note is reported and ignored.
    pub fn of(folder: Option<&Path>, station: &str) -> Self {
        let file = folder.map(|folder| folder.join(format!("{}.json", file_name(station))));
        let interrupted = file.as_deref().and_then(read);
        if let Some(note) = &interrupted {
            tracing::warn!(
                "station {station}: the session recorded in {} was interrupted; the same token continues it",
                note.recording
            );
        }
        Self { file, interrupted }
    }

    /// File name of the recording that a session with these facts continues; `None` for a session of its own. The
    /// interrupted session is forgotten in either case.
    pub fn predecessor(
        &mut self,
        token: &str,
        learner: &str,
        plan: &SessionPlan,
    ) -> Option<String> {
        let note = self.interrupted.take()?;
        let same = note == note_of(note.recording.clone(), token, learner, plan);
        same.then_some(note.recording)
    }

    /// Notes the begin of a session. A failure is reported: the session can then not be continued after a crash.
    pub fn begin(&mut self, recording: &str, token: &str, learner: &str, plan: &SessionPlan) {
        let Some(file) = &self.file else { return };
        let note = note_of(recording.to_owned(), token, learner, plan);
        if let Err(error) = write(file, &note) {
            tracing::warn!(
                "{}: cannot write the note on the session: {error}",
                file.shown()
            );
        }
    }

    /// Removes the note at the end of a session.
    pub fn end(&mut self) {
        let Some(file) = &self.file else { return };
        if let Err(error) = fs::remove_file(file)
            && error.kind() != std::io::ErrorKind::NotFound
        {
            tracing::warn!(
                "{}: cannot remove the note on the session: {error}",
                file.shown()
            );
        }
    }
}

fn note_of(recording: String, token: &str, learner: &str, plan: &SessionPlan) -> Note {
    Note {
        recording,
        token: token.to_owned(),
        learner: learner.to_owned(),
        exercise: plan.exercise.name.clone(),
        mode: plan.mode.name().to_owned(),
        scene: blake3::hash(&plan.scene_bytes).to_hex().to_string(),
    }
}

/// Name of a station as a file name: any other character than letters, digits, `-` and `_` becomes its number.
fn file_name(station: &str) -> String {
    station
        .chars()
        .map(|c| {
            if c.is_ascii_alphanumeric() || c == '-' || c == '_' {
                c.to_string()
            } else {
                format!("%{:x}", u32::from(c))
            }
        })
        .collect()
}

fn read(file: &Path) -> Option<Note> {
    let text = match fs::read_to_string(file) {
        Ok(text) => text,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return None,
        Err(error) => {
            tracing::warn!(
                "{}: cannot read the note on a session: {error}",
                file.shown()
            );
            return None;
        }
    };
    match serde_json::from_str(&text) {
        Ok(note) => Some(note),
        Err(error) => {
            tracing::warn!("{}: no valid note on a session: {error}", file.shown());
            None
        }
    }
}

/// Writes a note so that a crash leaves the old note, the new one or none.
fn write(file: &Path, note: &Note) -> std::io::Result<()> {
    if let Some(folder) = file.parent() {
        fs::create_dir_all(folder)?;
    }
    let text = serde_json::to_string(note)?;
    let beside = file.with_extension("new");
    let mut new = fs::File::create(&beside)?;
    new.write_all(text.as_bytes())?;
    new.sync_all()?;
    fs::rename(&beside, file)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use sulcus_core::Scene;

    use super::*;

    fn plan() -> SessionPlan {
        let scene = Scene {
            name: String::new(),
            source_hash: String::new(),
            params: Default::default(),
            tools: vec![],
            objects: vec![],
        };
        SessionPlan::new(Arc::new(scene), Arc::new(vec![1, 2, 3]))
    }

    #[test]
    fn only_a_session_without_an_end_is_continued_and_only_by_its_own_learner() {
        let folder = tempfile::tempdir().expect("folder");
        let open = || Journal::of(Some(folder.path()), "chair 1/ä");
        let plan = plan();
        let mut journal = open();
        assert_eq!(journal.predecessor("t-1", "a1", &plan), None);
        journal.begin("first.mcap", "t-1", "a1", &plan);
        // The server was killed.
        let first = Some("first.mcap".to_owned());
        assert_eq!(open().predecessor("t-1", "a1", &plan), first);
        for (token, learner) in [("t-2", "a1"), ("t-1", "a2")] {
            assert_eq!(open().predecessor(token, learner, &plan), None);
        }
        let mut other = plan.clone();
        other.scene_bytes = Arc::new(vec![1, 2, 4]);
        assert_eq!(open().predecessor("t-1", "a1", &other), None);
        let mut again = open();
        assert!(again.predecessor("t-1", "a1", &plan).is_some());
        assert!(again.predecessor("t-1", "a1", &plan).is_none(), "once");
        again.begin("second.mcap", "t-1", "a1", &plan);
        again.end();
        assert_eq!(open().predecessor("t-1", "a1", &plan), None);
    }

    #[test]
    fn a_note_of_any_bytes_is_ignored() {
        let folder = tempfile::tempdir().expect("folder");
        for bytes in [&b""[..], b"{", b"\xff\xfe", b"{\"recording\":1}"] {
            fs::write(folder.path().join("a.json"), bytes).expect("written");
            let mut journal = Journal::of(Some(folder.path()), "a");
            assert_eq!(journal.predecessor("t", "", &plan()), None);
        }
    }
}
