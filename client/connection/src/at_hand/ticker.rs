//! The ticks of a session beside the device.

use std::sync::Arc;

use sulcus_core::clearance::{FREE_DISTANCE, is_free};
use sulcus_core::output::status;
use sulcus_core::{
    MAX_TOOLS, NoProbe, Scene, SceneError, State, TickInput, TickOutput, ToolInput, Workspace, tick,
};
use sulcus_proto::WrenchDatagram;
use sulcus_proto::at_hand::{HandRow, HandTool};
use sulcus_proto::control::Command;
use sulcus_proto::datagram::{
    Echo, ToolPose, ToolWrench, WireLevels, WirePose, WireWrench, smaller_limit,
};
use sulcus_proto::status::FREE;

use super::coupled;
use super::outbox::Out;
use crate::link::{Link, WrenchPacket};

/// Interval between two looks at the clearance of the tools, seconds.
const CLEARANCE_S: f64 = 0.016;

/// Computes the ticks of a session, one for each pass of the device's loop.
pub struct HandTicker {
    scene: Arc<Scene>,
    state: State,
    workspace: Workspace,
    /// Levels of the student, which need no server.
    own: WireLevels,
    /// Wrenches of the tick before, as on the wire.
    ticked: [WireWrench; MAX_TOOLS],
    free: [bool; MAX_TOOLS],
    next_clearance: u64,
    newest: Option<WrenchDatagram>,
    /// Times of the newest readings, for the age of the wrench.
    read_ns: u64,
    /// Number of the run.
    run: u32,
    log: Option<Vec<Ticked>>,
}

/// A tick of the log: see [`HandTicker::logged`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ticked {
    /// Number of the tick.
    pub tick: u64,
    /// State hash after the tick.
    pub hash: u64,
    /// For each tool the wrench of the tick, as on the wire: force (N), torque (N m).
    pub wrench: [WireWrench; MAX_TOOLS],
}

impl HandTicker {
    /// Ticks in a scene with the couplings in force: see [`super::coupled`].
    pub fn new(scene: Arc<Scene>) -> Self {
        Self {
            state: State::new(&scene),
            workspace: Workspace::new(&scene),
            own: WireLevels::default(),
            ticked: [WireWrench::default(); MAX_TOOLS],
            free: [false; MAX_TOOLS],
            next_clearance: 0,
            newest: None,
            read_ns: 0,
            run: 0,
            log: None,
            scene,
        }
    }

    /// Ticks in `scene` for a link whose ticks run at the hand; `None`: the server ticks.
    ///
    /// # Errors
    /// The couplings of the server's hello do not fit the scene.
    pub fn on(link: &Link, scene: &Arc<Scene>) -> Result<Option<Self>, SceneError> {
        if !link.ticks_at_hand() {
            return Ok(None);
        }
        coupled(scene, link.hello()).map(|scene| Some(Self::new(scene)))
    }

    /// The same ticker with a log of at most `ticks` ticks.
    #[must_use]
    pub fn logged(mut self, ticks: usize) -> Self {
        self.log = Some(Vec::with_capacity(ticks));
        self
    }

    /// Begins again from the first tick, as the run `run`: the server has lost the session. Levels of the student stay.
    pub fn begin_again(&mut self, run: u32) {
        *self = Self {
            own: self.own,
            log: self.log.take().map(|mut log| {
                log.clear();
                log
            }),
            run,
            ..Self::new(self.scene.clone())
        };
    }

    /// Log of the ticks so far, of the present run.
    pub fn log(&self) -> &[Ticked] {
        self.log.as_deref().unwrap_or_default()
    }

    /// Largest number of ticks in the log.
    pub fn log_room(&self) -> usize {
        self.log.as_ref().map_or(0, Vec::capacity)
    }

    /// Number of the run: see [`HandTicker::begin_again`].
    pub fn run(&self) -> u32 {
        self.run
    }

    /// Number of the newest tick; 0 before the first one.
    pub fn tick(&self) -> u64 {
        self.state.tick
    }

    /// Wrench of the newest tick, as if it had arrived at `now_ns`, with the levels that the server told in `told`.
    /// `None` before the first tick.
    pub fn newest(&self, told: Option<&WrenchPacket>, now_ns: u64) -> Option<WrenchPacket> {
        let told = told.map(|packet| packet.datagram.levels);
        let datagram = WrenchDatagram {
            levels: self.levels(told.unwrap_or_default()),
            ..self.newest?
        };
        Some(WrenchPacket {
            datagram,
            arrived_ns: now_ns,
            age_ns: Some(now_ns.saturating_sub(self.read_ns)),
        })
    }

    /// Takes a command of the student. The hand obeys it at once.
    pub fn command(&mut self, command: Command) {
        match command {
            Command::Pause => self.own.paused_by_student = true,
            Command::Resume => self.own.paused_by_student = false,
            Command::ForceLimit(newtons) if newtons.is_finite() && newtons >= 0.0 => {
                self.own.force_limit_n = newtons + 0.0;
            }
            Command::ForceLimit(_) => {}
        }
    }

