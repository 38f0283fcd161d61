//! Measurements of the simulation thread. All memory is allocated before the first tick.

use sulcus_core::math::norm;
use sulcus_core::output::status;
use sulcus_core::{MAX_TOOLS, TickOutput};
use sulcus_link::Times;
use sulcus_proto::SessionSummary;

/// Longest time that a histogram resolves, seconds. A longer time counts as this one.
const LONGEST_S: u32 = 1;

/// Times and counters of all ticks so far.
pub(crate) struct Metrics {
    cpu_ns: Times,
    wall_ns: Times,
    wake_ns: Times,
    /// Number of ticks computed.
    pub ticks: u64,
    /// Number of grid points skipped.
    pub skipped: u64,
    /// Number of ticks that ended after the next grid point.
    pub late: u64,
    /// Number of rows that found the recorder's queue full.
    pub rows_dropped: u64,
    /// Number of snapshots without a free buffer or slot.
    pub snapshots_dropped: u64,
    /// Deepest penetration of a converged tick, metres.
    residual_m: f64,
    /// Number of tool-ticks whose substeps ran out, arrivals excluded.
    exhausted: u64,
    /// Whether the tool travels to the hand: from its appearance to the first converged tick. Exhausted substeps are
    /// normal in that time.
    arriving: [bool; MAX_TOOLS],
    /// Number of tool-ticks with a stale pose.
    stale: u64,
    /// Largest force sent to the hand, newtons.
    force_n: f64,
}

/// Times of one tick, nanoseconds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TickTimes {
    /// Time from the grid point to the begin of the tick.
    pub wake_ns: u64,
    /// CPU time of the thread in the tick.
    pub cpu_ns: u64,
    /// Wall time of the tick.
    pub wall_ns: u64,
}

impl Metrics {
    pub fn new() -> Self {
        Self {
            cpu_ns: Times::up_to(LONGEST_S),
            wall_ns: Times::up_to(LONGEST_S),
            wake_ns: Times::up_to(LONGEST_S),
            ticks: 0,
            skipped: 0,
            late: 0,
            rows_dropped: 0,
            snapshots_dropped: 0,
            residual_m: 0.0,
            exhausted: 0,
            arriving: [true; MAX_TOOLS],
            stale: 0,
            force_n: 0.0,
        }
    }

    /// Takes the times and the output of one tick. No allocation.
    pub fn tick(&mut self, times: TickTimes, output: &TickOutput) {
        self.ticks += 1;
        self.cpu_ns.record(times.cpu_ns);
        self.wall_ns.record(times.wall_ns);
        self.wake_ns.record(times.wake_ns);
        for (tool, arriving) in output.tools.iter().zip(&mut self.arriving) {
            let force = norm(&tool.wrench.force);
            if force > self.force_n {
                self.force_n = force;
            }
            if tool.status & status::ABSENT != 0 {
                *arriving = true;
                continue;
            }
            *arriving &= !tool.converged;
            if tool.converged && -tool.min_gap > self.residual_m {
                self.residual_m = -tool.min_gap;
            }
            self.exhausted += u64::from(!*arriving && tool.status & status::EXHAUSTED != 0);
            self.stale += u64::from(tool.status & status::STALE != 0);
        }
    }

    /// Writes the measurements into a summary.
    pub fn fill(&self, summary: &mut SessionSummary) {
        summary.ticks = self.ticks;
        summary.skipped = self.skipped;
        summary.deadline_misses = self.late + self.skipped;
        summary.tick_us = self.cpu_ns.percentiles();
        summary.tick_wall_us = self.wall_ns.percentiles();
        summary.wake_us = self.wake_ns.percentiles();
        summary.max_residual_um = self.residual_m * 1e6;
        summary.exhausted = self.exhausted;
        summary.stale = self.stale;
        summary.max_force_n = self.force_n;
        summary.rows_dropped = self.rows_dropped;
        summary.snapshots_dropped = self.snapshots_dropped;
    }
}

#[cfg(test)]
mod tests {
    use sulcus_core::Pose;
    use sulcus_core::output::ToolOutput;

    use super::*;

    #[test]
    fn exhaustion_counts_from_arrival() {
        let mut metrics = Metrics::new();
        let times = TickTimes {
            wake_ns: 0,
            cpu_ns: 1,
            wall_ns: 1,
        };
        let mut tick = |bits, converged| {
            let tool = |status, converged| ToolOutput {
                status,
                converged,
                ..ToolOutput::absent(Pose::identity())
            };
            let output = TickOutput {
                tick: 0,
                hash: 0,
                tools: [tool(bits, converged), tool(status::ABSENT, true)],
                work: 0,
            };
            metrics.tick(times, &output);
            metrics.exhausted
        };
        // Arrival, twice: at the start and after an absence.
        for before in [0, 1] {
            assert_eq!(tick(status::EXHAUSTED, false), before);
            assert_eq!(tick(status::EXHAUSTED, false), before);
            assert_eq!(tick(0, true), before);
            assert_eq!(tick(status::EXHAUSTED, false), before + 1);
            assert_eq!(tick(status::ABSENT, true), before + 1);
        }
    }
}
