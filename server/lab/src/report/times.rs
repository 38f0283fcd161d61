//! Times of ticks, with how sure they are.

use serde::Serialize;
use sulcus_cases::statistics::{Interval, Percentiles, percentiles_us};
use sulcus_cases::timing::{time, time_stages};
use sulcus_core::{Scene, Stage, TickInput};

/// Percentiles of the time of a tick, microseconds.
pub(crate) type TickUs = Percentiles;

/// What the ticks of some recorded inputs take.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct Times {
    /// CPU time of the thread: each percentile the mean over the runs.
    pub(crate) tick_us: TickUs,
    /// Half the width of the 95 % confidence interval of each over the runs; none for a single run.
    pub(crate) tick_us_ci95: Option<TickUs>,
    /// On the wall, of the run that was least disturbed.
    pub(crate) tick_wall_us: TickUs,
    /// Share of ticks that took longer than a millisecond on the wall, over all runs, percent.
    pub(crate) over_1_ms_percent: f64,
    /// Median and 99.9th percentile by stage, in the order of [`Stage::ALL`]; each with the clock's own 0.2 us or so. Empty where
    /// nobody asked ([`Times::with_stages`]): it takes a run of its own.
    pub(crate) stages_us: Vec<(String, f64, f64)>,
    pub(crate) runs: usize,
    /// Ticks that were measured in each run.
    pub(crate) ticks: usize,
}

impl Times {
    /// Times `scene` under `inputs`, `runs` times over; what counts are the ticks that `counts` wants.
    pub(crate) fn of(
        scene: &Scene,
        inputs: &[TickInput],
        runs: usize,
        counts: impl Fn(usize) -> bool,
    ) -> Self {
        let kept = |times: &[u64]| kept(times, &counts);
        let mut cpu: Vec<TickUs> = Vec::new();
        let (mut wall, mut over, mut ticks) = (Vec::new(), 0, 0);
        for _ in 0..runs {
            let run = time(scene, inputs, |_, _| {});
            let walls = kept(&run.wall);
            ticks = walls.len();
            over += walls.iter().filter(|ns| **ns > 1_000_000).count();
            cpu.push(percentiles_us(kept(&run.cpu)));
            wall.push(percentiles_us(walls));
        }
        let best = wall.iter().copied();
        Self {
            tick_us: over_runs(&cpu, |runs| Interval::of(runs).mean),
            tick_us_ci95: (runs > 1).then(|| over_runs(&cpu, |runs| Interval::of(runs).half)),
            tick_wall_us: best
                .min_by(|a, b| a.p999.total_cmp(&b.p999))
                .unwrap_or_default(),
            over_1_ms_percent: 100.0 * over as f64 / (runs * ticks).max(1) as f64,
            stages_us: Vec::new(),
            runs,
            ticks,
        }
    }

    /// With the times of the stages, from one more run of the same.
    pub(crate) fn with_stages(
        self,
        scene: &Scene,
        inputs: &[TickInput],
        counts: impl Fn(usize) -> bool,
    ) -> Self {
        let stages = Stage::ALL.iter().zip(time_stages(scene, inputs));
        let stages_us = stages
            .map(|(stage, times)| {
                let at = percentiles_us(kept(&times, &counts));
                (format!("{stage:?}").to_lowercase(), at.p50, at.p999)
            })
            .collect();
        Self { stages_us, ..self }
    }

    /// Highest rate that 99.9 % of the ticks keep, hertz.
    pub(crate) fn rate_hz(&self) -> f64 {
        1e6 / self.tick_us.p999.max(1e-3)
    }
}

/// Those of the ticks' times that `counts` wants.
fn kept(times: &[u64], counts: impl Fn(usize) -> bool) -> Vec<u64> {
    let all = times.iter().enumerate();
    all.filter_map(|(k, time)| counts(k).then_some(*time))
        .collect()
}

fn over_runs(runs: &[TickUs], of: fn(&[f64]) -> f64) -> TickUs {
    let each = |value: fn(&TickUs) -> f64| of(&runs.iter().map(value).collect::<Vec<_>>());
    TickUs {
        p50: each(|run| run.p50),
        p99: each(|run| run.p99),
        p999: each(|run| run.p999),
        max: each(|run| run.max),
    }
}
