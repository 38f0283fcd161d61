//! The simulation thread: ticks at the scene's rate on absolute deadlines. A missed grid point is skipped, counted and
//! recorded as input. The thread never runs two ticks to catch up.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::thread::JoinHandle;

use rtrb::{Consumer, Producer, PushError};
use sulcus_core::clearance::{FREE_DISTANCE, is_free};
use sulcus_core::output::status;
use sulcus_core::{MAX_TOOLS, NoProbe, Scene, State, TickInput, TickOutput, Vec3, Workspace, tick};
use sulcus_link::Bell;
use sulcus_proto::WrenchDatagram;
use sulcus_proto::datagram::{Echo, ToolWrench, WireLevels, WirePose, WireWrench};
use sulcus_proto::status::FREE;
use sulcus_sessions::exercise::events::Look;
use sulcus_sessions::record::recorder::SNAPSHOT_EVERY_S;
use sulcus_sessions::{Row, Sampler, Shapes};
use triple_buffer::{Input, Output};

use crate::capacity::pin_to;
use crate::outlets::recording::{Entry, Ticked};
use crate::session::detail::{Chooser, Detail};
use crate::session::grid::Grid;
use crate::session::handoff::{Flags, PoseIn, Pressed, Progress, Provoked, WrenchOut};
use crate::session::inputs::Inputs;
use crate::session::levels::{InForce, Levels};
use crate::session::metrics::{Metrics, TickTimes};
use crate::session::precedence::{Places, Precedence};
use crate::session::realtime;
use sulcus_link::clock::{monotonic_ns, sleep_until, thread_cpu_ns, unix_ns};
use sulcus_link::schedule::fifo;

/// Interval between two looks at the clearance of the haptic tools, seconds.
const CLEARANCE_S: f64 = 0.016;

/// Data that the simulation thread owns.
pub(crate) struct Simulation {
    pub scene: Arc<Scene>,
    pub poses: Output<Option<PoseIn>>,
    /// Pause and force limit of both sides.
    pub levels: Levels,
    /// Buttons pressed since the last tick.
    pub pressed: Arc<Pressed>,
    pub wrenches: Input<WrenchOut>,
    pub bell: Bell,
    pub flags: Arc<Flags>,
    pub progress: Arc<Progress>,
    /// Queue to the recorder.
    pub entries: Producer<Entry>,
    /// Free buffers for snapshots, returned by the recorder.
    pub buffers: Consumer<Vec<u8>>,
    /// Reader of the shapes for the events of the exercise.
    pub look: Look,
    /// Free buffers for looks, returned by the recorder.
    pub looks: Consumer<Vec<Vec3>>,
    /// Reader of the shapes for viewers.
    pub sampler: Sampler,
    /// Free buffers for shapes, returned by the recorder.
    pub shapes: Consumer<Box<Shapes>>,
    /// Level of detail of tissue.
    pub detail: Detail,
    /// Whether to request real-time scheduling and locked memory.
    pub real_time: bool,
    /// Places behind the other stations of the server.
    pub places: Arc<Places>,
    /// Core on which the thread runs; `None`: any.
    pub core: Option<usize>,
}

/// Reports the end of the thread to the network, even after a panic.
struct Leaving(Arc<Flags>, Bell);

impl Drop for Leaving {
    fn drop(&mut self) {
        Flags::raise(&self.0.simulation_over);
        self.1.ring();
    }
}

impl Simulation {
    /// Starts the thread; it ends when [`Flags::stop`] is raised.
    pub fn spawn(self) -> std::io::Result<JoinHandle<Metrics>> {
        // Allocated here: the thread allocates nothing after its first tick.
        let metrics = Metrics::new();
        std::thread::Builder::new()
            .name("sulcus-sim".into())
            .spawn(move || self.run(metrics))
    }

    fn run(self, metrics: Metrics) -> Metrics {
        let _leaving = Leaving(self.flags.clone(), self.bell.clone());
        let (flags, real_time) = (self.flags.clone(), self.real_time);
        let core = self.core;
        let mut ticker = Ticker::new(self, metrics);
        if let Some(core) = core
            && let Err(error) = pin_to(core)
        {
            tracing::warn!("simulation is not bound to core {core}: {error}");
        }
        // After all allocations, so that their memory is locked. The grid begins afterwards.
        let is_real_time = real_time && realtime::enter();
        sulcus_link::schedule::exact_timers();
        ticker.grid.begin(monotonic_ns(), unix_ns(), is_real_time);
        while !Flags::is_up(&flags.stop) {
            ticker.step();
        }
        ticker.metrics
    }
}

/// Loop of the simulation thread. [`Ticker::step`] neither allocates nor locks.
struct Ticker {
    link: Simulation,
    scene: Arc<Scene>,
    state: State,
    workspace: Workspace,
    inputs: Inputs,
    chooser: Chooser,
    grid: Grid,
    precedence: Precedence,
    next_snapshot: u64,
    /// Commands of the station's side that this tick obeys.
    commands: u64,
    /// Whether each haptic tool is free of contacts, at the last look.
    free: [bool; MAX_TOOLS],
    next_clearance: u64,
    metrics: Metrics,
}

impl Ticker {
    fn new(link: Simulation, metrics: Metrics) -> Self {
        let scene = link.scene.clone();
        Self {
            state: State::new(&scene),
            workspace: Workspace::new(&scene),
            inputs: Inputs::new(scene.tools.len(), scene.params.tick_ns()),
            chooser: Chooser::new(link.detail),
            grid: Grid::new(scene.params.tick_ns()),
            precedence: Precedence::new(scene.params.tick_ns(), link.places.clone()),
            next_snapshot: scene.params.ticks_in(SNAPSHOT_EVERY_S),
            commands: 0,
            free: [false; MAX_TOOLS],
            next_clearance: 0,
            scene,
            link,
            metrics,
        }
    }

