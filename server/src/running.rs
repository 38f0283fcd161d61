//! A session's two threads and the hand-overs between them, seen from the network.

use std::sync::Arc;
use std::sync::mpsc::{Sender, channel};
use std::thread::JoinHandle;

use rtrb::{Producer, RingBuffer};
use sulcus_core::State;
use sulcus_proto::SessionSummary;
use sulcus_proto::control::{EndReason, Event};
use sulcus_proto::newest::ArrivalCounts;
use triple_buffer::{Input, Output, triple_buffer};

use crate::ServerConfig;
use crate::handoff::{Bell, EDGES, Edge, Flags, PoseIn, ROWS, SNAPSHOTS, WrenchOut};
use crate::metrics::Metrics;
use crate::recording::{self, FromNetwork, Plan, Report};
use crate::simulation::Simulation;

/// A session whose threads run.
pub(crate) struct Running {
    flags: Arc<Flags>,
    bell: Bell,
    edges: Producer<Edge>,
    edges_dropped: u64,
    to_recorder: Sender<FromNetwork>,
    simulation: JoinHandle<Metrics>,
    recorder: JoinHandle<Report>,
}

/// A session and the network's ends of its triple buffers.
pub(crate) struct Started {
    pub running: Running,
    pub poses: Input<Option<PoseIn>>,
    pub wrenches: Output<WrenchOut>,
}

impl Running {
    /// Opens the recording, then starts the threads. Blocks while the scene is written.
    pub fn start(config: &ServerConfig, plan: Plan) -> Result<Started, (EndReason, String)> {
        let recorder =
            recording::open(config, plan).map_err(|text| (EndReason::Recording, text))?;
        let start = || -> std::io::Result<Started> {
            let bell = Bell::new()?;
            let flags = Arc::new(Flags::default());
            let (poses, poses_out) = triple_buffer(&None);
            let (wrenches_in, wrenches) = triple_buffer(&WrenchOut::default());
            let (edges, edges_out) = RingBuffer::new(EDGES);
            let (entries, entries_out) = RingBuffer::new(ROWS);
            let (mut buffers, buffers_out) = RingBuffer::new(SNAPSHOTS);
            let bytes = State::bytes_len(&config.scene);
            while buffers.push(Vec::with_capacity(bytes)).is_ok() {}
            let (to_recorder, from_network) = channel();
            let recorder = recording::spawn(
                recorder,
                entries_out,
                buffers,
                from_network,
                flags.clone(),
                bell.clone(),
            )?;
            let simulation = Simulation {
                scene: config.scene.clone(),
                poses: poses_out,
                edges: edges_out,
                wrenches: wrenches_in,
                bell: bell.clone(),
                flags: flags.clone(),
                entries,
                buffers: buffers_out,
                real_time: config.real_time,
            };
            // Should this fail, the recorder sees its queue and channel abandoned and finishes.
            let simulation = simulation.spawn()?;
            let running = Running {
                flags,
                bell,
                edges,
                edges_dropped: 0,
                to_recorder,
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

    /// Rung after every tick, and when a thread leaves or fails.
    pub fn bell(&self) -> &Bell {
        &self.bell
    }

    /// Flags of this session.
    pub fn flags(&self) -> &Flags {
        &self.flags
    }

    /// Hands an edge to the simulation; a full ring is counted.
    pub fn edge(&mut self, edge: Edge) {
        if self.edges.push(edge).is_err() {
            self.edges_dropped += 1;
            tracing::error!("the simulation does not take commands: {edge:?} was dropped");
        }
    }

    /// Hands an event to the recorder.
    pub fn event(&mut self, event: Event) {
        // A recorder that is gone has raised its flag.
        let _ = self.to_recorder.send(FromNetwork::Event(event));
    }

    /// Stops the simulation, finishes and signs the recording; blocks until both are done. Returns
    /// the summary and one sentence for people.
    pub fn finish(self, reason: EndReason, poses: ArrivalCounts) -> (SessionSummary, String) {
        Flags::raise(&self.flags.stop);
        let mut summary = SessionSummary::empty(reason);
        summary.edges_dropped = self.edges_dropped;
        summary.poses = poses;
        match self.simulation.join() {
            Ok(metrics) => metrics.fill(&mut summary),
            Err(_) => summary.end = EndReason::Simulation,
        }
        // With the simulation gone, the queue holds all there will ever be.
        let _ = self
            .to_recorder
            .send(FromNetwork::End(Box::new(summary.clone())));
        let mut text = match summary.end {
            EndReason::Stopped => "The session was stopped.",
            EndReason::TimeUp => "The time is up.",
            EndReason::Shutdown => "The server is shutting down.",
            EndReason::ConnectionLost => "The connection was lost.",
            EndReason::Protocol => {
                "The client broke the protocol; install the same release on both."
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
                    text.push_str(" Rows of the recording were lost: it cannot be graded.");
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
                text = "The recorder ended unexpectedly.".to_owned();
            }
        }
        if !summary.complete {
            tracing::error!("{text}");
        }
        (summary, text)
    }
}
