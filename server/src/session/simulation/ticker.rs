//! Steps of the simulation: each runs the tick that is due, hands its wrench to the network and queues its records.

use std::sync::Arc;
use std::sync::atomic::Ordering;

use sulcus_core::clearance::{FREE_DISTANCE, is_free};
use sulcus_core::output::status;
use sulcus_core::{MAX_TOOLS, NoProbe, Scene, State, TickInput, TickOutput, Workspace, tick};
use sulcus_link::schedule::fifo;
use sulcus_proto::WrenchDatagram;
use sulcus_proto::datagram::{Echo, ToolWrench, WirePose, WireWrench};
use sulcus_proto::status::FREE;
use sulcus_sessions::Row;

use super::Simulation;
use crate::outlets::recording::Ticked;
use crate::session::detail::Chooser;
use crate::session::grid::Grid;
use crate::session::handoff::{PoseIn, Provoked, WrenchOut};
use crate::session::inputs::Inputs;
use crate::session::levels::InForce;
use crate::session::metrics::{Metrics, TickTimes};
use crate::session::precedence::Precedence;
use crate::session::queue::{Queue, Rings};

/// Interval between two looks at the clearance of the haptic tools, seconds.
const CLEARANCE_S: f64 = 0.016;

/// Loop of the simulation. [`Ticker::step`] neither allocates nor locks.
pub(in crate::session) struct Ticker {
    link: Simulation,
    pub(super) scene: Arc<Scene>,
    pub(super) state: State,
    workspace: Workspace,
    inputs: Inputs,
    chooser: Chooser,
    grid: Grid,
    precedence: Precedence,
    pub(super) queue: Queue,
    /// Commands of the station's side that this tick obeys.
    commands: u64,
    /// Whether each haptic tool is free of contacts, at the last look.
    free: [bool; MAX_TOOLS],
    next_clearance: u64,
    pub(super) metrics: Metrics,
}

impl Ticker {
    /// Ticker before its grid. Allocates all memory of its steps.
    pub fn new(link: Simulation, rings: Rings, metrics: Metrics) -> Self {
        let scene = link.scene.clone();
        Self {
            state: State::new(&scene),
            workspace: Workspace::new(&scene),
            inputs: Inputs::new(scene.tools.len(), scene.params.tick_ns()),
            chooser: Chooser::new(link.detail),
            grid: Grid::new(scene.params.tick_ns()),
            precedence: Precedence::new(scene.params.tick_ns(), link.places.clone()),
            queue: Queue::new(rings, &scene.params),
            commands: 0,
            free: [false; MAX_TOOLS],
            next_clearance: 0,
            scene,
            link,
            metrics,
        }
    }

    /// Begins the grid of the ticks now. `is_real_time`: the calling thread, which is that of the steps, is a
    /// SCHED_FIFO one.
    pub fn begin(&mut self, is_real_time: bool) {
        let tick_ns = self.scene.params.tick_ns();
        let phase_ns = self.link.places.phase_ns(self.link.core, tick_ns);
        let clock = &self.link.clock;
        let (now_ns, unix_ns) = (clock.monotonic_ns(), clock.unix_ns());
        self.grid.begin(now_ns, unix_ns, is_real_time, phase_ns);
    }

    /// Point of the next tick, nanoseconds of the monotonic clock.
    pub fn next_ns(&self) -> u64 {
        self.grid.next_ns()
    }

    /// State after the newest tick.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Measurements of all steps.
    pub fn into_metrics(self) -> Metrics {
        self.metrics
    }

    /// Runs the tick that is due now, sends the wrench, then queues the records. Returns [`Ticker::next_ns`], before
    /// which the next step must not begin.
    pub fn step(&mut self) -> u64 {
        self.step_seen(|_, _, _| ())
    }

