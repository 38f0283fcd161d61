//! The recorder thread: takes the simulation's queue, writes and signs the recording, returns buffers.

use std::sync::mpsc::{Receiver, TryRecvError};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use rtrb::{Consumer, Producer};
use sulcus_core::{Scene, TickOutput, Vec3};
use sulcus_link::Bell;
use sulcus_link::clock::unix_ns;
use sulcus_proto::SessionSummary;
use sulcus_proto::control::Event;
use sulcus_proto::device::DEVICE_EVENT;
use sulcus_proto::station::StationEvent;
use sulcus_sessions::exercise::events::call::READING_CALLED;
use sulcus_sessions::exercise::events::{LOST, Look};
use tokio::sync::broadcast;

use sulcus_sessions::{
    Events, Exercise, Level, Moved, Occurrence, RecordError, RecordedTick, Row, Sampler,
    SessionEnd, SessionWriter, Shapes,
};

use crate::outlets::feed::{FeedPublisher, SessionFeed};
use crate::outlets::hands::hands;
use crate::outlets::status::StatusOutlet;
use crate::session::changes::Changes;
use crate::session::gaps::Gaps;
use crate::session::handoff::{Attachment, Flags, Provoked};
use crate::session::levels::InForce;
use crate::station::config::SessionPlan;

/// Pause between two passes over the queue, which holds about four seconds or more. The recorder itself flushes every
/// 100 ms of recorded time.
const POLL: Duration = Duration::from_millis(5);

/// Number of slots in the channel of events and of the end; chosen as more than a person causes in [`POLL`].
pub(crate) const EVENTS: usize = 256;

/// Entry of the simulation's queue. One queue keeps the order: look and shapes, then their tick, then its snapshot.
#[expect(
    clippy::large_enum_variant,
    reason = "nearly all are ticks, and a box would be allocated in the tick's thread"
)]
pub(crate) enum Entry {
    /// A tick. The recorder's thread finds the events and makes the viewers' messages.
    Tick(Ticked),
    /// Number of a tick, and the sphere centres after it that events need, world axes, metres: see [`Look`].
    Look(u64, Vec<Vec3>),
    /// Shapes for viewers after the next tick in the queue.
    Shapes(Box<Shapes>),
    /// State after a tick, with the tick's time since 1970.
    Snapshot {
        unix_ns: u64,
        tick: u64,
        bytes: Vec<u8>,
    },
}

/// A tick on its way to the recorder.
pub(crate) struct Ticked {
    /// Exact row.
    pub row: Row,
    /// Output.
    pub output: TickOutput,
    /// CPU time, nanoseconds.
    pub cpu_ns: u32,
    /// Levels of both sides.
    pub in_force: InForce,
    /// Whether the student is gone.
    pub gone: bool,
}

/// Message from the network to the recorder.
pub(crate) enum FromNetwork {
    /// Event of the client.
    Event(Event),
    /// Event of the station: a gap, an instruction.
    Occurrence(Box<Occurrence>),
    /// End of the session. The simulation has ended, and no entry follows.
    End(Box<SessionSummary>),
}

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

/// Listeners besides the recording: status and events for instructors. No listener blocks.
pub(crate) struct Listeners {
    pub(super) station: String,
    pub(super) status: StatusOutlet,
    pub(super) events: broadcast::Sender<StationEvent>,
    /// Feed of this session, if the plan has a scene for displays.
    pub(super) session: Option<SessionFeed>,
    pub(super) feed: Arc<Mutex<FeedPublisher>>,
}

impl Listeners {
    /// Publishes the frame of a tick for displays, if it is due.
    fn frame(&mut self, output: &TickOutput, paused: bool, moved: &Moved, events: &Events) {
        let Some(session) = &mut self.session else {
            return;
        };
        let mut feed = self.feed.lock().unwrap_or_else(PoisonError::into_inner);
        if session.tick(&mut feed, output, paused, moved) {
            let hands = hands(output, paused, self.status.depths(), events);
            feed.hands(hands);
        }
        self.status.frames_dropped(feed.dropped());
    }

    /// Sends a reading that the student calls to all instructors, and takes the state of a device. Other events of a
    /// client are for the recording alone: they must not pass for events that the server has found.
    fn said(&mut self, event: &Event, text: &str) {
        if event.kind == DEVICE_EVENT {
            self.status.device(&event.json);
        }
        if event.kind == READING_CALLED {
            // An error means that nobody listens.
            let _ = self.events.send(StationEvent {
                station: self.station.clone(),
                tick: event.tick,
                text: text.to_owned(),
            });
        }
    }

