//! The plots of the page: speed against error, how times grow, stability with one degree of freedom, the paper's figures.

use super::Svg;
use crate::page::plot::{Plot, Series};
use crate::report::{self, Curve, Level, Line, Report, SHARES, TickUs};

/// The whole mouth, level by level.
pub(super) struct Speed {
    /// Error of a tooth against the time of a tick.
    pub(super) error: Svg,
    /// Share of ticks against the time that they exceed.
    pub(super) slow: Svg,
}

impl Speed {
    pub(super) fn of(report: &Report) -> Self {
        let levels = &report.mouth.levels;
        let against = |name: &str, of: fn(&Level) -> (f64, f64)| {
            Series::joined(name, levels.iter().map(of).collect())
        };
        let error = Plot {
            x: "time of a tick at p99.9, us".into(),
            y: "touched tooth off drawn tooth, um".into(),
            log: (true, true),
            series: vec![
                against("mean error", |l| {
                    (l.times.tick_us.p999, l.tooth_error_mean_um)
                }),
                against("largest error", |l| {
                    (l.times.tick_us.p999, l.tooth_error_max_um)
                }),
            ],
            limit: None,
        };
        let tail = |level: &Level| {
            let shares = SHARES.iter().map(|share| 100.0 * share);
            let points = level.longer_than_us.iter().copied().zip(shares);
            Series::joined(format!("level {}", level.level), points.collect())
        };
        let slow = Plot {
            x: "time of a tick, us".into(),
            y: "share of ticks that take longer, %".into(),
            log: (true, true),
            series: levels.iter().map(tail).collect(),
            limit: Some((0.1, "one tick of a thousand".into())),
        };
        Self {
            error: error.svg(),
            slow: slow.svg(),
        }
    }
}

/// Time of a tick along one axis of growth.
pub(super) struct Growth<'a> {
    pub(super) line: &'a Line,
    pub(super) plot: Svg,
}

impl<'a> Growth<'a> {
    pub(super) fn of(line: &'a Line) -> Self {
        let of = |value: fn(&TickUs) -> f64| {
            let points = line.points.iter();
            points.map(|p| (p.x, value(&p.times.tick_us))).collect()
        };
        let ends = |of: fn(f64, f64) -> f64, from| line.points.iter().map(|p| p.x).fold(from, of);
        let wide = ends(f64::min, f64::INFINITY) > 0.0 && ends(f64::max, 0.0) > 100.0;
        let plot = Plot {
            x: line.with.split(':').next().unwrap_or(line.with).into(),
            y: "time of a tick, us".into(),
            log: (wide, false),
            series: vec![
                Series::joined("p50", of(|t| t.p50)),
                Series::joined("p99.9", of(|t| t.p999)),
            ],
            limit: None,
        };
        Self {
            line,
            plot: plot.svg(),
        }
    }
}

/// The benchmark with one degree of freedom.
pub(super) struct OneDof {
    /// Largest stable step against the stiffness of the spring.
    pub(super) step: Svg,
    /// Ratio of the forces on tissue and hand.
    pub(super) load: Svg,
}

impl OneDof {
    pub(super) fn of(rows: &[report::OneDof]) -> Self {
        let of = |value: fn(&report::OneDof) -> f64| {
            let points = rows.iter();
            points.map(|row| (row.spring_n_per_m, value(row))).collect()
        };
        let step = Plot {
            x: "spring, N/m".into(),
            y: "largest stable time step, ms".into(),
            log: (true, true),
            series: vec![
                Series::joined("as printed, by Eq. 9", of(|row| row.limit_ms)),
                Series {
                    name: "as printed, found by running it".into(),
                    points: of(|row| row.limit_run_ms),
                    joined: false,
                },
            ],
            limit: Some((1.0, "the tick: below it explicit Euler explodes".into())),
        };
        let load = Plot {
            x: "spring, N/m".into(),
            y: "force on tissue / force on hand".into(),
            log: (true, false),
            series: vec![
                Series::joined("as printed", of(|row| row.load_ratio[0])),
                Series::joined("coupled", of(|row| row.load_ratio[2])),
            ],
            limit: Some((1.0, "action equals reaction".into())),
        };
        Self {
            step: step.svg(),
            load: load.svg(),
        }
    }
}

/// A figure of the paper with the curves measured here.
pub(super) struct PaperFigure<'a> {
    pub(super) curve: &'a Curve,
    pub(super) plot: Svg,
}

impl<'a> PaperFigure<'a> {
    pub(super) fn of(curve: &'a Curve) -> Self {
        let series = curve.series.iter();
        let plot = Plot {
            x: curve.x.into(),
            y: curve.y.into(),
            log: (false, false),
            series: series
                .map(|(name, points)| Series::joined(name, points.clone()))
                .collect(),
            limit: None,
        };
        Self {
            curve,
            plot: plot.svg(),
        }
    }
}
