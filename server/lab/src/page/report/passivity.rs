//! Passivity over a link, and the hour at rest.

use super::Svg;
use crate::page::plot::{Plot, Series};
use crate::report::{FELT_MJ, Hour, Loop, Loops};

/// Energy of zero on a logarithmic axis, millijoules.
const NOTHING_MJ: f64 = 1e-4;

/// The loops over links.
pub(super) struct Passivity<'a> {
    /// Energy of the worst case at each delay.
    pub(super) worst: Svg,
    /// All loops, most energy first.
    pub(super) by_energy: Vec<&'a Loop>,
}

impl<'a> Passivity<'a> {
    pub(super) fn of(found: &'a Loops) -> Self {
        let mut by_energy: Vec<&Loop> = found.loops.iter().collect();
        by_energy.sort_by(|a, b| b.energy_mj.total_cmp(&a.energy_mj));
        let plot = Plot {
            x: "round trip, ms".into(),
            y: "energy of the worst case, mJ".into(),
            log: (false, true),
            series: vec![
                Series::joined("without controller", worst(&found.loops, |l| l.energy_mj)),
                Series::joined("with", worst(&found.loops, |l| l.energy_controlled_mj)),
            ],
            limit: Some((FELT_MJ, "what is not felt".into())),
        };
        Self {
            worst: plot.svg(),
            by_energy,
        }
    }

    /// Time after which the state at rest repeats bit for bit, in words.
    pub(super) fn repeats_after(hour: &Hour) -> String {
        match hour.period_ticks {
            Some(1) => "stands still".to_owned(),
            Some(n) => format!("{n} ticks"),
            None if hour.whole_hour => "not in an hour".to_owned(),
            None => format!("not in {} min", hour.ticks_run / 60_000),
        }
    }
}

/// Each delay of the link, milliseconds, with the largest energy at it.
fn worst(loops: &[Loop], of: fn(&Loop) -> f64) -> Vec<(f64, f64)> {
    let mut delays: Vec<u32> = loops.iter().map(|l| l.delay_ms).collect();
    delays.sort_unstable();
    delays.dedup();
    let at = |delay: u32| {
        let all = loops.iter().filter(|l| l.delay_ms == delay);
        (f64::from(delay), all.map(of).fold(NOTHING_MJ, f64::max))
    };
    delays.into_iter().map(at).collect()
}
