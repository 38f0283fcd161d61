//! Threads of a session, simulation and recorder, and their hand-overs, as the station and its connections use them.

use std::sync::atomic::Ordering;
use std::sync::mpsc::{SyncSender, sync_channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;

use rtrb::RingBuffer;
use sulcus_core::{State, Vec3};
use sulcus_link::Bell;
use sulcus_proto::SessionSummary;
use sulcus_proto::control::{EndReason, Event};
use sulcus_sessions::{Detached, Occurrence, Shapes};
use triple_buffer::triple_buffer;

use crate::net::datagrams::Datagrams;
use crate::outlets::opening::{self, Opening};
use crate::outlets::recording;
use crate::outlets::recording::{EVENTS, FromNetwork, Report, Returned};
use crate::session::at_hand::{HandPort, HandTicks};
use crate::session::handoff::{
    Attachment, Flags, Pressed, Progress, Provoked, SHAPES, SNAPSHOTS, WrenchOut,
    looks as looks_for, rows,
};
use crate::session::levels::Levels;
use crate::session::metrics::Metrics;
use crate::session::precedence::Places;
use crate::session::queue::Rings;
use crate::session::simulation::Simulation;

/// Largest sum of a client's events in one session, bytes of kind and content. A client must not fill the disk.
const EVENT_BYTES: usize = 1024 * 1024;

/// Stops the simulation when a session is dropped without [`Running::finish`].
struct Abandoned(Arc<Flags>);

impl Drop for Abandoned {
    fn drop(&mut self) {
        Flags::raise(&self.0.stop);
    }
}

/// Channel of a client's events to the recorder, bounded in number and in bytes. A push never blocks.
#[derive(Debug)]
struct Events {
    to_recorder: SyncSender<FromNetwork>,
    /// Sum of the accepted events, bytes.
    bytes: usize,
    /// Number of events that found the queue full or the bytes used up.
    dropped: u64,
}

impl Events {
    fn new(to_recorder: SyncSender<FromNetwork>) -> Self {
        Self {
            to_recorder,
            bytes: 0,
            dropped: 0,
        }
    }

    fn push(&mut self, event: Event) {
        let to_recorder = self.to_recorder.clone();
        // A recorder that has ended has raised its flag, after a panic by its alarm.
        self.push_to(event, |event| {
            to_recorder.try_send(FromNetwork::Event(event)).is_ok()
        });
    }

    /// Passes an event within the limits to `take`, which returns whether it has taken the event.
    fn push_to(&mut self, event: Event, take: impl FnOnce(Event) -> bool) {
        let bytes = self.bytes + event.kind.len() + event.json.len();
        if bytes <= EVENT_BYTES && take(event) {
            self.bytes = bytes;
            return;
        }
        if self.dropped == 0 {
            tracing::warn!(
                "the client sent more than {EVENT_BYTES} bytes of events, or more than {EVENTS} events at once: \
                 further events may be dropped"
            );
        }
        self.dropped += 1;
    }
}

/// Ends of a session's hand-overs for the connections of its student. The connection that is attached uses them; a
/// later connection takes over.
#[derive(Debug)]
pub(crate) struct Ports {
    datagrams: Mutex<Datagrams>,
    events: Mutex<Events>,
    pressed: Arc<Pressed>,
    bell: Bell,
    flags: Arc<Flags>,
    progress: Arc<Progress>,
    attachment: Arc<Attachment>,
    /// Ends of ticks at the hand; `None` if the server ticks.
    hand: Option<HandPort>,
}

impl Ports {
    /// Ends of ticks at the hand; `None` if the server ticks.
    pub fn hand(&self) -> Option<&HandPort> {
        self.hand.as_ref()
    }

    /// Datagrams of the session. The lock is held for one datagram at most, and never across an `await`.
    pub fn datagrams(&self) -> MutexGuard<'_, Datagrams> {
        // After a panic of a connection the datagrams are whole: each step leaves them consistent.
        self.datagrams
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
    }

    /// Wake-up of the network: after every tick, at the end of the simulation, and at a failure of the recorder.
    pub fn bell(&self) -> &Bell {
        &self.bell
    }

    /// Flags of the session.
    pub fn flags(&self) -> &Flags {
        &self.flags
    }

    /// Progress of the simulation.
    pub fn progress(&self) -> &Progress {
        &self.progress
    }

    /// Takes all tools away: the student is gone. The recording holds the reason.
    pub fn let_go(&self, reason: Detached) {
        self.attachment.gone(reason);
        self.datagrams().let_go();
    }

    /// A student is back over another connection.
    pub fn returned(&self) {
        if let Some(hand) = &self.hand {
            hand.returned();
        }
    }

    /// Begins the epoch of a new connection, or of the end of a pause.
    pub fn begin_epoch(&self, epoch: u32) {
        self.attachment.epoch.store(epoch, Ordering::Release);
        self.datagrams().begin_epoch(epoch);
    }

    /// Newest tick.
    pub fn tick(&self) -> u64 {
        self.progress.tick.load(Ordering::Relaxed)
    }

    /// Passes the press of a button to the simulation.
    pub fn press(&self, tool: u8, button: u8) {
        self.pressed.press(tool, button);
    }

    /// Passes an event of the client to the recorder. An event above the limits is dropped and counted.
    pub fn event(&self, event: Event) {
        let mut events = self.events();
        match &self.hand {
            // The recorder must not hear of a tick before it has the tick.
            Some(hand) => events.push_to(event, |event| hand.event(event)),
            None => events.push(event),
        }
    }

    /// Passes an event of the station to the recorder at the end of the session. Waits for room.
    fn say(&self, occurrence: Occurrence) {
        let to_recorder = self.events().to_recorder.clone();
        // A recorder that has ended has raised its flag.
        let _ = to_recorder.send(FromNetwork::Occurrence(Box::new(occurrence)));
    }

    /// Passes an event of the station to the recorder. `false`: the recorder's channel is full or closed.
    pub fn occurrence(&self, occurrence: Occurrence) -> bool {
        let message = FromNetwork::Occurrence(Box::new(occurrence));
        self.events().to_recorder.try_send(message).is_ok()
    }

    fn events(&self) -> MutexGuard<'_, Events> {
        self.events.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A running session: handles of its threads.
pub(crate) struct Running {
    file_name: String,
    _abandoned: Abandoned,
    ports: Arc<Ports>,
    simulation: JoinHandle<Metrics>,
    recorder: JoinHandle<Report>,
}

/// Facts for the start of a session besides its opened recording.
pub(crate) struct Begin {
    /// Session epoch of the first connection.
    pub epoch: u32,
    /// Pause and force limit, which the first tick obeys.
    pub levels: Levels,
    /// Whether to request real-time scheduling and locked memory.
    pub real_time: bool,
    /// Places behind the other stations of the server.
    pub places: Arc<Places>,
    /// Core of the simulation; `None`: any.
    pub core: Option<usize>,
    /// Whether the ticks run at the hand. The level of detail is then fixed.
    pub at_hand: bool,
}

impl Running {
    /// Opens the recording, then starts both threads. Blocks while the scene is written, and copied if its couplings
    /// change.
    ///
    /// # Errors
    /// The reason of the end and one sentence: the couplings do not fit the scene, the recording cannot be written, or
    /// a thread cannot start.
    pub fn start(mut asked: Opening, begin: Begin) -> Result<Self, (EndReason, String)> {
        if !asked.softer.is_empty() {
            let coupled = asked.plan.with_couplings(&asked.softer);
            let coupled = coupled.map_err(|error| (EndReason::Simulation, error.to_string()))?;
            asked.plan = Arc::new(coupled);
        }
        let plan = asked.plan.clone();
        let recorder = opening::open(asked).map_err(|text| (EndReason::Recording, text))?;
        let start = || -> std::io::Result<Self> {
            let scene = &plan.scene;
            let file_name = recorder.file_name().to_owned();
            let bell = Bell::new()?;
            let flags = Arc::new(Flags::default());
            let progress = Arc::<Progress>::default();
            let attachment = Arc::<Attachment>::default();
            let (poses, poses_out) = triple_buffer(&None);
            let (wrenches_in, wrenches) = triple_buffer(&WrenchOut::default());
            let pressed = Arc::<Pressed>::default();
            let rows = rows(&scene.params);
            let (entries, entries_out) = RingBuffer::new(rows);
            let (mut snapshots, buffers_out) = RingBuffer::new(SNAPSHOTS);
            let bytes = State::most_bytes(scene);
            while snapshots.push(Vec::with_capacity(bytes)).is_ok() {}
            let look = recorder.narrator().look().clone();
            let (mut looks, looks_out) = RingBuffer::new(looks_for(rows, look.every()));
            while looks.push(vec![Vec3::zeros(); look.len()]).is_ok() {}
            let sampler = recorder.sampler();
            let (mut shapes, shapes_out) = RingBuffer::new(SHAPES);
            let room = Shapes::new(scene);
            while shapes.push(Box::new(room.like())).is_ok() {}
            let (to_recorder, from_network) = sync_channel(EVENTS);
            let recorder = recording::spawn(
                recorder,
                entries_out,
                Returned {
                    snapshots,
                    looks,
                    shapes,
                },
                from_network,
                flags.clone(),
                attachment.clone(),
                bell.clone(),
            )?;
            let rings = Rings {
                entries,
                buffers: buffers_out,
                look,
                looks: looks_out,
                sampler,
                shapes: shapes_out,
            };
            // After an error the recorder's channel is closed: the recorder ends, and the file has no end record.
            let (simulation, hand) = if begin.at_hand {
                let ticks = HandTicks {
                    scene: scene.clone(),
                    levels: begin.levels,
                    detail: plan.detail.fixed().unwrap_or(0),
                    bell: bell.clone(),
                    flags: flags.clone(),
                    progress: progress.clone(),
                    to_recorder: to_recorder.clone(),
                };
                let (thread, port) = ticks.spawn(rings)?;
                (thread, Some(port))
            } else {
                let simulation = Simulation {
                    scene: scene.clone(),
                    poses: poses_out,
                    levels: begin.levels,
                    pressed: pressed.clone(),
                    wrenches: wrenches_in,
                    bell: bell.clone(),
                    flags: flags.clone(),
                    progress: progress.clone(),
                    detail: plan.detail,
                    real_time: begin.real_time,
                    places: begin.places,
                    core: begin.core,
                };
                (simulation.spawn(rings)?, None)
            };
            Ok(Running {
                file_name,
                _abandoned: Abandoned(flags.clone()),
                ports: Arc::new(Ports {
                    datagrams: Mutex::new(Datagrams::new(
                        begin.epoch,
                        scene.params.tick_ns(),
                        poses,
                        wrenches,
                    )),
                    events: Mutex::new(Events::new(to_recorder)),
                    pressed,
                    bell,
                    flags,
                    progress,
                    attachment,
                    hand,
                }),
                simulation,
                recorder,
            })
        };
        start().map_err(|error| {
            (
                EndReason::Simulation,
                format!("cannot start the simulation: {error}"),
            )
        })
    }

    /// File name of the recording.
    pub fn file_name(&self) -> &str {
        &self.file_name
    }

    /// Hand-overs for the student's connections.
    pub fn ports(&self) -> &Arc<Ports> {
        &self.ports
    }

    /// Provokes a fault, for a test.
    pub fn provoke(&self, fault: Provoked) {
        let flags = self.ports.flags();
        flags.provoked.store(fault as u8, Ordering::Relaxed);
    }

    /// Stops the simulation, then finishes and signs the recording. Blocks until both threads have ended.
    ///
    /// Completes `summary`, which holds the reason of the end and the gaps, and returns it with a short text for the
    /// goodbye. After the failure of a thread the summary has another reason.
    pub fn finish(self, mut summary: SessionSummary) -> (SessionSummary, String) {
        Flags::raise(&self.ports.flags.stop);
        if let Some(hand) = &self.ports.hand {
            hand.stop();
        }
        summary.edges_dropped = self.ports.events().dropped;
        {
            let datagrams = self.ports.datagrams();
            summary.poses = datagrams.counts();
            (summary.foreign, summary.malformed) = (datagrams.foreign, datagrams.malformed);
        }
        match self.simulation.join() {
            Ok(metrics) => metrics.fill(&mut summary),
            Err(_) => summary.end = EndReason::Simulation,
        }
        let stopped = summary.end == EndReason::Stopped;
        let breach = self.ports.hand.as_ref();
        let breach = breach.and_then(|hand| hand.breach(stopped));
        if let Some(breach) = &breach {
            summary.end = EndReason::Diverged;
            self.ports
                .say(Occurrence::diverged(breach.tick, &breach.why));
        }
        // The simulation has ended: the queue holds all remaining entries.
        let to_recorder = self.ports.events().to_recorder.clone();
        let _ = to_recorder.send(FromNetwork::End(Box::new(summary.clone())));
        let mut text = match summary.end {
            EndReason::Stopped => "The session was stopped.",
            EndReason::TimeUp => "The session has reached its time limit.",
            EndReason::Shutdown => "The server is shutting down.",
            EndReason::ConnectionLost => "The connection was lost.",
            EndReason::Protocol => {
                "The client violated the protocol; install the same release of client and server."
            }
            EndReason::Recording => "The recording could not be written.",
            EndReason::Simulation => "The simulation ended unexpectedly.",
            EndReason::Instructor => "The instructor ended the session.",
            EndReason::Diverged => {
                "The ticks at the hand are not those of the station; the session cannot be graded."
            }
        }
        .to_owned();
        if let Some(breach) = breach {
            text.push_str(&format!(" Cause, {breach}."));
        }
        match self.recorder.join() {
            Ok(Report {
                file_name,
                error: None,
            }) => {
                summary.recording = file_name;
                summary.complete = summary.rows_dropped == 0
                    && !matches!(summary.end, EndReason::Simulation | EndReason::Diverged);
                if summary.rows_dropped > 0 {
                    text.push_str(" The recording has lost rows and cannot be graded.");
                }
            }
            Ok(Report {
                file_name,
                error: Some(error),
            }) => {
                summary.end = EndReason::Recording;
                text = format!("The recording {file_name} could not be written: {error}.");
                summary.recording = file_name;
            }
            Err(_) => {
                summary.end = EndReason::Recording;
                text = "The recorder ended unexpectedly; the recording has no end.".to_owned();
            }
        }
        if !summary.complete {
            tracing::error!("{text}");
        }
        (summary, text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn event(bytes: usize) -> Event {
        Event {
            tick: 1,
            kind: String::new(),
            json: "x".repeat(bytes),
        }
    }

    #[test]
    fn events_are_bounded_in_number_and_in_bytes() {
        let (sender, recorder) = sync_channel(EVENTS);
        let mut events = Events::new(sender);
        for _ in 0..EVENTS + 2 {
            events.push(event(1));
        }
        assert_eq!(events.dropped, 2);
        assert_eq!(recorder.try_iter().count(), EVENTS);
        events.push(event(EVENT_BYTES - EVENTS));
        events.push(event(1));
        assert_eq!(events.dropped, 3);
        assert_eq!(recorder.try_iter().count(), 1);
    }
}