    /// Levels of the server and of the student together.
    fn levels(&self, told: WireLevels) -> WireLevels {
        WireLevels {
            paused_by_station: told.paused_by_station,
            paused_by_student: self.own.paused_by_student,
            force_limit_n: smaller_limit(told.force_limit_n, self.own.force_limit_n),
            commands: told.commands,
        }
    }

    /// Computes the tick of a pass with the hands `tools`, whose readings are in `readings`, after `skipped` missed
    /// periods. Returns the row for the server.
    pub fn pass(
        &mut self,
        tools: &[ToolInput; MAX_TOOLS],
        readings: &[ToolPose; MAX_TOOLS],
        told: WireLevels,
        skipped: u64,
    ) -> Out {
        let levels = self.levels(told);
        let mut input = TickInput {
            paused: levels.paused_by_station || levels.paused_by_student,
            force_limit_n: levels.force_limit_n,
            skipped: u16::try_from(skipped).unwrap_or(u16::MAX),
            ..TickInput::IDLE
        };
        let held = tools.iter().take(self.scene.tools.len());
        for (slot, tool) in held.enumerate().filter(|(_, tool)| tool.present) {
            input.tools[slot] = *tool;
        }
        let output = tick(
            &self.scene,
            &mut self.state,
            &mut self.workspace,
            &input,
            &mut NoProbe,
        );
        let row = self.row(&input, readings);
        self.look_for_clearance(&output);
        self.show(&output, readings);
        self.read_ns = readings
            .iter()
            .map(|tool| tool.device_time_ns)
            .max()
            .unwrap_or(0);
        if let Some(log) = self.log.as_mut().filter(|log| log.len() < log.capacity()) {
            log.push(Ticked {
                tick: output.tick,
                hash: output.hash,
                wrench: self.ticked,
            });
        }
        Out {
            tick: output.tick,
            hash: output.hash,
            commands: levels.commands,
            run: self.run,
            row,
        }
    }

    fn row(&self, input: &TickInput, readings: &[ToolPose; MAX_TOOLS]) -> HandRow {
        let tools = std::array::from_fn(|slot| {
            let (tool, reading) = (&input.tools[slot], &readings[slot]);
            HandTool {
                present: tool.present,
                stale: tool.stale,
                age_ticks: tool.age_ticks,
                buttons: tool.buttons,
                pose: WirePose {
                    position: tool.pose.position,
                    orientation: tool.pose.orientation,
                },
                sequence: reading.sequence,
                device_time_ns: reading.device_time_ns,
                changed: HandTool::change(&reading.displayed, &self.ticked[slot]),
            }
        });
        HandRow {
            skipped: input.skipped,
            paused: input.paused,
            force_limit_n: input.force_limit_n,
            detail: input.detail,
            tools,
        }
    }

    /// Looks whether each tool is free of contacts. Devices arm only with a free tool.
    fn look_for_clearance(&mut self, output: &TickOutput) {
        if output.tick < self.next_clearance {
            return;
        }
        self.next_clearance = output.tick + self.scene.params.ticks_in(CLEARANCE_S).max(1);
        for (slot, (free, tool)) in self.free.iter_mut().zip(&output.tools).enumerate() {
            let held = tool.status & status::ABSENT == 0;
            let (scene, state, workspace) = (&self.scene, &self.state, &mut self.workspace);
            *free = held && is_free(scene, state, workspace, slot, &tool.haptic, FREE_DISTANCE);
        }
    }

    /// Keeps the wrenches of a tick for the device, as a server would send them.
    fn show(&mut self, output: &TickOutput, readings: &[ToolPose; MAX_TOOLS]) {
        let mut datagram = WrenchDatagram {
            tick: output.tick,
            ..WrenchDatagram::default()
        };
        for (slot, tool) in output.tools.iter().enumerate().take(self.scene.tools.len()) {
            let (force, torque) = (&tool.wrench.force, &tool.wrench.torque);
            let (p, q) = (&tool.graphic.position, &tool.graphic.orientation);
            let reading = &readings[slot];
            let echo = Echo {
                valid: true,
                sequence: reading.sequence,
                device_time_ns: reading.device_time_ns,
                hold_us: 0,
                wait_us: 0,
            };
            datagram.tools[slot] = ToolWrench {
                wrench: WireWrench {
                    force: [force.x as f32, force.y as f32, force.z as f32],
                    torque: [torque.x as f32, torque.y as f32, torque.z as f32],
                },
                graphic: WirePose {
                    position: [p.x as f32, p.y as f32, p.z as f32],
                    orientation: [q.w as f32, q.i as f32, q.j as f32, q.k as f32],
                },
                status: tool.status | if self.free[slot] { FREE } else { 0 },
                echo: if reading.present {
                    echo
                } else {
                    Echo::default()
                },
            };
            self.ticked[slot] = datagram.tools[slot].wrench;
        }
        self.newest = Some(datagram);
    }
}
