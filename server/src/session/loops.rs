//! Everything of a session before its threads: the loops of ticks and recorder, and their hand-overs.

use std::sync::mpsc::sync_channel;
use std::sync::{Arc, Mutex};

use rtrb::RingBuffer;
use sulcus_core::{State, Vec3};
use sulcus_link::Bell;
use sulcus_link::clock::Clock;
use sulcus_proto::control::EndReason;
use sulcus_sessions::Shapes;
use triple_buffer::triple_buffer;

use crate::net::datagrams::Datagrams;
use crate::outlets::opening::{self, Opening};
use crate::outlets::recording::{EVENTS, Ends, Open, RecorderLoop, Returned};
use crate::session::at_hand::{HandLoop, HandTicks};
use crate::session::handoff::{
    Attachment, Flags, Pressed, Progress, SHAPES, SNAPSHOTS, WrenchOut, looks as looks_for, rows,
};
use crate::session::levels::Levels;
use crate::session::ports::{Events, Ports};
use crate::session::precedence::Places;
use crate::session::queue::Rings;
use crate::session::simulation::Simulation;
use crate::station::config::SessionPlan;

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

/// Loop of a session's ticks.
pub(super) enum Ticks {
    /// Ticks of the server, on the grid of its clock.
    Server(Box<(Simulation, Rings)>),
    /// Ticks at the hand, computed again.
    Hand(Box<HandLoop>),
}

/// Loops of a session, and the hand-overs between them and its student's connections.
pub(super) struct Loops {
    pub ports: Arc<Ports>,
    pub ticks: Ticks,
    pub recorder: RecorderLoop,
}

impl Loops {
    /// Opens the recording, then makes the loops. Blocks while the scene is written, and copied if its couplings
    /// change.
    ///
    /// # Errors
    /// The reason of the end and one sentence: the couplings do not fit the scene, the recording cannot be written, or
    /// the system has no wake-up.
    pub fn open(
        mut asked: Opening,
        begin: Begin,
        clock: Clock,
    ) -> Result<Self, (EndReason, String)> {
        if !asked.softer.is_empty() {
            let coupled = asked.plan.with_couplings(&asked.softer);
            let coupled = coupled.map_err(|error| (EndReason::Simulation, error.to_string()))?;
            asked.plan = Arc::new(coupled);
        }
        let plan = asked.plan.clone();
        let recorder = opening::open(asked, clock.unix_ns());
        let recorder = recorder.map_err(|text| (EndReason::Recording, text))?;
        Self::new(recorder, &plan, begin, clock).map_err(no_start)
    }

    /// Loops of a session with an open recording.
    fn new(
        recorder: Open,
        plan: &SessionPlan,
        begin: Begin,
        clock: Clock,
    ) -> std::io::Result<Self> {
        let scene = &plan.scene;
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
        let ends = Ends {
            entries: entries_out,
            returned: Returned {
                snapshots,
                looks,
                shapes,
            },
            network: from_network,
            flags: flags.clone(),
            attachment: attachment.clone(),
            bell: bell.clone(),
            clock: clock.clone(),
        };
        let recorder = RecorderLoop::new(recorder, ends);
        let rings = Rings {
            entries,
            buffers: buffers_out,
            look,
            looks: looks_out,
            sampler,
            shapes: shapes_out,
        };
        let (ticks, hand) = if begin.at_hand {
            let ticks = HandTicks {
                scene: scene.clone(),
                levels: begin.levels,
                detail: plan.detail.fixed().unwrap_or(0),
                bell: bell.clone(),
                flags: flags.clone(),
                progress: progress.clone(),
                to_recorder: to_recorder.clone(),
            };
            let (ticks, port) = ticks.with_port(rings);
            (Ticks::Hand(Box::new(ticks)), Some(port))
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
                clock,
                real_time: begin.real_time,
                places: begin.places,
                core: begin.core,
            };
            (Ticks::Server(Box::new((simulation, rings))), None)
        };
        let ports = Arc::new(Ports {
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
        });
        Ok(Self {
            ports,
            ticks,
            recorder,
        })
    }
}

/// Reason of the end and sentence for an error of the system at the start of a session.
pub(super) fn no_start(error: std::io::Error) -> (EndReason, String) {
    let text = format!("cannot start the simulation: {error}");
    (EndReason::Simulation, text)
}
