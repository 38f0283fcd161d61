//! The walls of a tooth: its outlines seen from the four sides, and rounded sections between them.

use sulcus_core::Vec3;
use sulcus_core::math::{fclamp, fmax, fmin};

use crate::mesh::implicit::{ramp, through};

/// Heights at which the outlines are given.
pub(super) const LEVELS: usize = 12;

/// Outlines along the height, mm, and the form of the sections.
pub(super) struct Walls {
    /// Heights from the centre of the apex's round end upwards.
    pub z: [f64; LEVELS],
    /// Mesial outline, x.
    pub mesial: [f64; LEVELS],
    /// Distal outline, x.
    pub distal: [f64; LEVELS],
    /// Buccal outline, y.
    pub buccal: [f64; LEVELS],
    /// Lingual outline, y.
    pub lingual: [f64; LEVELS],
    /// y of the mesial and distal outlines: the section is widest there.
    pub widest: [f64; LEVELS],
    /// x of the buccal and lingual outlines.
    pub crest: [f64; LEVELS],
    /// Exponents of the mesiodistal coordinate in the root and in the crown. Larger ones flatten the buccal and
    /// lingual faces.
    pub flat: [f64; 2],
    /// Exponents of the buccolingual coordinate: root, crown buccally, crown lingually. With 2, proximal faces are as
    /// round as an ellipse.
    pub round: [f64; 3],
    /// Taper of the crown: share by which its sections are narrower at the lingual outline. A first molar is 11 mm
    /// broad buccally and 9.5 mm lingually, and its lingual embrasures are the wider ones.
    pub taper: f64,
    /// Height of the round end of the root, mm.
    pub apex: f64,
    /// Rise of the CEJ on the mesial, distal and lingual side, mm.
    pub cej: [f64; 3],
}

/// A point in coordinates of the walls.
pub(super) struct Spot {
    pub p: Vec3,
    /// Place in the section: 1 at the mesial, -1 at the distal outline.
    pub u: f64,
    /// Place in the section: 1 at the buccal, -1 at the lingual outline.
    pub v: f64,
}

/// Thickness of the enamel's edge, mm.
const ENAMEL: f64 = 0.11;

impl Walls {
    /// Returns the height of the CEJ in the direction (x, y), drawn mm.
    pub fn cej(&self, x: f64, y: f64) -> f64 {
        let [mesial, distal, lingual] = self.cej;
        let square = fmax(x * x + y * y, 1e-12);
        let rise = if x > 0.0 { mesial } else { distal };
        let behind = if y < 0.0 { lingual } else { 0.0 };
        // Squares: smooth from each side to the next. The proximal ones are narrower.
        let (across, along) = (x * x / square, y * y / square);
        rise * across * across * (1.5 - 0.5 * across) + behind * along * along
    }

    /// Returns about the signed distance to the walls at a drawn point, mm.
    pub fn at(&self, p: &Vec3) -> (f64, Spot) {
        // Round end of the root: the outlines continue, and a half ellipse closes them.
        let below = fclamp((self.z[0] - p.z) / self.apex, 0.0, 2.0);
        let outline = |values: &[f64; LEVELS]| {
            let slope = (values[1] - values[0]) / (self.z[1] - self.z[0]);
            through(&self.z, values, p.z) - slope * self.apex * fmin(below, 1.0)
        };
        let (cx, cy) = (outline(&self.crest), outline(&self.widest));
        let (dx, dy) = (p.x - cx, p.y - cy);
        let hx = if dx > 0.0 {
            outline(&self.mesial) - cx
        } else {
            cx - outline(&self.distal)
        };
        let hy = if dy > 0.0 {
            outline(&self.buccal) - cy
        } else {
            cy - outline(&self.lingual)
        };
        let crown = ramp(p.z, -0.5, 3.0);
        let v = dy / hy;
        let behind = fclamp(-v, 0.0, 1.0);
        let hx = hx * (1.0 - self.taper * crown * behind * behind);
        let u = dx / hx;
        let above = p.z - self.cej(p.x, p.y);
        let m = self.flat[0] + (self.flat[1] - self.flat[0]) * crown;
        let side = if dy > 0.0 {
            self.round[1]
        } else {
            self.round[2]
        };
        let n = self.round[0] + (side - self.round[0]) * crown;
        let (au, av) = (u.abs(), v.abs());
        let sum = fmax(libm::pow(au, m) + libm::pow(av, n), 1e-9);
        let q = 2.0 * m * n / (m + n);
        let ring = libm::pow(sum, 1.0 / q);
        // The ring divided by its gradient is a distance, also for a section that is a thin slab.
        let gu = ring / sum / q * m * libm::pow(au, m - 1.0) / hx;
        let gv = ring / sum / q * n * libm::pow(av, n - 1.0) / hy;
        let (mut ring, mut square) = (ring, gu * gu + gv * gv);
        if below > 0.0 {
            let whole = (ring * ring + below * below).sqrt();
            let gz = below / self.apex / whole;
            square = square * (ring / whole) * (ring / whole) + gz * gz;
            ring = whole;
        }
        let longest = fmax(hx, hy);
        let steep = fmax(square.sqrt(), 0.5 / longest);
        let walls = fclamp((ring - 1.0) / steep, -longest, 1e3);
        let enamel = ENAMEL * ramp(above, -0.2, 0.5);
        let spot = Spot { p: *p, u, v };
        (walls - enamel, spot)
    }
}
