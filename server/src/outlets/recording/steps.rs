//! Steps of the recorder: each writes the queued ticks and takes one message of the network.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError};
use std::time::Duration;

use rtrb::Consumer;
use sulcus_core::Vec3;
use sulcus_link::clock::Clock;
use sulcus_proto::SessionSummary;
use sulcus_sessions::exercise::events::LOST;
use sulcus_sessions::{
    Level, Occurrence, RecordError, RecordedTick, SessionEnd, SessionWriter, Shapes,
};

use super::{
    Alarm, Ends, Entry, FromNetwork, Listeners, Narrator, Open, POLL, Report, Returned, Ticked,
};
use crate::session::changes::Changes;
use crate::session::gaps::Gaps;
use crate::session::handoff::{Attachment, Provoked};

/// Continuation after a step of the recorder.
pub(crate) enum Step {
    /// The next step, at once: a message was taken, and more may wait.
    Again,
    /// The next step, after this pause.
    Wait(Duration),
    /// [`RecorderLoop::finish`] with this end; `None`: the network's side was dropped without an end.
    Over(Option<Box<SessionSummary>>),
}

/// Loop of the recorder of one session.
pub(crate) struct RecorderLoop {
    /// First of the fields: dropped before the writer, which may wait for the disk.
    alarm: Alarm,
    writer: SessionWriter,
    file_name: String,
    narrator: Narrator,
    listeners: Listeners,
    /// Newest look, until its tick comes.
    look: Option<(u64, Vec<Vec3>)>,
    /// Newest shapes, until their tick comes.
    shapes: Option<Box<Shapes>>,
    /// Changes of pause and force limit.
    changes: Changes,
    /// Gaps of the connection.
    gaps: Gaps,
    attachment: Arc<Attachment>,
    entries: Consumer<Entry>,
    returned: Returned,
    network: Receiver<FromNetwork>,
    /// Source of the times of events.
    clock: Clock,
    /// First failure of a write.
    error: Option<String>,
}

impl RecorderLoop {
    /// Recorder of an open recording, before its first step.
    pub fn new(open: Open, ends: Ends) -> Self {
        let Open(writer, file_name, narrator, listeners) = open;
        Self {
            alarm: Alarm {
                flags: ends.flags,
                bell: ends.bell,
            },
            writer,
            file_name,
            narrator,
            listeners,
            look: None,
            shapes: None,
            changes: Changes::default(),
            gaps: Gaps::default(),
            attachment: ends.attachment,
            entries: ends.entries,
            returned: ends.returned,
            network: ends.network,
            clock: ends.clock,
            error: None,
        }
    }

    /// File name of the recording.
    pub fn file_name(&self) -> &str {
        &self.file_name
    }

    /// Number of entries that wait in the queue of the simulation.
    pub fn waiting(&self) -> usize {
        self.entries.slots()
    }

    /// Writes all queued entries, then takes a message of the network, if there is one.
    pub fn step(&mut self) -> Step {
        self.alarm.flags.provoke(Provoked::Recorder);
        self.drain();
        match self.network.try_recv() {
            Ok(FromNetwork::Event(event)) => {
                let text = format!("{} at tick {}: {}", event.kind, event.tick, event.json);
                self.listeners.said(&event, &text);
                self.write(Level::Info, &text);
                Step::Again
            }
            Ok(FromNetwork::Occurrence(occurrence)) => {
                self.listeners.event(&occurrence);
                self.write(occurrence.level(), &occurrence.to_string());
                Step::Again
            }
            Ok(FromNetwork::End(summary)) => Step::Over(Some(summary)),
            Err(TryRecvError::Empty) => Step::Wait(POLL),
            Err(TryRecvError::Disconnected) => Step::Over(None),
        }
    }

