//! The support of the gingivae: the alveolar ridge of the lower jaw with the floor of the mouth, and healed ridges of
//! missing teeth.
//!
//! Both are rigid. They are mucosa on bone, and a floor that no exercise presses.
//!
//! World frame; millimetres inside, metres in results.

use sulcus_core::Vec3;
use sulcus_core::math::{fclamp, fmax, fmin};

use crate::mesh::TriMesh;
use crate::mesh::implicit::{bell, ramp, smooth_max, smooth_min};
use crate::mesh::polygonise::polygonise;

/// Bottom of the ridge, mm. The bone below it is out of reach of all tools.
const BOTTOM: f64 = -26.0;
/// Top of the floor of the mouth in the middle, its thickness, and height of the folds under the tongue, mm.
const FLOOR: f64 = -16.5;
const THICKNESS: f64 = 5.0;
const FOLDS: [f64; 2] = [1.6, 7.0];
/// Length of the ridge behind the last tooth, mm.
const BEHIND: f64 = 7.0;
/// Fillet between ridge and floor, and rounding of the ridge's edges, mm.
const FILLET: f64 = 4.0;
const EDGE: f64 = 1.2;
/// Widening of the ridge for each mm downwards.
const FLARE: f64 = 0.12;
/// Edge of the grid, mm.
const GRID: f64 = 0.8;
/// Height of a healed ridge over the CEJ of the missing tooth, and its rounding, mm.
const HEALED: f64 = -2.0;
const ROUND: f64 = 3.0;

/// A place on the arch: the tooth's axis, and the reach of its gingiva buccally and lingually.
#[derive(Clone, Copy, Debug)]
pub struct Station {
    /// Place in the world, mm.
    pub at: [f64; 2],
    /// Unit vector buccally.
    pub buccal: [f64; 2],
    /// Distances from the axis to the outer faces, buccal and lingual, mm.
    pub faces: [f64; 2],
}

/// Ridge and floor below the height `top` (mm), along stations from the right to the left.
pub fn jaw(stations: &[Station], top: f64) -> TriMesh {
    let arch = Arch::new(stations);
    let f = |p: &Vec3| arch.drawn(p, top);
    let margin = 14.0;
    let (mut low, mut high) = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
    for [x, y] in &arch.line {
        let p = Vec3::new(*x, *y, 0.0);
        (low, high) = (low.inf(&p), high.sup(&p));
    }
    let low = Vec3::new(low.x - margin, low.y - margin, BOTTOM - 2.0);
    let high = Vec3::new(high.x + margin, high.y + margin, top + 2.0);
    polygonise(&f, low, high, GRID).placed(1e-3, Vec3::zeros())
}

/// Returns the healed ridge of a missing tooth from the height `base` upwards, in that tooth's frame.
///
/// `ends` are the distances of the neighbours' gingivae mesially and distally, `faces` those of the outer faces
/// buccally and lingually, mm.
pub fn healed(ends: [f64; 2], faces: [f64; 2], base: f64) -> TriMesh {
    let (middle, half) = (0.5 * (faces[0] - faces[1]), 0.5 * (faces[0] + faces[1]));
    let f = |p: &Vec3| {
        // A saddle: lower in the middle than beside the neighbours, narrower on top.
        let along = 2.0 * p.x / (ends[0] + ends[1]);
        let top = HEALED + 0.8 * along * along;
        let narrow = 0.75 + 0.25 * ramp(top - p.z, 0.0, 5.0);
        let across = (p.y - middle).abs() - half * narrow;
        let walls = fmax(fmax(p.x - ends[0], -p.x - ends[1]), base - p.z);
        fmax(smooth_max(across, p.z - top, ROUND), walls)
    };
    let low = Vec3::new(-ends[1] - 1.0, -faces[1] - 2.0, base - 1.0);
    let high = Vec3::new(ends[0] + 1.0, faces[0] + 2.0, HEALED + 3.0);
    polygonise(&f, low, high, 0.5).placed(1e-3, Vec3::zeros())
}

