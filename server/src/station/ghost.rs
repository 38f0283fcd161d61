//! Ghost: hands of a recording on the student's screen, at the instruction of an instructor.

use std::path::{Component, Path};
use std::sync::Arc;

use serde_json::json;
use sulcus_core::{MAX_TOOLS, ToolInput};
use sulcus_proto::control::Answer;
use sulcus_proto::datagram::WirePose;
use sulcus_proto::ghost::{GhostPart, MOST_MOMENTS, Moment, PERIOD_NS, parts};
use sulcus_sessions::{Message, Mode, Occurrence, Recording};
use tokio::sync::oneshot;

use crate::station::actor::{State, Station};
use crate::station::door::ToStudent;
use crate::station::instruct::{Prepared, refused};

/// Path that was read, and the instructor who waits for it.
pub(super) struct Read {
    by: String,
    file: String,
    /// Compiled scene of the path.
    scene: Arc<Vec<u8>>,
    parts: Result<Vec<GhostPart>, String>,
    reply: oneshot::Sender<Answer>,
}

impl Station {
    /// Shows the hands of the recording `file` on the student's screen, or nothing for an empty name. A thread of its
    /// own reads the recording; [`Station::show_ghost`] takes the result.
    pub(super) fn ghost(&mut self, by: String, file: String, reply: oneshot::Sender<Answer>) {
        let plan = match &self.state {
            State::Running(session) if session.plan.mode == Mode::Exam => {
                let _ = reply.send(refused("an exam runs at this station, and has no ghost"));
                return;
            }
            State::Running(session) => session.plan.clone(),
            _ => {
                let _ = reply.send(refused("no session runs at this station"));
                return;
            }
        };
        let (folder, scene) = (
            self.shared.config.recordings.clone(),
            plan.scene_bytes.clone(),
        );
        let to_self = self.prepared.0.clone();
        tokio::spawn(async move {
            let (name, its) = (file.clone(), scene.clone());
            let reading = tokio::task::spawn_blocking(move || read(&folder, &name, &its));
            let parts = reading
                .await
                .unwrap_or_else(|_| Err(format!("the recording `{file}` cannot be read")));
            let read = Read {
                by,
                file,
                scene,
                parts,
                reply,
            };
            let _ = to_self.send(Prepared::Ghost(read)).await;
        });
    }

    /// Sends a path to the student, and writes an event into the recording.
    pub(super) fn show_ghost(&mut self, read: Read) {
        let Read {
            by,
            file,
            scene,
            parts,
            reply,
        } = read;
        let answer = match parts {
            Ok(parts) if self.runs(&scene) => self.send_ghost(&by, &file, parts),
            Ok(_) => refused("the session has ended"),
            Err(why) => refused(&why),
        };
        let _ = reply.send(answer);
    }

    /// Whether a session of the compiled scene runs.
    fn runs(&self, scene: &Arc<Vec<u8>>) -> bool {
        matches!(&self.state, State::Running(session) if Arc::ptr_eq(&session.plan.scene_bytes, scene))
    }

    fn send_ghost(&self, by: &str, file: &str, parts: Vec<GhostPart>) -> Answer {
        let State::Running(session) = &self.state else {
            return refused("no session runs at this station");
        };
        let Some(present) = &session.present else {
            return refused("the student is not connected");
        };
        // The order of both: a ghost without an event would be missing in the recording.
        let answer = self.log(Occurrence {
            kind: if file.is_empty() { HIDDEN } else { SHOWN }.into(),
            tick: 0,
            data: json!({ "by": by, "recording": file }),
        });
        if answer.taken
            && present
                .to_student
                .try_send(ToStudent::Ghost(parts))
                .is_err()
        {
            let text = "recorded; the student's connection takes no messages now".to_owned();
            return Answer { text, ..answer };
        }
        answer
    }
}

/// Kinds of the events.
const SHOWN: &str = "ghost_shown";
const HIDDEN: &str = "ghost_hidden";

/// Reads the hands of the recording `file` in `folder`, at most the first ten minutes. An empty name has an empty path.
fn read(folder: &Path, file: &str, scene: &[u8]) -> Result<Vec<GhostPart>, String> {
    let tips = [[0.0; 3]; MAX_TOOLS];
    if file.is_empty() {
        return Ok(parts(&[], tips));
    }
    let mut components = Path::new(file).components();
    let is_name = matches!(components.next(), Some(Component::Normal(name)) if name == file);
    if !is_name || components.next().is_some() {
        return Err(format!(
            "the ghost's recording is `{file}`, expected the name of a file in the folder of recordings"
        ));
    }
    let failed = |error: &dyn std::fmt::Display| format!("the ghost's recording `{file}`: {error}");
    let path = folder.join(file);
    let header = Recording::header_of(&path).map_err(|error| failed(&error))?;
    if header.mode == Some(Mode::Exam) {
        return Err(failed(&"the session was an exam, and is never a ghost"));
    }
    if header.scene != scene {
        return Err(failed(
            &"the session was recorded in another scene than that of the running session",
        ));
    }
    let recording = Recording::open(&path).map_err(|error| failed(&error))?;
    let scene = recording.scene().map_err(|error| failed(&error))?;
    let every = (PERIOD_NS as f64 / 1e9 / scene.tick_s()).round().max(1.0) as usize;
    let mut path: Vec<Moment> = Vec::new();
    let mut rows = 0;
    for message in recording.messages() {
        let Message::Row(row) = message.map_err(|error| failed(&error))? else {
            continue;
        };
        if rows % every == 0 {
            path.push(row.input.tools.each_ref().map(pose));
        }
        rows += 1;
        if path.len() == MOST_MOMENTS {
            break;
        }
    }
    let tips = std::array::from_fn(|t| {
        let tool = scene.tools.get(t);
        tool.map_or(tips[t], |tool| <[f64; 3]>::from(tool.tip).map(|x| x as f32))
    });
    Ok(parts(&path, tips))
}

/// Pose of a hand that holds a tool; `None` without a hand, and for a number that is not finite.
fn pose(tool: &ToolInput) -> Option<WirePose> {
    let pose = WirePose {
        position: tool.pose.position,
        orientation: tool.pose.orientation,
    };
    let mut numbers = pose.position.iter().chain(&pose.orientation);
    let holds = tool.present && !tool.stale;
    (holds && numbers.all(|x| x.is_finite())).then_some(pose)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_file_of_the_folder_is_a_ghost() {
        let folder = tempfile::tempdir().expect("a folder");
        let refusal = |file: &str| read(folder.path(), file, &[]).expect_err("refused");
        for file in [
            "../a.mcap",
            "/etc/passwd",
            "a/b.mcap",
            "a.mcap/",
            "..",
            "./a.mcap",
        ] {
            assert!(refusal(file).contains("expected the name"), "{file}");
        }
        assert!(refusal("a.mcap").contains("`a.mcap`: "));
        assert_eq!(read(folder.path(), "", &[]), Ok(parts(&[], [[0.0; 3]; 2])));
    }
}
