//! The recorder thread: takes the simulation's queue, writes and signs the recording, returns buffers.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError};
use std::thread::JoinHandle;
use std::time::Duration;

use rtrb::{Consumer, Producer};
use sulcus_core::{Scene, State, TickOutput, Vec3};
use sulcus_link::Bell;
use sulcus_link::clock::unix_ns;
use sulcus_proto::SessionSummary;
use sulcus_proto::control::{ClientHello, Event};
use sulcus_sessions::exercise::events::{LOST, Look};
use sulcus_sessions::{
    Events, Exercise, Level, Occurrence, RecordError, RecordedTick, Recorder, Row, Sampler,
    SessionEnd, SessionHeader, SessionWriter, Shapes, StationKey,
};

use crate::ServerConfig;
use crate::session::changes::Changes;
use crate::session::handoff::Flags;
use crate::session::levels::InForce;

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
    /// Row of a tick, its output, its CPU time in nanoseconds, and the levels of both sides. The recorder's thread
    /// finds the events and makes the viewers' messages.
    Tick(Row, TickOutput, u32, InForce),
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

/// Message from the network to the recorder.
pub(crate) enum FromNetwork {
    /// Event of the client.
    Event(Event),
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

/// Facts of a session before its recording.
pub(crate) struct Plan {
    learner: String,
    client: String,
    started_unix_ns: u64,
}

impl Plan {
    pub fn new(config: &ServerConfig, hello: &ClientHello) -> Self {
        let learner = if hello.learner.is_empty() {
            &config.learner
        } else {
            &hello.learner
        };
        Self {
            learner: learner.clone(),
            client: format!("client {} with device {}", hello.program, hello.device),
            started_unix_ns: unix_ns(),
        }
    }
}

/// An open recording with header, scene and the state before the first tick; its file's name; the finder of events.
pub(crate) struct Open(SessionWriter, String, Narrator);

/// Finder of a session's events.
pub(crate) struct Narrator {
    scene: Arc<Scene>,
    events: Events,
}

impl Narrator {
    fn new(config: &ServerConfig) -> Self {
        let exercise = Exercise::recorded(&config.exercise.definition);
        let events = Events::new(&config.scene, &exercise);
        for what in events.missing() {
            tracing::warn!(
                "exercise `{}` needs {what}, which scene `{}` lacks",
                config.exercise.name,
                config.scene.name
            );
        }
        Self {
            scene: config.scene.clone(),
            events,
        }
    }

    /// Reader of the shapes that events need.
    pub fn look(&self) -> &Look {
        self.events.look()
    }
}

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

/// Rings of buffers from the recorder back to the simulation.
pub(crate) struct Returned {
    /// Buffers of snapshots.
    pub snapshots: Producer<Vec<u8>>,
    /// Buffers of looks.
    pub looks: Producer<Vec<Vec3>>,
    /// Buffers of shapes for viewers.
    pub shapes: Producer<Box<Shapes>>,
}

/// Opens a recording under a new name and writes header, scene and first state.
///
/// # Errors
/// One sentence: the key is unusable, the folder is missing, the disk is full, or a thousand sessions began in this
/// second.
pub(crate) fn open(config: &ServerConfig, plan: Plan) -> Result<Open, String> {
    let header = SessionHeader {
        exercise_name: config.exercise.name.clone(),
        exercise: config.exercise.definition.clone(),
        patient: config.patient.clone(),
        rubric: config.rubric.clone(),
        seed: config.exercise.seed,
        station: config.station.clone(),
        learner_id: plan.learner,
        mode: Some(config.mode),
        started_unix_ns: plan.started_unix_ns,
        ..SessionHeader::new(config.scene_bytes.to_vec())
    };
    let key = station_key(config.station_key.as_deref()).map_err(|error| error.to_string())?;
    let (recorder, path) = Recorder::create_in(&config.recordings, &header, &key)
        .map_err(|error| error.to_string())?;
    let name = path
        .file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned();
    let begin = State::new(&config.scene).to_bytes();
    let (started, opening) = (plan.started_unix_ns, Some(plan.client.as_str()));
    let mut writer = SessionWriter::begin(recorder, &config.scene, started, &begin, opening)
        .map_err(|error| error.to_string())?;
    writer.flush().map_err(|error| error.to_string())?;
    Ok(Open(writer, name, Narrator::new(config)))
}

/// Key that signs recordings, from `path`, else from [`StationKey::default_path`]. A missing key is created.
pub(crate) fn station_key(path: Option<&Path>) -> Result<StationKey, sulcus_sessions::KeyError> {
    let path = path.map_or_else(StationKey::default_path, |path| Ok(PathBuf::from(path)))?;
    StationKey::load_or_create(&path)
}

/// Starts the recorder's thread. The thread ends after [`FromNetwork::End`], or without an end record when the
/// network's side is dropped.
pub(crate) fn spawn(
    open: Open,
    entries: Consumer<Entry>,
    returned: Returned,
    network: Receiver<FromNetwork>,
    flags: Arc<Flags>,
    bell: Bell,
) -> std::io::Result<JoinHandle<Report>> {
    let Open(writer, file_name, narrator) = open;
    let thread = Thread {
        writer,
        narrator,
        look: None,
        shapes: None,
        changes: Changes::default(),
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
    /// Newest look, until its tick comes.
    look: Option<(u64, Vec<Vec3>)>,
    /// Newest shapes, until their tick comes.
    shapes: Option<Box<Shapes>>,
    /// Changes of pause and force limit.
    changes: Changes,
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
            self.drain();
            match self.network.try_recv() {
                Ok(FromNetwork::Event(event)) => {
                    let text = format!("{} at tick {}: {}", event.kind, event.tick, event.json);
                    let result = self.writer.event(unix_ns(), Level::Info, &text);
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
                Entry::Tick(row, output, cpu_ns, in_force) => {
                    self.tick(&row, &output, cpu_ns, in_force)
                }
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
    fn tick(
        &mut self,
        row: &Row,
        output: &TickOutput,
        cpu_ns: u32,
        in_force: InForce,
    ) -> Result<(), RecordError> {
        let look = self.look.take();
        let centres = look.as_ref().filter(|(tick, _)| *tick == output.tick);
        let centres = centres.map(|(_, centres)| centres.as_slice());
        let Narrator { scene, events } = &mut self.narrator;
        let changed = self.changes.take(row.tick, in_force);
        let found = events.take(scene, output, centres);
        let shapes = self.shapes.take();
        let recorded = RecordedTick {
            row,
            output,
            cpu_ns,
            shapes: shapes.as_deref(),
        };
        let written = self
            .writer
            .tick(scene, &recorded, changed.into_iter().chain(found));
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
        };
        for tick in [1, 2, 2] {
            entries
                .push(Entry::Tick(row(tick), output(tick), 0, InForce::default()))
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
        let open = Open(writer.expect("begun"), "session.mcap".into(), narrator);
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
            let heard = bell.listen().expect("registered");
            let rung = tokio::time::timeout(Duration::from_secs(5), heard.readable());
            assert!(rung.await.expect("rung").is_ok());
        });
    }
}
