//! The simulation thread: one tick per millisecond on absolute deadlines. What is missed is skipped,
//! counted and recorded as input, never caught up.

use std::sync::Arc;
use std::thread::JoinHandle;

use rtrb::{Consumer, Producer, PushError};
use sulcus_core::{NoProbe, Scene, State, TickOutput, Workspace, tick};
use sulcus_proto::datagram::{Echo, ToolWrench, WirePose, WireWrench};
use sulcus_proto::{WrenchDatagram, limits};
use sulcus_sessions::Row;
use triple_buffer::{Input, Output};

use crate::handoff::{Bell, Edge, Flags, PoseIn, SNAPSHOT_TICKS, WrenchOut};
use crate::inputs::Inputs;
use crate::metrics::{Metrics, TickTimes};
use crate::realtime::{self, monotonic_ns, thread_cpu_ns};
use crate::recording::Entry;

const TICK_NS: u64 = limits::TICK_NS;

/// Everything that the simulation thread owns.
pub(crate) struct Simulation {
    pub scene: Arc<Scene>,
    pub poses: Output<Option<PoseIn>>,
    pub edges: Consumer<Edge>,
    pub wrenches: Input<WrenchOut>,
    pub bell: Bell,
    pub flags: Arc<Flags>,
    /// To the recorder.
    pub entries: Producer<Entry>,
    /// Snapshot buffers that the recorder has written and gives back.
    pub buffers: Consumer<Vec<u8>>,
    pub real_time: bool,
}

/// Says that the thread is leaving, even when it panics.
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
        // Sized here: the thread allocates nothing once it ticks.
        let metrics = Metrics::new()?;
        std::thread::Builder::new().name("sulcus-sim".into()).spawn(move || self.run(metrics))
    }

    fn run(mut self, mut metrics: Metrics) -> Metrics {
        let _leaving = Leaving(self.flags.clone(), self.bell.clone());
        let scene = self.scene.clone();
        let mut state = State::new(&scene);
        let mut workspace = Workspace::new(&scene);
        let mut inputs = Inputs::new(scene.tools.len());
        if self.real_time {
            realtime::enter();
        } else {
            realtime::exact_timers();
        }
        let begin_ns = monotonic_ns();
        let unix_at_begin = realtime::unix_ns();
        let mut grid_ns = begin_ns + TICK_NS;
        let mut next_snapshot = SNAPSHOT_TICKS;

        while !Flags::is_up(&self.flags.stop) {
            realtime::sleep_until(grid_ns);
            let now_ns = monotonic_ns();
            let skipped = grid_points_missed(grid_ns, now_ns);
            grid_ns += u64::from(skipped) * TICK_NS;

            self.collect(&mut inputs);
            let input = inputs.take(now_ns, skipped);
            let (cpu, wall) = (thread_cpu_ns(), monotonic_ns());
            let output = tick(&scene, &mut state, &mut workspace, &input, &mut NoProbe);
            let (cpu_end, wall_end) = (thread_cpu_ns(), monotonic_ns());

            // The hand first, the record after.
            self.wrenches.write(wrench_out(&output, inputs.newest(), scene.tools.len()));
            self.bell.ring();
            let unix_ns = unix_at_begin + (now_ns - begin_ns);
            self.record(Row::new(unix_ns, &input, &output), &mut metrics);
            if output.tick >= next_snapshot {
                next_snapshot = output.tick + SNAPSHOT_TICKS;
                self.snapshot(unix_ns, &state, &mut metrics);
            }

            metrics.skipped += u64::from(skipped);
            metrics.late += u64::from(wall_end > grid_ns + TICK_NS);
            let times = TickTimes {
                wake_ns: now_ns.saturating_sub(grid_ns),
                cpu_ns: cpu_end.saturating_sub(cpu),
                wall_ns: wall_end.saturating_sub(wall),
            };
            metrics.tick(times, &output);
            grid_ns += TICK_NS;
        }
        metrics
    }

    fn collect(&mut self, inputs: &mut Inputs) {
        while let Ok(edge) = self.edges.pop() {
            inputs.edge(edge);
        }
        if self.poses.update()
            && let Some(pose) = self.poses.output_buffer()
        {
            inputs.pose(*pose);
        }
    }

    fn record(&mut self, row: Row, metrics: &mut Metrics) {
        if self.entries.push(Entry::Row(row)).is_err() {
            metrics.rows_dropped += 1;
        }
    }

    fn snapshot(&mut self, unix_ns: u64, state: &State, metrics: &mut Metrics) {
        let Ok(mut bytes) = self.buffers.pop() else {
            metrics.snapshots_dropped += 1;
            return;
        };
        bytes.clear();
        state.write_bytes(&mut bytes);
        if let Err(PushError::Full(entry)) = self.entries.push(Entry::Snapshot { unix_ns, bytes }) {
            metrics.snapshots_dropped += 1;
            // Freeing is as bad as allocating here: the buffer is lost to the pool, not to the heap.
            std::mem::forget(entry);
        }
    }
}

