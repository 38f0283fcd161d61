//! The recorder: takes the simulation's queue, writes and signs the recording, returns buffers. It runs on a thread of
//! its own, or step by step.

use std::sync::Arc;
use std::sync::mpsc::Receiver;
use std::thread::JoinHandle;
use std::time::Duration;

use rtrb::Consumer;
use sulcus_link::Bell;
use sulcus_link::clock::Clock;
use sulcus_sessions::{Sampler, SessionWriter};

use crate::session::handoff::{Attachment, Flags};

mod entry;
mod listeners;
mod steps;

pub(crate) use entry::{EVENTS, Entry, FromNetwork, Returned, Ticked};
pub(crate) use listeners::{Listeners, Narrator};
pub(crate) use steps::{RecorderLoop, Step};

/// Pause between two passes over the queue, which holds about four seconds or more. The recorder itself flushes every
/// 100 ms of recorded time.
const POLL: Duration = Duration::from_millis(5);

/// Result of a recording.
#[derive(Debug)]
pub(crate) struct Report {
    /// Name of the file in the folder of recordings.
    pub file_name: String,
    /// First failure, one sentence; `None`: the recording is signed and whole.
    pub error: Option<String>,
}

/// An open recording with header, scene and the state before the first tick; its file's name; the finder of events;
/// the listeners besides the recording.
pub(crate) struct Open(
    pub(super) SessionWriter,
    pub(super) String,
    pub(super) Narrator,
    pub(super) Listeners,
);

impl Open {
    /// Finder of the events.
    pub fn narrator(&self) -> &Narrator {
        &self.2
    }

    /// Reader of the shapes for viewers.
    pub fn sampler(&self) -> Sampler {
        self.0.sampler()
    }
}

/// The recorder's ends of a session's hand-overs.
pub(crate) struct Ends {
    /// Queue of the simulation.
    pub entries: Consumer<Entry>,
    /// Buffers back to the simulation.
    pub returned: Returned,
    /// Channel of events and of the end.
    pub network: Receiver<FromNetwork>,
    pub flags: Arc<Flags>,
    pub attachment: Arc<Attachment>,
    pub bell: Bell,
    /// Source of the times of events.
    pub clock: Clock,
}

/// Alarm to the network at a panic of the recorder: the session must not go on unrecorded.
struct Alarm {
    flags: Arc<Flags>,
    bell: Bell,
}

impl Alarm {
    /// Wakes the network, which ends the session.
    fn raise(&self) {
        Flags::raise(&self.flags.record_failed);
        self.bell.ring();
    }
}

impl Drop for Alarm {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.raise();
        }
    }
}

impl RecorderLoop {
    /// Starts the recorder's thread. The thread ends after [`FromNetwork::End`], or without an end record when the
    /// network's side is dropped.
    pub fn spawn(self) -> std::io::Result<JoinHandle<Report>> {
        std::thread::Builder::new()
            .name("sulcus-rec".into())
            .spawn(move || self.run(std::thread::sleep))
    }

    /// Steps to the end and finishes the recording. `wait` lets a pause between two steps pass.
    pub fn run(mut self, wait: impl Fn(Duration)) -> Report {
        let end = loop {
            match self.step() {
                Step::Again => {}
                Step::Wait(pause) => wait(pause),
                Step::Over(end) => break end,
            }
        };
        self.finish(end)
    }
}

#[cfg(test)]
mod tests;
