//! Volumes by columns: union and mesh are cut exactly along parallel rays on a fine grid.
//!
//! Only the two directions across the rays are sampled.
//!
//! Gaps of the union on neighbouring rays also show its cavities: empty space that is closed off from the outside.
//!
//! Users: `volume_error_percent`, missing and excess volume in the table and the JSON of `sulcus-server tree`;
//! share of cavities in the JSON.

use sulcus_core::Sphere;
use sulcus_core::math::{fmax, fmin};

use super::exposed::ExposedPoint;
use crate::mesh::TriMesh;
use crate::parallel;
use crate::tree::rays::{Grid, Span, bucketed, length, merged};

/// An empty stretch of a ray between two stretches inside the union.
struct Gap {
    span: Span,
    /// Whether the gap is closed off from the outside.
    closed: bool,
}

/// Least rays through a cavity. On fewer rays it cannot be distinguished from a crevice of the outer surface.
const LEAST_RAYS: u32 = 4;

/// Largest number of cuts, over all rays and balls.
const MOST_CUTS: f64 = 5e7;

/// The rays with their cuts.
pub(super) struct Columns {
    grid: Grid,
    /// Distance between rays, metres.
    pub(super) step: f64,
    gaps: Vec<Vec<Gap>>,
    /// First and last point of the union on each ray.
    ends: Vec<Option<Span>>,
    /// Volume of the mesh outside of the union, cubic metres.
    pub(super) missing: f64,
    /// Volume of the union outside of the mesh, cubic metres.
    pub(super) excess: f64,
    /// Volume of closed cavities of the union, cubic metres.
    pub(super) cavities: f64,
}

/// One row of rays.
struct Row {
    missing: f64,
    excess: f64,
    gaps: Vec<Vec<Gap>>,
    ends: Vec<Option<Span>>,
}

impl Columns {
    /// Makes about `count` rays along the longest side of the box around union and mesh; fewer if balls would be cut
    /// too often.
    pub(super) fn new(spheres: &[Sphere], mesh: &TriMesh, count: usize) -> Self {
        let (mut low, mut high) = mesh.bounds();
        for s in spheres {
            low = low.zip_map(&s.centre.map(|x| x - s.radius), fmin);
            high = high.zip_map(&s.centre.map(|x| x + s.radius), fmax);
        }
        let grid = Grid::new(low, high, spheres, count, MOST_CUTS);
        let mut columns = Self {
            step: grid.step,
            grid,
            gaps: Vec::new(),
            ends: Vec::new(),
            missing: 0.0,
            excess: 0.0,
            cavities: 0.0,
        };
        columns.cut(spheres, mesh);
        columns.label();
        columns
    }

    /// Returns whether each exposed point lines a closed cavity. The points of a ball are consecutive.
    pub(super) fn lining(&self, exposed: &[ExposedPoint]) -> Vec<bool> {
        let balls: Vec<&[ExposedPoint]> = exposed.chunk_by(|a, b| a.ball == b.ball).collect();
        let lining = parallel::map(balls.len(), |k| {
            let points = balls[k];
            let known: Vec<Option<bool>> = points.iter().map(|p| self.lines_cavity(p)).collect();
            let nearest = |p: &ExposedPoint| {
                let mut best = (f64::INFINITY, false);
                for (other, known) in points.iter().zip(&known) {
                    let square = (other.point - p.point).norm_squared();
                    if let Some(known) = known
                        && square < best.0
                    {
                        best = (square, *known);
                    }
                }
                best.1
            };
            // In a crease too narrow for the rays, the nearest point on the same ball decides.
            let each = points.iter().zip(&known);
            each.map(|(point, known)| known.unwrap_or_else(|| nearest(point)))
                .collect::<Vec<bool>>()
        });
        lining.concat()
    }

