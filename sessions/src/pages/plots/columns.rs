//! Columns of the plots: the largest values of every few points of a session.

use crate::grade::motion::series::Point;

/// Largest number of columns.
const MOST: usize = 1400;

/// One column of a plot.
pub struct Column {
    /// Last zone of the tip: tooth and index of the site.
    pub zone: Option<(u8, usize)>,
    /// Largest depth, mm.
    pub depth: f64,
    /// Largest force, newtons.
    pub force: f64,
    /// Whether the target was visible at the end; none without a target.
    pub visible: Option<bool>,
}

/// Columns of a session. If pockets were `probed`, the force is that on the floor, else that on the leading tool.
pub fn columns(points: &[Point], probed: bool) -> Vec<Column> {
    let each = points.len().div_ceil(MOST).max(1);
    let force: fn(&Point) -> f64 = match probed {
        true => |point| point.force,
        false => |point| point.push,
    };
    let column = |chunk: &[Point]| {
        let most = |of: fn(&Point) -> f64| {
            let larger = |a: f64, b| if b > a { b } else { a };
            chunk.iter().map(of).fold(0.0, larger)
        };
        let zone = chunk.iter().rev().find_map(|point| point.zone);
        Column {
            zone: zone.map(|(tooth, site)| (tooth, site as usize)),
            depth: most(|point| point.depth) * 1e3,
            force: most(force),
            visible: chunk.last().and_then(|point| point.visible),
        }
    };
    points.chunks(each).map(column).collect()
}
