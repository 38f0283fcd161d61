//! Threads of a session, simulation and recorder, and their hand-overs, as the network uses them.

use std::sync::Arc;
use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread::JoinHandle;

use rtrb::RingBuffer;
use sulcus_core::{State, Vec3};
use sulcus_link::Bell;
use sulcus_proto::SessionSummary;
use sulcus_proto::control::{EndReason, Event};
use sulcus_proto::newest::ArrivalCounts;
use sulcus_sessions::Shapes;
use triple_buffer::{Input, Output, triple_buffer};

use crate::ServerConfig;
use crate::outlets::recording;
use crate::outlets::recording::{EVENTS, FromNetwork, Plan, Report, Returned};
use crate::session::handoff::{
    Flags, PoseIn, Pressed, SHAPES, SNAPSHOTS, WrenchOut, looks as looks_for, rows,
};
use crate::session::levels::Levels;
use crate::session::metrics::Metrics;
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
        let bytes = self.bytes + event.kind.len() + event.json.len();
        // A recorder that has ended has raised its flag, after a panic by its alarm.
        if bytes <= EVENT_BYTES && self.to_recorder.try_send(FromNetwork::Event(event)).is_ok() {
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

/// A running session: handles of its threads.
pub(crate) struct Running {
    flags: Arc<Flags>,
    _abandoned: Abandoned,
    bell: Bell,
    pressed: Arc<Pressed>,
    events: Events,
    simulation: JoinHandle<Metrics>,
    recorder: JoinHandle<Report>,
}

/// A new session and the network's ends of its triple buffers.
pub(crate) struct Started {
    pub running: Running,
    pub poses: Input<Option<PoseIn>>,
    pub wrenches: Output<WrenchOut>,
}

impl Running {
    /// Opens the recording, then starts both threads. The first tick obeys `levels`. Blocks while the scene is written.
    ///
    /// # Errors
    /// The reason of the end and one sentence: the recording cannot be written, or a thread cannot start.
    pub fn start(
        config: &ServerConfig,
        plan: Plan,
        levels: Levels,
    ) -> Result<Started, (EndReason, String)> {
        let recorder =
            recording::open(config, plan).map_err(|text| (EndReason::Recording, text))?;
        let start = || -> std::io::Result<Started> {
            let bell = Bell::new()?;
            let flags = Arc::new(Flags::default());
            let (poses, poses_out) = triple_buffer(&None);
            let (wrenches_in, wrenches) = triple_buffer(&WrenchOut::default());
            let pressed = Arc::<Pressed>::default();
            let rows = rows(&config.scene.params);
            let (entries, entries_out) = RingBuffer::new(rows);
            let (mut snapshots, buffers_out) = RingBuffer::new(SNAPSHOTS);
            let bytes = State::most_bytes(&config.scene);
            while snapshots.push(Vec::with_capacity(bytes)).is_ok() {}
            let look = recorder.narrator().look().clone();
            let (mut looks, looks_out) = RingBuffer::new(looks_for(rows, look.every()));
            while looks.push(vec![Vec3::zeros(); look.len()]).is_ok() {}
            let sampler = recorder.sampler();
            let (mut shapes, shapes_out) = RingBuffer::new(SHAPES);
            let room = Shapes::new(&config.scene);
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
                bell.clone(),
            )?;
            let simulation = Simulation {
                scene: config.scene.clone(),
                poses: poses_out,
                levels,
                pressed: pressed.clone(),
                wrenches: wrenches_in,
                bell: bell.clone(),
                flags: flags.clone(),
                entries,
                buffers: buffers_out,
                look,
                looks: looks_out,
                sampler,
                shapes: shapes_out,
                detail: config.detail,
                real_time: config.real_time,
            };
            // After an error the recorder's channel is closed: the recorder ends, and the file has no end record.
            let simulation = simulation.spawn()?;
            let running = Running {
                _abandoned: Abandoned(flags.clone()),
                flags,
                bell,
                pressed,
                events: Events::new(to_recorder),
                simulation,
                recorder,
            };
            Ok(Started {
                running,
                poses,
                wrenches,
            })
        };
        start().map_err(|error| {
            (
                EndReason::Simulation,
                format!("cannot start the simulation: {error}"),
            )
        })
    }

    /// Wake-up of the network: after every tick, at the end of the simulation, and at a failure of the recorder.
    pub fn bell(&self) -> &Bell {
        &self.bell
    }

    /// Flags of this session.
    pub fn flags(&self) -> &Flags {
        &self.flags
    }

    /// Passes the press of a button to the simulation.
    pub fn press(&self, tool: u8, button: u8) {
        self.pressed.press(tool, button);
    }

    /// Passes an event to the recorder. An event above the limits is dropped and counted.
    pub fn event(&mut self, event: Event) {
        self.events.push(event);
    }

    /// Stops the simulation, then finishes and signs the recording. Blocks until both threads have ended.
    ///
    /// Returns the summary and a short text for the goodbye. The end in the summary is `reason`, unless a thread
    /// failed.
    pub fn finish(self, reason: EndReason, poses: ArrivalCounts) -> (SessionSummary, String) {
        Flags::raise(&self.flags.stop);
        let mut summary = SessionSummary::empty(reason);
        summary.edges_dropped = self.events.dropped;
        summary.poses = poses;
        match self.simulation.join() {
            Ok(metrics) => metrics.fill(&mut summary),
            Err(_) => summary.end = EndReason::Simulation,
        }
        // The simulation has ended: the queue holds all remaining entries.
        let _ = self
            .events
            .to_recorder
            .send(FromNetwork::End(Box::new(summary.clone())));
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
        }
        .to_owned();
        match self.recorder.join() {
            Ok(Report {
                file_name,
                error: None,
            }) => {
                summary.recording = file_name;
                summary.complete =
                    summary.rows_dropped == 0 && summary.end != EndReason::Simulation;
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
