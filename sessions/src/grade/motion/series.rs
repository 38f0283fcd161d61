//! Depth, force and sight over time, for plots: the largest values of every 50 ms.

use sulcus_core::tissue::gingiva::Site;

use crate::exercise::events::Standing;

/// Time between two points, seconds.
pub const STEP_S: f64 = 0.05;
/// Largest number of points: two hours.
const MOST: usize = 144_000;

/// Values of 50 ms.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Point {
    /// Last zone of the tip. None outside pockets.
    pub zone: Option<(u8, Site)>,
    /// Tick of the session at which that zone was last seen. 0 outside pockets.
    pub tick: u64,
    /// Largest depth, metres.
    pub depth: f64,
    /// Largest force on the floor, newtons.
    pub force: f64,
    /// Largest force on the leading tool from any object, newtons.
    pub push: f64,
    /// Whether the target was visible at the end. None without a target.
    pub visible: Option<bool>,
}

/// Points of a session.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series(pub Vec<Point>);

impl Series {
    /// Takes in the tick of the session `tick`, `at_s` seconds after the first tick. `push` is the force on the leading
    /// tool, newtons.
    pub fn observe(
        &mut self,
        (tick, at_s): (u64, f64),
        at: Option<&Standing>,
        push: f64,
        visible: Option<bool>,
    ) {
        let k = (at_s / STEP_S) as usize;
        if k >= MOST {
            return;
        }
        if self.0.len() <= k {
            self.0.resize(k + 1, Point::default());
        }
        let point = &mut self.0[k];
        point.visible = visible;
        if push > point.push {
            point.push = push;
        }
        let Some(at) = at.filter(|at| at.depth > 0.0) else {
            return;
        };
        point.zone = Some((at.tooth, at.site));
        point.tick = tick;
        if at.depth > point.depth {
            point.depth = at.depth;
        }
        if at.force > point.force {
            point.force = at.force;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grade::test_help::standing;

    #[test]
    fn a_point_has_the_largest_of_its_time() {
        let mut series = Series::default();
        for (at_s, mm, force) in [
            (0.0, 1.0, 0.1),
            (0.01, 2.0, 0.3),
            (0.049, 1.5, 0.2),
            (0.12, 3.0, 0.0),
        ] {
            let at = standing(36, Site::Buccal, 90.0, mm, force);
            let tick = (at_s * 1e3) as u64;
            series.observe((tick, at_s), Some(&at), 2.0 * force, Some(at_s < 0.1));
        }
        assert_eq!(series.0.len(), 3);
        let first = series.0[0];
        assert!((first.depth - 2e-3).abs() < 1e-12 && first.force == 0.3 && first.push == 0.6);
        assert_eq!(
            (first.zone, first.tick, first.visible),
            (Some((36, Site::Buccal)), 49, Some(true))
        );
        assert_eq!(series.0[1], Point::default());
        assert_eq!(series.0[2].visible, Some(false));
        // Points after two hours are dropped.
        series.observe((1, 1e9), None, 0.0, None);
        assert_eq!(series.0.len(), 3);
    }
}