    /// Writes the remaining entries and the end, signs the recording and waits for the disk. Without an `end` the file
    /// has no end record.
    pub fn finish(mut self, end: Option<Box<SessionSummary>>) -> Report {
        self.drain();
        let Some(summary) = end else {
            return Report {
                file_name: self.file_name,
                error: Some("the session ended without a summary; the file has no end".into()),
            };
        };
        let unsaid = summary.edges_dropped + self.changes.unsaid();
        if unsaid > 0 {
            let lost = Occurrence {
                kind: LOST.into(),
                tick: summary.ticks,
                data: serde_json::json!({ "count": unsaid }),
            };
            self.write(Level::Warning, &lost.to_string());
        }
        let text = sulcus_sessions::record::ended::line(summary.end);
        self.write(Level::Info, &text);
        let finished = self.writer.finish(SessionEnd {
            ticks: summary.ticks,
            skipped: summary.skipped,
            dropped_rows: summary.rows_dropped,
            deadline_misses: summary.deadline_misses,
            exhausted: summary.exhausted,
            lost: summary.poses.lost,
            late: summary.poses.late + summary.poses.duplicate,
        });
        // The first failure explains the later ones.
        let error = self.error.or(finished.err().map(|error| error.to_string()));
        Report {
            file_name: self.file_name,
            error,
        }
    }

    /// Writes a line of the log, with the present time.
    fn write(&mut self, level: Level, text: &str) {
        let result = self.writer.event(self.clock.unix_ns(), level, text);
        self.check(result);
    }

    /// Writes all queued entries.
    fn drain(&mut self) {
        while let Ok(entry) = self.entries.pop() {
            let result = match entry {
                Entry::Tick(ticked) => self.tick(&ticked),
                Entry::Look(tick, centres) => {
                    self.look = Some((tick, centres));
                    Ok(())
                }
                Entry::Shapes(shapes) => {
                    self.shapes = Some(shapes);
                    Ok(())
                }
                Entry::Snapshot {
                    unix_ns,
                    tick,
                    bytes,
                } => {
                    let result = self.writer.snapshot(unix_ns, tick, &bytes);
                    // The ring has a slot for every buffer.
                    let _ = self.returned.snapshots.push(bytes);
                    result
                }
            };
            self.check(result);
        }
    }

    /// Writes a tick's row, its events and its messages for viewers.
    fn tick(&mut self, ticked: &Ticked) -> Result<(), RecordError> {
        let Ticked {
            row,
            output,
            cpu_ns,
            in_force,
            gone,
        } = ticked;
        let gap = self.gaps.take(row.tick, *gone, &self.attachment);
        if gap.is_some() {
            self.narrator.events.set_detached(*gone);
        }
        let look = self.look.take();
        let centres = look.as_ref().filter(|(tick, _)| *tick == output.tick);
        let centres = centres.map(|(_, centres)| centres.as_slice());
        let Narrator { scene, events } = &mut self.narrator;
        let changed = self.changes.take(row.tick, *in_force);
        let found: Vec<Occurrence> = events.take(scene, output, centres).collect();
        // Before the disk, which may be slow.
        self.listeners.status.tick(row, output, events, *cpu_ns);
        for occurrence in gap.iter().chain(&changed).chain(&found) {
            self.listeners.event(occurrence);
        }
        let shapes = self.shapes.take();
        if let Some(shapes) = &shapes {
            self.writer.follow(shapes);
        }
        self.listeners
            .frame(output, row.input.paused, self.writer.moved(), events);
        let recorded = RecordedTick {
            row,
            output,
            cpu_ns: *cpu_ns,
            shapes: shapes.as_deref(),
        };
        let written = self.writer.tick(
            scene,
            &recorded,
            gap.into_iter().chain(changed).chain(found),
        );
        if let Some((_, centres)) = look {
            let _ = self.returned.looks.push(centres);
        }
        if let Some(shapes) = shapes {
            let _ = self.returned.shapes.push(shapes);
        }
        written
    }

    /// Keeps and logs the first failure, and wakes the network, which ends the session.
    fn check(&mut self, result: Result<(), RecordError>) {
        if let Err(error) = result
            && self.error.is_none()
        {
            tracing::error!("{error}");
            self.error = Some(error.to_string());
            self.alarm.raise();
        }
    }
}