    /// Sleeps to the next grid point, runs its tick, sends the wrench, then queues the records.
    fn step(&mut self) {
        sleep_until(self.grid.next_ns());
        let now_ns = monotonic_ns();
        let (point_ns, skipped) = self.grid.advance(now_ns);

        self.collect();
        self.inputs.detail = self.chooser.level();
        let input = self.inputs.take(now_ns, skipped);
        // The window of the wall time encloses that of the CPU time: CPU time never exceeds wall time.
        let wall = monotonic_ns();
        let cpu = thread_cpu_ns();
        let output = tick(
            &self.scene,
            &mut self.state,
            &mut self.workspace,
            &input,
            &mut NoProbe,
        );
        let cpu_end = thread_cpu_ns();
        let wall_end = monotonic_ns();

        // The wrench goes first, because the hand waits for it.
        let tools = self.scene.tools.len();
        let (in_force, newest) = (self.inputs.in_force, self.inputs.newest());
        self.link
            .wrenches
            .write(wrench_out(&output, self.free, in_force, newest, tools));
        self.link.bell.ring();
        let progress = &self.link.progress;
        progress.tick.store(output.tick, Ordering::Relaxed);
        if progress.commands.load(Ordering::Relaxed) != self.commands {
            progress.since.store(output.tick, Ordering::Relaxed);
            progress.commands.store(self.commands, Ordering::Release);
        }
        let unix_ns = self.grid.unix_ns(now_ns);
        let cpu_ns = cpu_end.saturating_sub(cpu);
        self.record(unix_ns, &input, &output, cpu_ns);
        if output.tick >= self.next_snapshot {
            self.next_snapshot = output.tick + self.scene.params.ticks_in(SNAPSHOT_EVERY_S);
            self.snapshot(unix_ns);
        }
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

    /// Queues the tick for the recorder, and before it the shapes that its events and viewers need. A full queue drops
    /// the entry; only dropped rows are counted.
    fn record(&mut self, unix_ns: u64, input: &TickInput, output: &TickOutput, cpu_ns: u64) {
        if self.link.look.is_due(output.tick)
            && let Ok(mut centres) = self.link.looks.pop()
        {
            self.link.look.read(&self.workspace, &mut centres);
            if let Err(PushError::Full(entry)) =
                self.link.entries.push(Entry::Look(output.tick, centres))
            {
                // No free on this thread; see `snapshot`.
                std::mem::forget(entry);
            }
        }
        if self.link.sampler.is_due(output.tick)
            && let Ok(mut shapes) = self.link.shapes.pop()
        {
            let sampler = &self.link.sampler;
            sampler.read(output.tick, &self.workspace, &mut shapes);
            if let Err(PushError::Full(entry)) = self.link.entries.push(Entry::Shapes(shapes)) {
                std::mem::forget(entry);
            }
        }
        let row = Row::new(unix_ns, input, output).with_device(self.inputs.samples(input));
        let cpu_ns = u32::try_from(cpu_ns).unwrap_or(u32::MAX);
        let entry = Entry::Tick(Ticked {
            row,
            output: *output,
            cpu_ns,
            in_force: self.inputs.in_force,
            gone: self.inputs.gone(),
        });
        if self.link.entries.push(entry).is_err() {
            self.metrics.rows_dropped += 1;
        }
    }

    fn snapshot(&mut self, unix_ns: u64) {
        let Ok(mut bytes) = self.link.buffers.pop() else {
            self.metrics.snapshots_dropped += 1;
            return;
        };
        bytes.clear();
        self.state.write_bytes(&mut bytes);
        let entry = Entry::Snapshot {
            unix_ns,
            tick: self.state.tick,
            bytes,
        };
        if let Err(PushError::Full(entry)) = self.link.entries.push(entry) {
            self.metrics.snapshots_dropped += 1;
            // A free could lock, like an allocation. The buffer is leaked instead.
            std::mem::forget(entry);
        }
    }
}

/// Wrench and graphic pose of a tick for the wire. Numbers are rounded from f64 to f32; the tick has applied the
/// limits. Without a pose the echoes are invalid. The network sets the hold times when it sends the wrench.
fn wrench_out(
    output: &TickOutput,
    free: [bool; MAX_TOOLS],
    in_force: InForce,
    pose: Option<&PoseIn>,
    tools: usize,
) -> WrenchOut {
    let mut datagram = WrenchDatagram {
        tick: output.tick,
        levels: WireLevels {
            paused_by_station: in_force.station.paused,
            paused_by_student: in_force.student.paused,
            force_limit_n: in_force.force_limit_n(),
        },
        ..WrenchDatagram::default()
    };
    for (k, tool) in output.tools.iter().enumerate().take(tools) {
        let (force, torque) = (&tool.wrench.force, &tool.wrench.torque);
        let (p, q) = (&tool.graphic.position, &tool.graphic.orientation);
        let reading = pose.map(|pose| &pose.datagram.tools[k]);
        let echo = reading.filter(|tool| tool.present).map(|tool| Echo {
            valid: true,
            sequence: tool.sequence,
            device_time_ns: tool.device_time_ns,
            hold_us: 0,
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
        pose_arrived_ns: pose.map_or(0, |pose| pose.arrived_ns),
    }
}

#[cfg(test)]
mod tests;