    /// Returns whether the empty space before an exposed point is a closed cavity; `None` if no ray near it crosses
    /// that space.
    fn lines_cavity(&self, exposed: &ExposedPoint) -> Option<bool> {
        let p = exposed.point + exposed.normal * (0.5 * self.step);
        let [u, v, w] = self.grid.axes;
        let at = |axis: usize| ((p[axis] - self.grid.low[axis]) / self.step).floor() as isize;
        let (i, j) = (at(u), at(v));
        // The ray itself or, in a narrow place, one beside it.
        for (di, dj) in [(0, 0), (1, 0), (-1, 0), (0, 1), (0, -1)] {
            let (i, j) = (i + di, j + dj);
            let inside = |x: isize, size: usize| x >= 0 && (x as usize) < size;
            if !inside(i, self.grid.size[0]) || !inside(j, self.grid.size[1]) {
                return Some(false);
            }
            let column = j as usize * self.grid.size[0] + i as usize;
            if self
                .open_ends(column)
                .iter()
                .flatten()
                .any(|span| span.0 < p[w] && p[w] < span.1)
            {
                return Some(false);
            }
            let mut gaps = self.gaps[column].iter();
            if let Some(gap) = gaps.find(|gap| gap.span.0 < p[w] && p[w] < gap.span.1) {
                return Some(gap.closed);
            }
        }
        None
    }

    fn cut(&mut self, spheres: &[Sphere], mesh: &TriMesh) {
        let [u, v, _] = self.grid.axes;
        let size = self.grid.size;
        let balls = self.grid.rows(spheres);
        let triangles = bucketed(
            size[1],
            (0..mesh.triangles.len()).map(|t| {
                let c = mesh.corners(t).map(|c| c[v]);
                let (least, most) = (fmin(c[0], fmin(c[1], c[2])), fmax(c[0], fmax(c[1], c[2])));
                (self.grid.first(least, 1), self.grid.first(most, 1))
            }),
        );
        let this = &*self;
        let rows = parallel::map(size[1], |row| {
            let y = this.grid.row(row);
            let union = this.grid.through(spheres, &balls[row], y);
            let mut crossings: Vec<Vec<(f64, i32)>> = vec![Vec::new(); size[0]];
            for &t in &triangles[row] {
                let c = mesh.corners(t as usize).map(|c| c[u]);
                let (least, most) = (fmin(c[0], fmin(c[1], c[2])), fmax(c[0], fmax(c[1], c[2])));
                let range = crossings.iter_mut().enumerate();
                for (column, found) in range
                    .take(this.grid.first(most, 0))
                    .skip(this.grid.first(least, 0))
                {
                    let x = this.grid.low[u] + (column as f64 + 0.5) * this.step;
                    found.extend(crossing(mesh, t as usize, this.grid.axes, x, y));
                }
            }
            let mut result = Row {
                missing: 0.0,
                excess: 0.0,
                gaps: Vec::with_capacity(size[0]),
                ends: Vec::with_capacity(size[0]),
            };
            for (union, crossings) in union.into_iter().zip(crossings) {
                let (union, solid) = (merged(union), inside(crossings));
                let both = shared(&union, &solid);
                result.missing += length(&solid) - both;
                result.excess += length(&union) - both;
                let gaps = union.windows(2).map(|pair| Gap {
                    span: (pair[0].1, pair[1].0),
                    closed: false,
                });
                result.gaps.push(gaps.collect());
                let ends = union.first().zip(union.last());
                result
                    .ends
                    .push(ends.map(|(first, last)| (first.0, last.1)));
            }
            result
        });
        let area = self.step * self.step;
        for row in rows {
            self.missing += row.missing * area;
            self.excess += row.excess * area;
            self.gaps.extend(row.gaps);
            self.ends.extend(row.ends);
        }
    }

    /// Finds the gaps without a way to the outside.
    fn label(&mut self) {
        let mut first = Vec::with_capacity(self.gaps.len() + 1);
        // Number 0 is the outside.
        let mut count = 1_u32;
        for gaps in &self.gaps {
            first.push(count);
            count += gaps.len() as u32;
        }
        let mut leader: Vec<u32> = (0..count).collect();
        for column in 0..self.gaps.len() {
            let size = self.grid.size;
            let (i, j) = (column % size[0], column / size[0]);
            let beside = [
                (i > 0).then(|| column - 1),
                (i + 1 < size[0]).then(|| column + 1),
                (j > 0).then(|| column - size[0]),
                (j + 1 < size[1]).then(|| column + size[0]),
            ];
            for (k, gap) in self.gaps[column].iter().enumerate() {
                let own = first[column] + k as u32;
                for other in beside {
                    let Some(other) = other else {
                        join(&mut leader, own, 0);
                        continue;
                    };
                    let mut open = self.open_ends(other).into_iter().flatten();
                    if open.any(|span| overlap(span, gap.span)) {
                        join(&mut leader, own, 0);
                    }
                    for (n, next) in self.gaps[other].iter().enumerate() {
                        if overlap(next.span, gap.span) {
                            join(&mut leader, own, first[other] + n as u32);
                        }
                    }
                }
            }
        }
        let mut rays = vec![0_u32; count as usize];
        for own in 1..count {
            rays[root(&mut leader, own) as usize] += 1;
        }
        let area = self.step * self.step;
        for (column, gaps) in self.gaps.iter_mut().enumerate() {
            for (k, gap) in gaps.iter_mut().enumerate() {
                let root = root(&mut leader, first[column] + k as u32);
                gap.closed = root != 0 && rays[root as usize] >= LEAST_RAYS;
                if gap.closed {
                    self.cavities += (gap.span.1 - gap.span.0) * area;
                }
            }
        }
    }