    /// The same. `see` gets the input of the tick, its output, and the newest pose that it had.
    pub fn step_seen(&mut self, see: impl FnOnce(&TickInput, &TickOutput, Option<&PoseIn>)) -> u64 {
        let now_ns = self.link.clock.monotonic_ns();
        let (point_ns, skipped) = self.grid.advance(now_ns);

        self.collect();
        self.inputs.detail = self.chooser.level();
        let input = self.inputs.take(now_ns, skipped);
        // The window of the wall time encloses that of the CPU time: CPU time never exceeds wall time.
        let wall = self.link.clock.monotonic_ns();
        let cpu = self.link.clock.thread_cpu_ns();
        let output = tick(
            &self.scene,
            &mut self.state,
            &mut self.workspace,
            &input,
            &mut NoProbe,
        );
        let cpu_end = self.link.clock.thread_cpu_ns();
        let wall_end = self.link.clock.monotonic_ns();

        // The wrench goes first, because the hand waits for it.
        let tools = self.scene.tools.len();
        let (in_force, wait_us) = (self.inputs.in_force, self.inputs.wait_us());
        let newest = self.inputs.newest().map(|pose| (pose, wait_us));
        self.link.wrenches.write(wrench_out(
            &output,
            self.free,
            (self.commands, in_force),
            newest,
            tools,
        ));
        self.link.bell.ring();
        let progress = &self.link.progress;
        progress.tick.store(output.tick, Ordering::Relaxed);
        if progress.commands.load(Ordering::Relaxed) != self.commands {
            progress.since.store(output.tick, Ordering::Relaxed);
            progress.commands.store(self.commands, Ordering::Release);
        }
        let unix_ns = self.grid.unix_ns(now_ns);
        let cpu_ns = cpu_end.saturating_sub(cpu);
        let row = Row::new(unix_ns, &input, &output).with_device(self.inputs.samples(&input));
        let ticked = Ticked {
            row,
            output,
            cpu_ns: u32::try_from(cpu_ns).unwrap_or(u32::MAX),
            in_force,
            gone: self.inputs.gone(),
        };
        self.queue
            .tick(ticked, &self.state, &self.workspace, &mut self.metrics);
        if output.tick >= self.next_clearance {
            self.next_clearance = output.tick + self.scene.params.ticks_in(CLEARANCE_S).max(1);
            self.look_for_clearance(&output);
        }
        self.chooser.took(cpu_ns);

        self.metrics.skipped += u64::from(skipped);
        self.metrics.late += u64::from(self.grid.ended(wall, wall_end));
        let times = TickTimes {
            wake_ns: now_ns.saturating_sub(point_ns),
            cpu_ns,
            wall_ns: wall_end.saturating_sub(wall),
        };
        if self.link.real_time {
            if let Some(priority) = self.precedence.took(cpu_ns, wall_end) {
                // A thread without the right to a priority has none to change.
                let _ = fifo(priority);
            }
            if self.precedence.gives_way(wall_end) {
                self.grid.leave_out();
            }
        }
        self.metrics.tick(times, &output);
        see(&input, &output, self.inputs.newest());
        self.grid.next_ns()
    }

    /// Looks whether each haptic tool is free of contacts. Devices arm only with a free tool.
    fn look_for_clearance(&mut self, output: &TickOutput) {
        for (slot, (free, tool)) in self.free.iter_mut().zip(&output.tools).enumerate() {
            let held = tool.status & status::ABSENT == 0;
            let (scene, state, workspace) = (&self.scene, &self.state, &mut self.workspace);
            *free = held && is_free(scene, state, workspace, slot, &tool.haptic, FREE_DISTANCE);
        }
    }

    fn collect(&mut self) {
        self.link.flags.provoke(Provoked::Simulation);
        // The number before the levels: a command that arrives in between is obeyed, and counted by the next tick.
        self.commands = self.link.levels.commands();
        self.inputs.in_force = self.link.levels.in_force();
        self.inputs.pressed(self.link.pressed.take());
        if self.link.poses.update() {
            self.inputs.pose(*self.link.poses.output_buffer());
        }
    }
}

/// Wrench and graphic pose of a tick for the wire. Numbers are rounded from f64 to f32; the tick has applied the
/// limits. `pose` has its wait for its first tick, microseconds. Without a pose the echoes are invalid. The network
/// sets the hold times when it sends the wrench.
fn wrench_out(
    output: &TickOutput,
    free: [bool; MAX_TOOLS],
    (commands, in_force): (u64, InForce),
    pose: Option<(&PoseIn, u32)>,
    tools: usize,
) -> WrenchOut {
    let mut datagram = WrenchDatagram {
        tick: output.tick,
        levels: in_force.on_the_wire(commands),
        ..WrenchDatagram::default()
    };
    for (k, tool) in output.tools.iter().enumerate().take(tools) {
        let (force, torque) = (&tool.wrench.force, &tool.wrench.torque);
        let (p, q) = (&tool.graphic.position, &tool.graphic.orientation);
        let reading = pose.map(|(pose, wait_us)| (&pose.datagram.tools[k], wait_us));
        let reading = reading.filter(|(tool, _)| tool.present);
        let echo = reading.map(|(tool, wait_us)| Echo {
            valid: true,
            sequence: tool.sequence,
            device_time_ns: tool.device_time_ns,
            hold_us: 0,
            wait_us,
        });
        datagram.tools[k] = ToolWrench {
            wrench: WireWrench {
                force: [force.x as f32, force.y as f32, force.z as f32],
                torque: [torque.x as f32, torque.y as f32, torque.z as f32],
            },
            graphic: WirePose {
                position: [p.x as f32, p.y as f32, p.z as f32],
                orientation: [q.w as f32, q.i as f32, q.j as f32, q.k as f32],
            },
            status: tool.status | if free[k] { FREE } else { 0 },
            echo: echo.unwrap_or_default(),
        };
    }
    WrenchOut {
        datagram,
        pose_arrived_ns: pose.map_or(0, |(pose, _)| pose.arrived_ns),
    }
}