    /// Sends an event to displays and to all instructors. A slow instructor misses the oldest ones.
    fn event(&mut self, occurrence: &Occurrence) {
        if let Some(session) = &mut self.session {
            session.occurred(occurrence);
        }
        // An error means that nobody listens.
        let _ = self.events.send(StationEvent {
            station: self.station.clone(),
            tick: occurrence.tick,
            text: occurrence.to_string(),
        });
    }
}

/// Finder of a session's events.
pub(crate) struct Narrator {
    scene: Arc<Scene>,
    events: Events,
}

impl Narrator {
    pub(super) fn new(plan: &SessionPlan) -> Self {
        let exercise = Exercise::recorded(&plan.exercise.definition);
        let events = Events::new(&plan.scene, &exercise);
        for what in events.missing() {
            tracing::warn!(
                "exercise `{}` needs {what}, which scene `{}` lacks",
                plan.exercise.name,
                plan.scene.name
            );
        }
        Self {
            scene: plan.scene.clone(),
            events,
        }
    }

    /// Reader of the shapes that events need.
    pub fn look(&self) -> &Look {
        self.events.look()
    }
}

impl Open {
    /// File name of the recording.
    pub fn file_name(&self) -> &str {
        &self.1
    }

    /// Finder of the events.
    pub fn narrator(&self) -> &Narrator {
        &self.2
    }

    /// Reader of the shapes for viewers.
    pub fn sampler(&self) -> Sampler {
        self.0.sampler()
    }
}

/// Rings of buffers from the recorder back to the simulation.
pub(crate) struct Returned {
    /// Buffers of snapshots.
    pub snapshots: Producer<Vec<u8>>,
    /// Buffers of looks.
    pub looks: Producer<Vec<Vec3>>,
    /// Buffers of shapes for viewers.
    pub shapes: Producer<Box<Shapes>>,
}

/// Starts the recorder's thread. The thread ends after [`FromNetwork::End`], or without an end record when the
/// network's side is dropped.
pub(crate) fn spawn(
    open: Open,
    entries: Consumer<Entry>,
    returned: Returned,
    network: Receiver<FromNetwork>,
    flags: Arc<Flags>,
    attachment: Arc<Attachment>,
    bell: Bell,
) -> std::io::Result<JoinHandle<Report>> {
    let Open(writer, file_name, narrator, listeners) = open;
    let thread = Thread {
        writer,
        narrator,
        listeners,
        look: None,
        shapes: None,
        changes: Changes::default(),
        gaps: Gaps::default(),
        attachment,
        entries,
        returned,
        network,
        flags,
        bell,
        error: None,
    };
    std::thread::Builder::new()
        .name("sulcus-rec".into())
        .spawn(move || thread.run(file_name))
}

/// Alarm to the network at a panic of the recorder: the session must not go on unrecorded.
struct Alarm {
    flags: Arc<Flags>,
    bell: Bell,
}

impl Drop for Alarm {
    fn drop(&mut self) {
        if std::thread::panicking() {
            Flags::raise(&self.flags.record_failed);
            self.bell.ring();
        }
    }
}

struct Thread {
    writer: SessionWriter,
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
    flags: Arc<Flags>,
    bell: Bell,
    /// First failure of a write.
    error: Option<String>,
}

impl Thread {
    fn run(mut self, file_name: String) -> Report {
        // Dropped before the recorder, which may wait for the disk.
        let _alarm = Alarm {
            flags: self.flags.clone(),
            bell: self.bell.clone(),
        };
        let end = loop {
            self.flags.provoke(Provoked::Recorder);
            self.drain();
            match self.network.try_recv() {
                Ok(FromNetwork::Event(event)) => {
                    let text = format!("{} at tick {}: {}", event.kind, event.tick, event.json);
                    self.listeners.said(&event, &text);
                    let result = self.writer.event(unix_ns(), Level::Info, &text);
                    self.check(result);
                }
                Ok(FromNetwork::Occurrence(occurrence)) => {
                    self.listeners.event(&occurrence);
                    let text = occurrence.to_string();
                    let result = self.writer.event(unix_ns(), occurrence.level(), &text);
                    self.check(result);
                }
                Ok(FromNetwork::End(summary)) => break Some(summary),
                Err(TryRecvError::Empty) => std::thread::sleep(POLL),
                // The network's side was dropped without an end.
                Err(TryRecvError::Disconnected) => break None,
            }
        };
        self.drain();
        let Some(summary) = end else {
            return Report {
                file_name,
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
            let result = self
                .writer
                .event(unix_ns(), Level::Warning, &lost.to_string());
            self.check(result);
        }
        let text = sulcus_sessions::record::ended::line(summary.end);
        let result = self.writer.event(unix_ns(), Level::Info, &text);
        self.check(result);
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
        Report { file_name, error }
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
            Flags::raise(&self.flags.record_failed);
            self.bell.ring();
        }
    }
}