    /// Returns the two endless ends of a ray outside of the union. A ray that misses the union is one end.
    fn open_ends(&self, column: usize) -> [Option<Span>; 2] {
        self.ends[column].map_or(
            [Some((f64::NEG_INFINITY, f64::INFINITY)), None],
            |(from, to)| [Some((f64::NEG_INFINITY, from)), Some((to, f64::INFINITY))],
        )
    }
}

fn overlap(a: Span, b: Span) -> bool {
    fmax(a.0, b.0) < fmin(a.1, b.1)
}

fn root(leader: &mut [u32], mut k: u32) -> u32 {
    while leader[k as usize] != k {
        leader[k as usize] = leader[leader[k as usize] as usize];
        k = leader[k as usize];
    }
    k
}

/// Joins two groups. The smaller number leads, so the outside always does.
fn join(leader: &mut [u32], a: u32, b: u32) {
    let (a, b) = (root(leader, a), root(leader, b));
    leader[a.max(b) as usize] = a.min(b);
}

/// Returns the crossing of the ray through `(x, y)` with a triangle, and whether it enters (1) or leaves (-1).
fn crossing(
    mesh: &TriMesh,
    triangle: usize,
    [u, v, w]: [usize; 3],
    x: f64,
    y: f64,
) -> Option<(f64, i32)> {
    let index = mesh.triangles[triangle];
    let corners = mesh.corners(triangle);
    let mut weights = [0.0; 3];
    let mut left = 0;
    for (k, weight) in weights.iter_mut().enumerate() {
        // Edge opposite corner k. Both triangles of an edge compute it from the same end, so a ray through the edge
        // is in exactly one of them.
        let (a, b) = ((k + 1) % 3, (k + 2) % 3);
        let turned = index[a] > index[b];
        let (from, to) = if turned { (b, a) } else { (a, b) };
        let (p, q) = (&corners[from], &corners[to]);
        let side = (q[u] - p[u]) * (y - p[v]) - (q[v] - p[v]) * (x - p[u]);
        left += u32::from((side >= 0.0) != turned);
        *weight = if turned { -side } else { side };
    }
    let sum = weights[0] + weights[1] + weights[2];
    if !(left == 0 || left == 3) || sum == 0.0 {
        return None;
    }
    let at = (0..3).map(|k| weights[k] * corners[k][w]).sum::<f64>() / sum;
    // Counter-clockwise as seen from the far end of the rays: the outside is there.
    Some((at, if left == 3 { -1 } else { 1 }))
}

/// Returns the stretches inside a mesh with these crossings.
fn inside(mut crossings: Vec<(f64, i32)>) -> Vec<Span> {
    crossings.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut spans = Vec::new();
    let (mut winding, mut from) = (0, 0.0);
    for (at, turn) in crossings {
        if winding == 0 && turn > 0 {
            from = at;
        }
        if winding == 1 && turn < 0 {
            spans.push((from, at));
        }
        winding += turn;
    }
    spans
}

/// Returns the common length of two lists of stretches.
fn shared(a: &[Span], b: &[Span]) -> f64 {
    let (mut i, mut j, mut sum) = (0, 0, 0.0);
    while i < a.len() && j < b.len() {
        sum += fmax(fmin(a[i].1, b[j].1) - fmax(a[i].0, b[j].0), 0.0);
        if a[i].1 < b[j].1 {
            i += 1;
        } else {
            j += 1;
        }
    }
    sum
}
