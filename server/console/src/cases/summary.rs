//! Counts of a chart that teachers choose cases by.

use serde::Serialize;

use crate::house::cases::Chart;

/// Depth from which a site is a pocket, mm.
const POCKET_MM: f64 = 4.0;

/// Counts of a chart.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Summary {
    /// Number of present teeth.
    pub teeth: usize,
    /// Mean probing depth, mm.
    pub mean_depth_mm: f64,
    /// Deepest site, mm.
    pub deepest_mm: f64,
    /// Number of sites of at least 4 mm.
    pub pockets: usize,
    /// Share of sites that bleed, percent.
    pub bleeding_percent: f64,
    /// Number of teeth with a furcation.
    pub furcations: usize,
}

impl Summary {
    /// Counts of a chart.
    pub fn of(chart: &Chart) -> Self {
        let teeth = &chart.teeth;
        let sites = 6 * teeth.len();
        let depths = || {
            let sides = teeth.iter().map(|tooth| &tooth.depth_mm);
            sides.flat_map(|sides| sides.buccal.iter().chain(&sides.lingual).copied())
        };
        let bleeding = teeth.iter().map(|tooth| &tooth.bleeding);
        let bleeding = bleeding.flat_map(|sides| sides.buccal.iter().chain(&sides.lingual));
        let bleeding = bleeding.filter(|bleeds| **bleeds).count();
        let share = |count: f64| {
            if sites == 0 {
                0.0
            } else {
                (10.0 * count / sites as f64).round() / 10.0
            }
        };
        Self {
            teeth: teeth.len(),
            mean_depth_mm: share(depths().sum()),
            deepest_mm: depths().fold(0.0, f64::max),
            pockets: depths().filter(|depth| *depth >= POCKET_MM).count(),
            bleeding_percent: share(100.0 * bleeding as f64).round(),
            furcations: teeth
                .iter()
                .filter(|tooth| tooth.furcation != [0, 0])
                .count(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::house::cases::{Sides, ToothChart};

    #[test]
    fn the_counts_are_those_of_the_sites() {
        let tooth = ToothChart {
            fdi: 36,
            depth_mm: Sides {
                buccal: [5.0, 4.0, 3.0],
                lingual: [2.0, 3.0, 1.0],
            },
            recession_mm: Sides::default(),
            bleeding: Sides {
                buccal: [true, false, false],
                lingual: [false, true, false],
            },
            inflammation: 0.0,
            furcation: [0, 2],
            mobility: 0,
        };
        let mut chart = Chart {
            label: "one".into(),
            missing: Vec::new(),
            teeth: vec![tooth],
        };
        let expected = Summary {
            teeth: 1,
            mean_depth_mm: 3.0,
            deepest_mm: 5.0,
            pockets: 2,
            bleeding_percent: 33.0,
            furcations: 1,
        };
        assert_eq!(Summary::of(&chart), expected);
        chart.teeth.clear();
        assert_eq!(Summary::of(&chart), Summary::default());
    }
}
