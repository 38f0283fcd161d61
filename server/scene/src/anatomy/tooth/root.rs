//! The two roots of a lower molar and the roof between them.

use sulcus_core::Vec3;
use sulcus_core::math::{fclamp, fmax, fmin};

use crate::mesh::implicit::{bell, ramp, through};

/// A root: an ellipse that follows a centre line, with round ends.
pub(super) struct Tube {
    /// Knots of the centre line, x, mm.
    pub x: [f64; 4],
    /// Their depths below the buccal CEJ, mm.
    pub depth: [f64; 4],
    /// Half the mesiodistal width there, mm.
    pub half: [f64; 4],
    /// Buccolingual over mesiodistal width there.
    pub stretch: [f64; 4],
    /// Height of the round end, mm.
    pub apex: f64,
    /// Depth of the groove that runs down its mesial and distal faces, mm.
    pub groove: f64,
}

/// Both roots.
pub(super) struct Roots {
    pub mesial: Tube,
    pub distal: Tube,
    /// Depth of the roof below the buccal CEJ at the buccal and at the lingual entrance, mm.
    pub roof: [f64; 2],
    /// Distance of the entrances from the axis, mm.
    pub reach: f64,
    /// Rounding of the roof, mm.
    pub arch: f64,
}

impl Roots {
    /// Returns the height below which there is no trunk.
    pub fn roof(&self, p: &Vec3) -> f64 {
        let [buccal, lingual] = self.roof;
        let along = fclamp(p.y / self.reach, -1.0, 1.0);
        let middle = 0.5 * (buccal + lingual) - 0.25;
        let half = 0.5 * (buccal - lingual);
        -(middle + half * along + 0.25 * along * along)
    }

    /// Returns about the signed distances to the roots, mm.
    pub fn tubes(&self, p: &Vec3) -> [f64; 2] {
        [self.mesial.distance(p), self.distal.distance(p)]
    }
}

impl Tube {
    fn distance(&self, p: &Vec3) -> f64 {
        let depth = fmax(-p.z, self.depth[0]);
        let last = self.depth[3];
        // The outlines of a root continue at the apex, and a half ellipse closes them, as for one root.
        let below = fclamp(depth - last, 0.0, 2.0 * self.apex);
        let at = |values: &[f64; 4]| {
            let slope = (values[3] - values[2]) / (self.depth[3] - self.depth[2]);
            through(&self.depth, values, depth) + slope * fmin(below, self.apex)
        };
        let half = at(&self.half);
        // The buccolingual stretch makes a round tube flat.
        let y = p.y / at(&self.stretch);
        let dx = p.x - at(&self.x);
        // Upwards a tube ends in a ball, inside the trunk.
        let dz = if below > 0.0 {
            below / self.apex * half
        } else {
            p.z + depth
        };
        let groove =
            self.groove * bell(p.y, 1.1) * ramp(depth, 1.0, 4.5) * (1.0 - ramp(depth, 8.5, 11.5));
        (dx * dx + y * y + dz * dz).sqrt() - half + groove * fmax(0.0, 1.0 - 0.5 * (y / half).abs())
    }
}