/// Grid points after `grid_ns` that had passed by `now_ns`. More than a tick's input can say stay for
/// the next one.
fn grid_points_missed(grid_ns: u64, now_ns: u64) -> u16 {
    u16::try_from(now_ns.saturating_sub(grid_ns) / TICK_NS).unwrap_or(u16::MAX)
}

/// What a tick says, for the wire. f64 to f32 rounds to nearest; limits were applied in the tick.
fn wrench_out(output: &TickOutput, pose: Option<&PoseIn>, tools: usize) -> WrenchOut {
    let mut datagram = WrenchDatagram { tick: output.tick, ..WrenchDatagram::default() };
    for (slot, tool) in datagram.tools.iter_mut().zip(&output.tools).take(tools) {
        let (force, torque) = (&tool.wrench.force, &tool.wrench.torque);
        let (p, q) = (&tool.graphic.position, &tool.graphic.orientation);
        *slot = ToolWrench {
            wrench: WireWrench {
                force: [force.x as f32, force.y as f32, force.z as f32],
                torque: [torque.x as f32, torque.y as f32, torque.z as f32],
            },
            graphic: WirePose {
                position: [p.x as f32, p.y as f32, p.z as f32],
                orientation: [q.w as f32, q.i as f32, q.j as f32, q.k as f32],
            },
            status: tool.status,
            ..ToolWrench::default()
        };
    }
    let Some(pose) = pose else { return WrenchOut { datagram, pose_arrived_ns: 0 } };
    datagram.echo = Echo {
        valid: true,
        sequence: pose.datagram.sequence,
        device_time_ns: pose.datagram.device_time_ns,
        // Filled in when it is sent.
        hold_us: 0,
    };
    WrenchOut { datagram, pose_arrived_ns: pose.arrived_ns }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missed_grid_point_is_skipped_not_caught_up() {
        let grid = 50 * TICK_NS;
        let missed = |now| grid_points_missed(grid, now);
        assert_eq!(missed(grid - 1), 0);
        assert_eq!(missed(grid + TICK_NS - 1), 0);
        assert_eq!(missed(grid + TICK_NS), 1);
        assert_eq!(missed(grid + 7 * TICK_NS + 3), 7);
        assert_eq!(missed(grid + 1_000_000 * TICK_NS), u16::MAX);
    }

    #[test]
    fn status_bits_are_the_same_in_core_and_on_the_wire() {
        use sulcus_core::output::status as core;
        use sulcus_proto::status as wire;
        let pairs = [
            (core::ABSENT, wire::ABSENT),
            (core::STALE, wire::STALE),
            (core::PAUSED, wire::PAUSED),
            (core::SATURATED, wire::SATURATED),
            (core::SLEW_LIMITED, wire::SLEW_LIMITED),
            (core::EXHAUSTED, wire::EXHAUSTED),
            (core::SOLVER_FAILED, wire::SOLVER_FAILED),
            (core::BAD_INPUT, wire::BAD_INPUT),
            (core::SPEED_CLAMPED, wire::SPEED_CLAMPED),
            (core::CONTACTS_FULL, wire::CONTACTS_FULL),
            (core::TWIST_SATURATED, wire::TWIST_SATURATED),
            (core::RAMPING, wire::RAMPING),
            (core::FAULT, wire::FAULT),
        ];
        assert!(pairs.iter().all(|(core, wire)| core == wire));
    }
}
