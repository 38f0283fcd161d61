//! Fewer triangles for the same surface: collapse of edges in the order of quadric errors (Garland and Heckbert 1997).
//!
//! A collapse moves a vertex onto its neighbour, so that all remaining vertices lie on the original surface. Each
//! triangle keeps the places of the original surface that it stands for, so that their distance from it has a limit.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use sulcus_core::Vec3;
use sulcus_core::math::fmax;

use super::quadric::{Quadric, squared};
use super::sheet::{Sheet, fullness};

/// Limits of the coarser surface at a place.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Distance of a place of the original surface from the coarser one.
    pub off: f64,
    /// Length of an edge.
    pub long: f64,
    /// Cosine of the angle between a triangle and the original surface at its corners.
    pub turned: f64,
}

/// Weight of an edge's length against its error: long edges go last, so that triangles stay even.
const EVEN: f64 = 0.25;
/// Quadric error, relative to the limit, beyond which a collapse is not tried.
const HOPELESS: f64 = 1.0;
/// Limit from which on the quadric error alone decides, mm: watching all places of a large triangle takes long.
const ROUGH: f64 = 0.1;
/// Least fullness of a new triangle.
const FULL: f64 = 0.18;

/// Collapses edges of a closed surface as long as the limits hold.
pub fn thin(sheet: &mut Sheet, limits: &dyn Fn(&Vec3) -> Limits) {
    let mut work = Thinning::new(sheet, limits);
    while let Some(Reverse((_, u, v, stamp))) = work.queue.pop() {
        if work.stamps[u] + work.stamps[v] == stamp
            && let Some(replaced) = work.collapsed(sheet, u, v)
        {
            work.collapse(sheet, u, v, &replaced);
        }
    }
    sheet.triangles = (0..sheet.triangles.len())
        .filter(|t| work.alive[*t])
        .map(|t| sheet.triangles[t])
        .collect();
    sheet.drop_unused();
}

/// Cost as an ordered integer, vertex that goes, vertex that stays, age of both.
type Candidate = Reverse<(u64, usize, usize, u32)>;

struct Thinning {
    limits: Vec<Limits>,
    /// Unit normals of the original surface.
    normals: Vec<Vec3>,
    quadrics: Vec<Quadric>,
    /// Triangles round each vertex.
    round: Vec<Vec<usize>>,
    /// Places of the original surface that each triangle stands for, other than its corners.
    replaced: Vec<Vec<usize>>,
    /// Places of the original surface: vertices, then the middles of triangles.
    original: Vec<Vec3>,
    alive: Vec<bool>,
    gone: Vec<bool>,
    stamps: Vec<u32>,
    queue: BinaryHeap<Candidate>,
}

impl Thinning {
    fn new(sheet: &Sheet, limits: &dyn Fn(&Vec3) -> Limits) -> Self {
        let n = sheet.at.len();
        let mut original = sheet.at.clone();
        let middle = |t: &[usize; 3]| t.iter().map(|v| sheet.at[*v]).sum::<Vec3>() / 3.0;
        original.extend(sheet.triangles.iter().map(middle));
        let mut work = Self {
            limits: original.iter().map(limits).collect(),
            normals: sheet.normals(),
            quadrics: vec![Quadric::default(); n],
            round: vec![Vec::new(); n],
            replaced: vec![Vec::new(); sheet.triangles.len()],
            original,
            alive: vec![true; sheet.triangles.len()],
            gone: vec![false; n],
            stamps: vec![0; n],
            queue: BinaryHeap::new(),
        };
        for (t, triangle) in sheet.triangles.iter().enumerate() {
            if work.is_watched(n + t) {
                work.replaced[t].push(n + t);
            }
            let plane = Quadric::of(&sheet.area_vector(*triangle), &sheet.at[triangle[0]]);
            for v in triangle {
                work.quadrics[*v].add(&plane);
                work.round[*v].push(t);
            }
        }
        for edge in sheet.edges() {
            work.propose(sheet, edge.ends);
        }
        work
    }

    /// Whether the distance of an original place is watched.
    fn is_watched(&self, place: usize) -> bool {
        self.limits[place].off < ROUGH
    }

