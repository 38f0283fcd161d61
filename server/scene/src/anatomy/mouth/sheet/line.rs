//! Line of the arch through the contact points, and coordinates beside it.
//!
//! - `s`: length along the line from the midline, mm; positive on the patient's left.
//! - `d`: distance from the line in the horizontal plane, mm; positive towards lip and cheek.
//!
//! The right half is the mirror image of the left half, bit for bit.

use sulcus_core::Vec3;
use sulcus_core::math::{fclamp, fmin};

use super::super::Standing;
use crate::anatomy::arch::to_world;

/// Number of teeth of a side.
pub(super) const SIDE: usize = 7;
/// Length of the line behind the last tooth, mm: retromolar pad and the tissue that rises into the ramus.
pub(super) const BEHIND: f64 = 17.0;
/// Growth of the distance from the midline behind the last tooth, for each mm backwards. Chosen.
const SPREAD: f64 = 0.1;
/// Distance between nodes, mm.
const STEP: f64 = 0.2;
/// Number of samples of a stretch between two contact points.
const SAMPLES: usize = 80;

/// Line of the arch.
pub(super) struct Line {
    /// Places on the left half at equal steps from the midline backwards, mm.
    nodes: Vec<[f64; 2]>,
    /// Lengths at the contact points, from the midline (0) to the end behind the last tooth, mm.
    pub knots: Vec<f64>,
}

impl Line {
    /// Line of the teeth `all`, in the order of `LOWER`.
    pub fn new(all: &[Standing]) -> Self {
        let left = &all[SIDE..];
        let contact = |tooth: &Standing, end: usize| {
            let at = to_world(&tooth.frame_mm(), &tooth.contacts[end]);
            [at.x, at.y]
        };
        let mut through = vec![[contact(&left[0], 0)[0], 0.0]];
        for k in 0..SIDE - 1 {
            let (a, b) = (contact(&left[k], 1), contact(&left[k + 1], 0));
            through.push([0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])]);
        }
        let last = contact(&left[SIDE - 1], 1);
        through.push(last);
        through.push([last[0] - BEHIND, last[1] + SPREAD * BEHIND]);
        let (fine, ends) = sampled(&through);
        resampled(&fine, &ends)
    }

    /// Length of the half line, mm.
    pub fn half(&self) -> f64 {
        STEP * (self.nodes.len() - 1) as f64
    }

    /// Place of the contact `k` of all 16: the right end, the contacts of the teeth from the right to the left, the
    /// left end.
    pub fn knot(&self, k: usize) -> f64 {
        let middle = SIDE + 1;
        if k < middle {
            -self.knots[middle - k]
        } else {
            self.knots[k - middle]
        }
    }

    /// Point of the line and unit normal towards the lip at `s`.
    fn frame(&self, s: f64) -> ([f64; 2], [f64; 2]) {
        let last = self.nodes.len() - 1;
        let at = fclamp(s.abs() / STEP, 0.0, last as f64);
        let k = (at as usize).min(last - 1);
        let f = at - k as f64;
        let mix = |a: [f64; 2], b: [f64; 2]| [a[0] + (b[0] - a[0]) * f, a[1] + (b[1] - a[1]) * f];
        let p = mix(self.nodes[k], self.nodes[k + 1]);
        let t = mix(self.along(k), self.along(k + 1));
        let length = (t[0] * t[0] + t[1] * t[1]).sqrt();
        let n = [t[1] / length, -t[0] / length];
        if s < 0.0 {
            ([p[0], -p[1]], [n[0], -n[1]])
        } else {
            (p, n)
        }
    }

    /// Direction of the left half at a node.
    fn along(&self, k: usize) -> [f64; 2] {
        if k == 0 {
            return [0.0, 1.0];
        }
        let (a, b) = (
            self.nodes[k - 1],
            self.nodes[(k + 1).min(self.nodes.len() - 1)],
        );
        let t = [b[0] - a[0], b[1] - a[1]];
        let length = (t[0] * t[0] + t[1] * t[1]).sqrt();
        [t[0] / length, t[1] / length]
    }

    /// Point of the world, mm, at `s`, `d` and the height `z`.
    pub fn at(&self, s: f64, d: f64, z: f64) -> Vec3 {
        let (p, n) = self.frame(s);
        Vec3::new(p[0] + n[0] * d, p[1] + n[1] * d, z)
    }

    /// Coordinates `s` and `d` of a point of the world, mm.
    pub fn of(&self, p: &Vec3) -> [f64; 2] {
        let side = if p.y < 0.0 { -1.0 } else { 1.0 };
        let y = p.y.abs();
        let (mut nearest, mut s) = (f64::INFINITY, 0.0);
        for k in (0..self.nodes.len()).step_by(6) {
            let [a, b] = self.nodes[k];
            let off = (p.x - a) * (p.x - a) + (y - b) * (y - b);
            if off < nearest {
                (nearest, s) = (off, k as f64 * STEP);
            }
        }
        for _ in 0..14 {
            let (c, n) = self.frame(s);
            // The direction along the line is the normal turned by a quarter.
            s += 0.8 * ((y - c[1]) * n[0] - (p.x - c[0]) * n[1]);
            s = fclamp(s, 0.0, self.half());
        }
        let (c, n) = self.frame(s);
        [side * s, (p.x - c[0]) * n[0] + (y - c[1]) * n[1]]
    }
}

