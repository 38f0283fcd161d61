//! What the simulation thread measures of itself. Everything is sized before the first tick.

use hdrhistogram::Histogram;
use sulcus_core::math::norm;
use sulcus_core::output::status;
use sulcus_core::{MAX_TOOLS, TickOutput};
use sulcus_proto::{Percentiles, SessionSummary};

/// Longest time told apart, nanoseconds; longer ones count as this.
const LONGEST_NS: u64 = 1_000_000_000;

/// Times and findings of all ticks so far.
pub(crate) struct Metrics {
    cpu_ns: Histogram<u64>,
    wall_ns: Histogram<u64>,
    wake_ns: Histogram<u64>,
    pub ticks: u64,
    pub skipped: u64,
    pub late: u64,
    pub rows_dropped: u64,
    pub snapshots_dropped: u64,
    residual_m: f64,
    exhausted: u64,
    /// From (re)entry to the first converged tick the graphic tool travels to the hand: substeps that
    /// run out then are no finding.
    arriving: [bool; MAX_TOOLS],
    stale: u64,
    force_n: f64,
}

/// Times of one tick, nanoseconds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TickTimes {
    /// From its grid point to its begin.
    pub wake_ns: u64,
    /// Thread CPU time.
    pub cpu_ns: u64,
    /// Wall time.
    pub wall_ns: u64,
}

impl Metrics {
    pub fn new() -> std::io::Result<Self> {
        Ok(Self {
            cpu_ns: histogram()?,
            wall_ns: histogram()?,
            wake_ns: histogram()?,
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
        })
    }

    /// Takes in one tick; allocates nothing.
    pub fn tick(&mut self, times: TickTimes, output: &TickOutput) {
        self.ticks += 1;
        self.cpu_ns.saturating_record(times.cpu_ns);
        self.wall_ns.saturating_record(times.wall_ns);
        self.wake_ns.saturating_record(times.wake_ns);
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

    /// Writes what was measured into a summary.
    pub fn fill(&self, summary: &mut SessionSummary) {
        summary.ticks = self.ticks;
        summary.skipped = self.skipped;
        summary.deadline_misses = self.late + self.skipped;
        summary.tick_us = percentiles(&self.cpu_ns);
        summary.tick_wall_us = percentiles(&self.wall_ns);
        summary.wake_us = percentiles(&self.wake_ns);
        summary.max_residual_um = self.residual_m * 1e6;
        summary.exhausted = self.exhausted;
        summary.stale = self.stale;
        summary.max_force_n = self.force_n;
        summary.rows_dropped = self.rows_dropped;
        summary.snapshots_dropped = self.snapshots_dropped;
    }
}

/// Three significant digits from 1 ns to 1 s, all buckets there from the start.
fn histogram() -> std::io::Result<Histogram<u64>> {
    Histogram::new_with_bounds(1, LONGEST_NS, 3).map_err(std::io::Error::other)
}

fn percentiles(times_ns: &Histogram<u64>) -> Percentiles {
    let us = |ns: u64| ns as f64 / 1e3;
    Percentiles {
        p50: us(times_ns.value_at_quantile(0.5)),
        p99: us(times_ns.value_at_quantile(0.99)),
        p999: us(times_ns.value_at_quantile(0.999)),
        max: us(times_ns.max()),
    }
}

#[cfg(test)]
mod tests {
    use sulcus_core::Pose;
    use sulcus_core::output::ToolOutput;

    use super::*;

    #[test]
    fn exhaustion_counts_from_arrival() {
        let mut metrics = Metrics::new().expect("histograms");
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

    #[test]
    fn percentiles_are_microseconds() {
        let mut times = histogram().expect("bounds");
        for us in 1..=1000 {
            times.saturating_record(us * 1000);
        }
        times.saturating_record(u64::MAX);
        let p = percentiles(&times);
        assert!((p.p50 - 501.0).abs() < 2.0, "{p:?}");
        assert!((p.p99 - 991.0).abs() < 2.0, "{p:?}");
        assert!((p.max - 1e6).abs() < 1e3, "{p:?}");
    }
}