    /// Neighbours of a vertex, ascending.
    fn neighbours(&self, sheet: &Sheet, v: usize) -> Vec<usize> {
        let corners = self.round[v].iter().flat_map(|t| sheet.triangles[*t]);
        let mut all: Vec<usize> = corners.filter(|other| *other != v).collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    fn propose(&mut self, sheet: &Sheet, [a, b]: [usize; 2]) {
        for (u, v) in [(a, b), (b, a)] {
            let limits = &self.limits[u];
            let long = (sheet.at[u] - sheet.at[v]).norm() / limits.long;
            let mut quadric = self.quadrics[u];
            quadric.add(&self.quadrics[v]);
            let off = quadric.distance(&sheet.at[v]) / fmax(limits.off, 1e-12);
            if off > HOPELESS || long > 1.0 {
                continue;
            }
            // Positive numbers have the order of their bits.
            let cost = (off + EVEN * long * long).to_bits();
            let stamp = self.stamps[u] + self.stamps[v];
            self.queue.push(Reverse((cost, u, v, stamp)));
        }
    }

    /// Returns the replaced places with their triangles after a collapse of `u` onto `v`. `None`: the surface would
    /// not stay a surface, near the original one, with full triangles.
    fn collapsed(&self, sheet: &Sheet, u: usize, v: usize) -> Option<Vec<(usize, usize)>> {
        if self.gone[u] || self.gone[v] {
            return None;
        }
        let theirs = self.neighbours(sheet, v);
        let common = self.neighbours(sheet, u);
        let common = common.iter().filter(|w| theirs.binary_search(w).is_ok());
        if common.count() != 2 {
            return None;
        }
        let round = &self.round[u];
        let kept = round.iter().filter(|t| !sheet.triangles[**t].contains(&v));
        let kept: Vec<usize> = kept.copied().collect();
        let limits = &self.limits[u];
        let new = |t: usize| sheet.triangles[t].map(|w| if w == u { v } else { w });
        let is_good = |t: &usize| {
            let corners = new(*t);
            let area = sheet.area_vector(corners);
            let normal = area / area.norm().max(f64::MIN_POSITIVE);
            let is_short = corners
                .iter()
                .all(|w| (sheet.at[*w] - sheet.at[v]).norm() <= limits.long);
            let is_true = corners
                .iter()
                .chain([&u])
                .all(|w| self.normals[*w].dot(&normal) > limits.turned);
            let old = fullness(sheet.triangles[*t].map(|w| sheet.at[w]));
            let full = fullness(corners.map(|w| sheet.at[w]));
            is_short && is_true && (full > FULL || full > old)
        };
        if !kept.iter().all(is_good) {
            return None;
        }
        let points = round.iter().flat_map(|t| self.replaced[*t].iter().copied());
        let mut replaced = Vec::new();
        for point in points.chain(Some(u).filter(|u| self.is_watched(*u))) {
            let at = self.original[point];
            let away = |t: usize| squared(&at, new(t).map(|w| sheet.at[w]));
            let off = kept.iter().map(|t| (away(*t), *t));
            let (off, t) = off.min_by(|a, b| a.0.total_cmp(&b.0))?;
            if off > self.limits[point].off * self.limits[point].off {
                return None;
            }
            replaced.push((point, t));
        }
        Some(replaced)
    }

    fn collapse(&mut self, sheet: &mut Sheet, u: usize, v: usize, replaced: &[(usize, usize)]) {
        let of_u = std::mem::take(&mut self.round[u]);
        for t in of_u {
            self.replaced[t].clear();
            if sheet.triangles[t].contains(&v) {
                self.alive[t] = false;
                for w in sheet.triangles[t] {
                    self.round[w].retain(|other| *other != t);
                }
            } else {
                sheet.triangles[t] = sheet.triangles[t].map(|w| if w == u { v } else { w });
                self.round[v].push(t);
            }
        }
        for (point, t) in replaced {
            self.replaced[*t].push(*point);
        }
        let gone = self.quadrics[u];
        self.quadrics[v].add(&gone);
        self.gone[u] = true;
        self.stamps[v] += 1;
        for w in self.neighbours(sheet, v) {
            self.propose(sheet, [v, w]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sulcus_scene::mesh::check::check;
    use sulcus_scene::mesh::distance::MeshDistance;
    use sulcus_scene::mesh::shapes::icosphere;

    #[test]
    fn a_ball_stays_a_ball_with_fewer_triangles() {
        let fine = icosphere(5.0, 5);
        let mut sheet = Sheet::of(&fine);
        thin(&mut sheet, &|_| Limits {
            off: 0.02,
            long: 1.5,
            turned: 0.9,
        });
        assert!(5 * sheet.triangles.len() < fine.triangles.len());
        let coarse = sheet.to_mesh();
        let metres = coarse.clone().placed(1e-3, Vec3::zeros());
        assert_eq!(check(&metres, "ball").expect("closed").genus, 0);
        let distance = MeshDistance::new(coarse);
        let off = fine.vertices.iter().map(|v| distance.signed(v).abs());
        let off = off.fold(0.0, f64::max);
        assert!(off < 0.02 + 1e-9, "{off}");
    }
}