/// Samples of a smooth curve through points, and the number of the last sample of each stretch.
fn sampled(through: &[[f64; 2]]) -> (Vec<[f64; 2]>, Vec<usize>) {
    let n = through.len();
    let chord = |a: [f64; 2], b: [f64; 2]| {
        ((b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1])).sqrt()
    };
    let slope = |k: usize| {
        if k == 0 {
            return [0.0, 1.0];
        }
        let (a, b) = (through[k - 1], through[(k + 1).min(n - 1)]);
        let length = chord(a, through[k]) + chord(through[k], b);
        [(b[0] - a[0]) / length, (b[1] - a[1]) / length]
    };
    let (mut fine, mut ends) = (vec![through[0]], vec![0]);
    for k in 0..n - 1 {
        let (a, b, length) = (
            through[k],
            through[k + 1],
            chord(through[k], through[k + 1]),
        );
        let (u, v) = (slope(k), slope(k + 1));
        for j in 1..=SAMPLES {
            let t = j as f64 / SAMPLES as f64;
            let (t2, t3) = (t * t, t * t * t);
            let of = |i: usize| {
                a[i] * (2.0 * t3 - 3.0 * t2 + 1.0)
                    + u[i] * length * (t3 - 2.0 * t2 + t)
                    + b[i] * (3.0 * t2 - 2.0 * t3)
                    + v[i] * length * (t3 - t2)
            };
            fine.push([of(0), of(1)]);
        }
        ends.push(fine.len() - 1);
    }
    (fine, ends)
}

/// Line with nodes at equal lengths.
fn resampled(fine: &[[f64; 2]], ends: &[usize]) -> Line {
    let mut length = vec![0.0];
    for k in 1..fine.len() {
        let (dx, dy) = (fine[k][0] - fine[k - 1][0], fine[k][1] - fine[k - 1][1]);
        length.push(length[k - 1] + (dx * dx + dy * dy).sqrt());
    }
    let whole = length[fine.len() - 1];
    let count = (whole / STEP) as usize;
    let (mut nodes, mut k) = (Vec::with_capacity(count + 1), 0);
    for j in 0..=count {
        let wanted = j as f64 * STEP;
        while k + 2 < fine.len() && length[k + 1] < wanted {
            k += 1;
        }
        let f = (wanted - length[k]) / (length[k + 1] - length[k]);
        let (a, b) = (fine[k], fine[k + 1]);
        nodes.push([a[0] + (b[0] - a[0]) * f, a[1] + (b[1] - a[1]) * f]);
    }
    let most = count as f64 * STEP;
    Line {
        nodes,
        knots: ends.iter().map(|end| fmin(length[*end], most)).collect(),
    }
}
