//! Drawing of a tooth: an implicit function of its outlines, chewing surface, carving and roots.

use sulcus_core::Vec3;

use super::root::Roots;
use super::section::{Spot, Walls};
use crate::mesh::implicit::{bell, smooth_max, smooth_min};

/// Overall dimensions, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Size {
    pub(super) mesiodistal: f64,
    pub(super) buccolingual: f64,
    pub(super) crown: f64,
    pub(super) root: f64,
}

/// Fissures of a chewing surface, drawn x and y, mm.
pub(super) struct Fissures {
    /// Developmental grooves, each a chain of points. They meet the pits.
    pub(super) main: &'static [&'static [[f64; 2]]],
    /// Supplementary grooves beside the triangular ridges. They fade towards their second ends.
    pub(super) branches: &'static [[[f64; 2]; 2]],
}

impl Fissures {
    /// No fissures: a tooth without a chewing table.
    pub(super) const NONE: Self = Self {
        main: &[],
        branches: &[],
    };
}

/// Drawing of one tooth.
pub(super) struct Form {
    /// Average size: the size of a tooth without other dimensions.
    pub(super) usual: Size,
    /// Size of the drawing, from its own extremes.
    pub(super) drawn: Size,
    /// Edge of the grid, mm.
    pub(super) grid: f64,
    pub(super) walls: Walls,
    /// Fissures of the chewing surface.
    pub(super) fissures: &'static Fissures,
    /// Rounding of the edge between walls and chewing surface, mm.
    pub(super) edge: f64,
    /// Height of the chewing surface over a point, by relief.
    pub(super) chewing: fn(x: f64, y: f64, relief: f64) -> f64,
    /// Depth carved out of the walls (positive) or laid on (negative), mm.
    pub(super) carving: fn(&Spot) -> f64,
    /// Roots of their own, if there are two.
    pub(super) roots: Option<Roots>,
}

impl Form {
    /// Returns about the signed distance at a drawn point, mm.
    pub(super) fn distance(&self, p: &Vec3, relief: f64) -> f64 {
        let (walls, spot) = self.walls.at(p);
        let walls = walls + (self.carving)(&spot);
        // The height field is valid above the neck only.
        let whole = if p.z > 0.0 {
            let top = (p.z - (self.chewing)(p.x, p.y, relief)) * 0.8;
            smooth_max(walls, top, self.edge)
        } else {
            walls
        };
        match &self.roots {
            None => whole,
            Some(roots) => {
                let trunk = smooth_max(whole, roots.roof(p) - p.z, roots.arch);
                let [a, b] = roots.tubes(p);
                // A fillet in the furcation; on the outer faces trunk and root are flush.
                let fillet = 0.15 + 0.65 * bell(p.x, 1.7);
                smooth_min(trunk, smooth_min(a, b, 0.4), fillet)
            }
        }
    }
}
