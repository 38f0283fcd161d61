//! Limits of a hand without a force device: workspace, speed and backlog.

use crate::camera::Vector;

/// Limits of a hand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Lowest and highest corner of the box that holds the pivot, world axes, mm.
    pub workspace: [Vector; 2],
    /// Greatest speed of the pivot, mm/s.
    pub speed_mm_s: f64,
    /// Greatest spin, rad/s.
    pub spin_rad_s: f64,
    /// Longest time that motion is carried out after its input, seconds. Input beyond is dropped.
    pub backlog_s: f64,
}

impl Limits {
    /// Limits in a box `margin_mm` round the points of a mouth and the start of the tools, world axes, mm.
    ///
    /// Chosen: 150 mm/s, 4 rad/s, and 0.1 s. A probe in use moves at 5 to 50 mm/s.
    pub fn around(points: impl IntoIterator<Item = Vector>, margin_mm: f64) -> Self {
        let mut points = points.into_iter();
        let first = points.next().unwrap_or_default();
        let (low, high) = points.fold((first, first), |(low, high), at| {
            (low.inf(&at), high.sup(&at))
        });
        let margin = Vector::repeat(margin_mm);
        Self {
            workspace: [low - margin, high + margin],
            speed_mm_s: 150.0,
            spin_rad_s: 4.0,
            backlog_s: 0.1,
        }
    }

    /// Nearest place in the workspace.
    pub fn inside(&self, place: &Vector) -> Vector {
        let [low, high] = &self.workspace;
        place.sup(low).inf(high)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_box_holds_all_points_with_its_margin() {
        let points = [[1.0, 2.0, 3.0], [-4.0, 8.0, 0.0]].map(Vector::from);
        let limits = Limits::around(points, 10.0);
        assert_eq!(limits.workspace[0], Vector::new(-14.0, -8.0, -10.0));
        assert_eq!(limits.workspace[1], Vector::new(11.0, 18.0, 13.0));
        assert_eq!(limits.inside(&points[1]), points[1]);
        let far = Vector::new(-500.0, 0.0, 900.0);
        assert_eq!(limits.inside(&far), Vector::new(-14.0, 0.0, 13.0));
    }
}