struct Arch {
    /// Middle line of the ridge, with its half widths.
    line: Vec<[f64; 2]>,
    halves: Vec<f64>,
}

impl Arch {
    fn new(stations: &[Station]) -> Self {
        let (mut line, mut halves) = (Vec::new(), Vec::new());
        for station in stations {
            let [buccal, lingual] = station.faces;
            let off = 0.5 * (buccal - lingual);
            line.push([
                station.at[0] + station.buccal[0] * off,
                station.at[1] + station.buccal[1] * off,
            ]);
            halves.push(0.5 * (buccal + lingual) + 0.2);
        }
        // Straight back behind the last teeth.
        let on = |p: &[f64; 2]| [p[0] - BEHIND, p[1] * 1.03];
        let (first, last) = (on(&line[0]), on(&line[line.len() - 1]));
        line.insert(0, first);
        line.push(last);
        halves.insert(0, 0.8 * halves[0]);
        halves.push(0.8 * halves[halves.len() - 1]);
        Self { line, halves }
    }

    /// Returns the distance from the middle line, the half width there, and whether a point is on the tongue's side.
    fn beside(&self, x: f64, y: f64) -> (f64, f64, bool) {
        let (mut nearest, mut half) = (f64::INFINITY, 0.0);
        let mut inside = false;
        let n = self.line.len();
        for k in 0..n {
            // The last piece closes the line behind.
            let (a, b) = (self.line[k], self.line[(k + 1) % n]);
            if (a[1] > y) != (b[1] > y) {
                let cross = a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
                inside ^= x < cross;
            }
            if k + 1 == n {
                break;
            }
            let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
            let t = ((x - a[0]) * dx + (y - a[1]) * dy) / (dx * dx + dy * dy);
            let t = fclamp(t, 0.0, 1.0);
            let (ex, ey) = (x - a[0] - t * dx, y - a[1] - t * dy);
            let off = (ex * ex + ey * ey).sqrt();
            if off < nearest {
                nearest = off;
                half = self.halves[k] + t * (self.halves[k + 1] - self.halves[k]);
            }
        }
        (nearest, half, inside)
    }

    fn drawn(&self, p: &Vec3, top: f64) -> f64 {
        let (off, half, inside) = self.beside(p.x, p.y);
        let wide = half + FLARE * fmax(top - p.z, 0.0);
        let ridge = smooth_max(off - wide, p.z - top, EDGE);
        let ridge = smooth_max(ridge, BOTTOM - p.z, EDGE);
        // Folds run forwards under the tongue. The floor rises towards the jaw.
        let fold = FOLDS[0] * (bell(p.y - FOLDS[1], 3.0) + bell(p.y + FOLDS[1], 3.0));
        let height = FLOOR + fold * ramp(p.x, -35.0, 5.0);
        let border = if inside { -off } else { off };
        let floor = fmax(fmax(p.z - height, height - THICKNESS - p.z), border);
        smooth_min(ridge, fmin(floor, 20.0), FILLET)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::check::check;

    fn stations() -> Vec<Station> {
        (-6..=6)
            .map(|k| {
                let turn = f64::from(k) * 0.25;
                let (s, c) = (libm::sin(turn), libm::cos(turn));
                Station {
                    at: [24.0 * c, 24.0 * s],
                    buccal: [c, s],
                    faces: [5.0, 5.5],
                }
            })
            .collect()
    }

    #[test]
    fn jaw_and_healed_ridge_are_solids_below_their_tops() {
        let jaw = jaw(&stations(), -13.5);
        let report = check(&jaw, "jaw").expect("a solid");
        assert_eq!(report.genus, 0, "{report:?}");
        assert!(jaw.bounds().1.z < -12.9e-3);
        let healed = healed([5.0, 4.5], [5.5, 6.0], -14.0);
        let report = check(&healed, "healed ridge").expect("a solid");
        assert_eq!(report.genus, 0, "{report:?}");
        let (low, high) = healed.bounds();
        assert!(low.z > -14.3e-3 && high.z < -1e-3 && high.x < 5.1e-3 && low.x > -4.6e-3);
    }
}