#[cfg(test)]
mod tests {
    use sulcus_core::Pose;
    use sulcus_core::output::ToolOutput;

    use sulcus_sessions::{Recorder, SessionHeader, StationKey};

    use super::*;

    /// Output of a tick in which no hand holds a tool.
    fn output(tick: u64) -> TickOutput {
        let idle = ToolOutput::absent(Pose::identity());
        TickOutput {
            tick,
            hash: 0,
            tools: [idle; sulcus_core::MAX_TOOLS],
            work: 0,
        }
    }

    #[test]
    fn the_first_failure_is_told_and_the_file_stays_whole() {
        let folder = tempfile::tempdir().expect("folder");
        let path = folder.path().join("session.mcap");
        let key = || StationKey::from_seed([1; 32]);
        let recorder =
            Recorder::create(&path, &SessionHeader::new(vec![]), key()).expect("created");
        let (mut entries, entries_out) = rtrb::RingBuffer::new(8);
        let (snapshots, _snapshots) = rtrb::RingBuffer::new(1);
        let (looks, _looks) = rtrb::RingBuffer::new(1);
        let (shapes, _shapes) = rtrb::RingBuffer::new(1);
        let (network, network_out) = std::sync::mpsc::sync_channel(EVENTS);
        let (flags, bell) = (Arc::new(Flags::default()), Bell::new().expect("eventfd"));
        let row = |tick| Row {
            tick,
            time_unix_ns: tick,
            input: sulcus_core::TickInput::IDLE,
            hash: 0,
            wrench: Default::default(),
            status: Default::default(),
            device: Default::default(),
        };
        for tick in [1, 2, 2] {
            entries
                .push(Entry::Tick(Ticked {
                    row: row(tick),
                    output: output(tick),
                    cpu_ns: 0,
                    in_force: InForce::default(),
                    gone: false,
                }))
                .expect("room");
        }
        let scene = Arc::new(Scene {
            name: String::new(),
            source_hash: String::new(),
            params: Default::default(),
            tools: vec![],
            objects: vec![],
        });
        let narrator = Narrator {
            events: Events::new(&scene, &Exercise::free("free", 1.0)),
            scene,
        };
        let writer = SessionWriter::begin(recorder, &narrator.scene, 0, &[], None);
        let listeners = Listeners {
            station: "station".into(),
            status: StatusOutlet::new(&narrator.scene, Arc::default()),
            events: broadcast::channel(1).0,
            session: None,
            feed: Arc::new(Mutex::new(FeedPublisher::new().0)),
        };
        let open = Open(
            writer.expect("begun"),
            "session.mcap".into(),
            narrator,
            listeners,
        );
        let thread = spawn(
            open,
            entries_out,
            Returned {
                snapshots,
                looks,
                shapes,
            },
            network_out,
            flags.clone(),
            Arc::default(),
            bell,
        )
        .expect("thread");
        while !Flags::is_up(&flags.record_failed) {
            std::thread::sleep(POLL);
        }
        let summary = SessionSummary::empty(sulcus_proto::control::EndReason::Recording);
        network
            .send(FromNetwork::End(Box::new(summary)))
            .expect("heard");
        let report = thread.join().expect("no panic");
        assert!(report.error.expect("an error").contains("in order"));
        let recording = sulcus_sessions::Recording::open(&path).expect("readable");
        assert_eq!(recording.facts().rows, 2);
    }

    #[test]
    fn a_recorder_that_panics_is_told_at_once() {
        let (flags, bell) = (Arc::new(Flags::default()), Bell::new().expect("eventfd"));
        let alarm = || Alarm {
            flags: flags.clone(),
            bell: bell.clone(),
        };
        drop(alarm());
        assert!(!Flags::is_up(&flags.record_failed), "nothing happened");
        let alarm = alarm();
        let thread: JoinHandle<()> = std::thread::spawn(move || {
            let _alarm = alarm;
            panic!("a recorder that panics");
        });
        assert!(thread.join().is_err());
        assert!(Flags::is_up(&flags.record_failed));
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()
            .expect("runtime");
        runtime.block_on(async {
            let mut heard = bell.listen().expect("registered");
            let rung = tokio::time::timeout(Duration::from_secs(5), heard.rung());
            assert!(rung.await.is_ok());
        });
    }
}
