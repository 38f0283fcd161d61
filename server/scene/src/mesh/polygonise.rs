//! Closed mesh of an implicit function: naive surface nets (Gibson 1998) on a regular grid.
//!
//! Every vertex is then moved onto the zero set along the gradient.

use sulcus_core::Vec3;

use crate::mesh::TriMesh;

/// Meshes `{f = 0}` inside the box `low..high` with grid edge `cell`, in any unit of length.
///
/// `f` must be negative inside, and positive on the whole border of the box.
pub fn polygonise(f: &(dyn Fn(&Vec3) -> f64 + Sync), low: Vec3, high: Vec3, cell: f64) -> TriMesh {
    let grid = Grid::new(low, high, cell);
    let values = grid.values(f);
    mesh(f, &grid, &values)
}

/// Meshes `{f = 0}` as [`polygonise`] does, bit for bit, with fewer evaluations. `f` changes over a length by less than
/// twice this length, as a rough signed distance does.
pub(crate) fn polygonise_distance(
    f: &(dyn Fn(&Vec3) -> f64 + Sync),
    low: Vec3,
    high: Vec3,
    cell: f64,
) -> TriMesh {
    let grid = Grid::new(low, high, cell);
    let values = grid.values_near(f);
    mesh(f, &grid, &values)
}

/// Regular grid.
struct Grid {
    low: Vec3,
    cell: f64,
    n: [usize; 3],
}

impl Grid {
    fn new(low: Vec3, high: Vec3, cell: f64) -> Self {
        let n = std::array::from_fn(|axis| ((high[axis] - low[axis]) / cell).ceil() as usize + 1);
        Self { low, cell, n }
    }

    fn place(&self, i: usize, j: usize, k: usize) -> Vec3 {
        self.low + Vec3::new(i as f64, j as f64, k as f64) * self.cell
    }

    /// Values at all points.
    fn values(&self, f: &(dyn Fn(&Vec3) -> f64 + Sync)) -> Vec<f64> {
        self.slices(&|i, j, k| f(&self.place(i, j, k)))
    }

    /// Slices of the grid, each a work item; the order of results does not depend on threads.
    fn slices(&self, value: &(dyn Fn(usize, usize, usize) -> f64 + Sync)) -> Vec<f64> {
        let [n, m, _] = self.n;
        let slice = |k: usize| -> Vec<f64> {
            let points = (0..m).flat_map(|j| (0..n).map(move |i| (i, j)));
            points.map(|(i, j)| value(i, j, k)).collect()
        };
        crate::parallel::map(self.n[2], slice).concat()
    }

    /// Values at the points near the surface. Other points have a value of the right sign: that of a point nearby with
    /// even numbers.
    fn values_near(&self, f: &(dyn Fn(&Vec3) -> f64 + Sync)) -> Vec<f64> {
        let coarse = Self {
            low: self.low,
            cell: 2.0 * self.cell,
            n: self.n.map(|n| n.div_ceil(2)),
        };
        let even = coarse.slices(&|i, j, k| f(&self.place(2 * i, 2 * j, 2 * k)));
        let at = |i: usize, j: usize, k: usize| even[i + (j + k * coarse.n[1]) * coarse.n[0]];
        // The middle of eight points lies farthest from them: by the root of 3 cells.
        let near = 2.0 * 3f64.sqrt() * self.cell;
        self.slices(&|i, j, k| {
            let [a, b, c] = [i / 2, j / 2, k / 2];
            let own = at(a, b, c);
            if [i, j, k].iter().all(|i| i % 2 == 0) {
                return own;
            }
            let ends = [[a, i], [b, j], [c, k]].map(|[a, i]| a + i % 2);
            let is_inner = (0..3).all(|axis| ends[axis] < coarse.n[axis]);
            let is_far = is_inner
                && (0..8).all(|corner| {
                    let [x, y, z] = [[a, ends[0]], [b, ends[1]], [c, ends[2]]];
                    let there = at(x[corner & 1], y[corner >> 1 & 1], z[corner >> 2]);
                    there.abs() > near && (there < 0.0) == (own < 0.0)
                });
            if is_far { own } else { f(&self.place(i, j, k)) }
        })
    }
}

fn mesh(f: &(dyn Fn(&Vec3) -> f64 + Sync), grid: &Grid, values: &[f64]) -> TriMesh {
    let (n, cell) = (grid.n, grid.cell);
    let stride = [1, n[0], n[0] * n[1]];
    let at = |i: usize, j: usize, k: usize| i + j * stride[1] + k * stride[2];
    let place = |i: usize, j: usize, k: usize| grid.place(i, j, k);
    let mut mesh = TriMesh::default();
    let mut vertex_of = vec![u32::MAX; values.len()];
    for k in 0..n[2] - 1 {
        for j in 0..n[1] - 1 {
            for i in 0..n[0] - 1 {
                if let Some(inner) = cell_vertex(values, at(i, j, k), &stride) {
                    vertex_of[at(i, j, k)] = mesh.vertices.len() as u32;
                    mesh.vertices.push(place(i, j, k) + inner * cell);
                }
            }
        }
    }
    mesh.vertices =
        crate::parallel::map(mesh.vertices.len(), |v| project(f, mesh.vertices[v], cell));
    for k in 1..n[2] - 1 {
        for j in 1..n[1] - 1 {
            for i in 1..n[0] - 1 {
                let here = at(i, j, k);
                for axis in 0..3 {
                    let inside = values[here] < 0.0;
                    if inside == (values[here + stride[axis]] < 0.0) {
                        continue;
                    }
                    // The four cells around this grid edge, counter-clockwise about the axis.
                    let (u, v) = (stride[(axis + 1) % 3], stride[(axis + 2) % 3]);
                    let mut quad = [here - u - v, here - v, here, here - u].map(|c| vertex_of[c]);
                    if !inside {
                        quad.reverse();
                    }
                    add_quad(&mut mesh, quad);
                }
            }
        }
    }
    mesh
}

/// Returns the mean of the crossings on the edges of a cell, in cell coordinates; `None` without a crossing.
fn cell_vertex(values: &[f64], corner: usize, stride: &[usize; 3]) -> Option<Vec3> {
    let offset =
        |c: usize| (c & 1) * stride[0] + (c >> 1 & 1) * stride[1] + (c >> 2 & 1) * stride[2];
    let (mut sum, mut count) = (Vec3::zeros(), 0_u32);
    for from in 0..8_usize {
        for axis in (0..3).filter(|axis| from & (1 << axis) == 0) {
            let to = from | (1 << axis);
            let (a, b) = (values[corner + offset(from)], values[corner + offset(to)]);
            if (a < 0.0) != (b < 0.0) {
                let mut crossing = Vec3::from_fn(|row, _| (from >> row & 1) as f64);
                crossing[axis] = a / (a - b);
                sum += crossing;
                count += 1;
            }
        }
    }
    (count > 0).then(|| sum / f64::from(count))
}

/// Newton steps onto the zero set, each at most half a cell.
fn project(f: &dyn Fn(&Vec3) -> f64, start: Vec3, cell: f64) -> Vec3 {
    let step = cell * 1e-3;
    let mut p = start;
    for _ in 0..4 {
        let slope = Vec3::from_fn(|axis, _| {
            let mut shift = Vec3::zeros();
            shift[axis] = step;
            (f(&(p + shift)) - f(&(p - shift))) / (2.0 * step)
        });
        let steepness = slope.norm_squared();
        if steepness < 1e-6 {
            break;
        }
        let mut newton = slope * (-f(&p) / steepness);
        let length = newton.norm();
        if length > 0.25 * cell {
            newton *= 0.25 * cell / length;
        }
        p += newton;
    }
    // Outside of its own neighbourhood a vertex would fold the mesh.
    if (p - start).norm() > 0.6 * cell {
        start
    } else {
        p
    }
}

/// Adds two triangles, cut along the shorter diagonal.
fn add_quad(mesh: &mut TriMesh, quad: [u32; 4]) {
    let [a, b, c, d] = quad;
    let p = quad.map(|v| mesh.vertices[v as usize]);
    if (p[0] - p[2]).norm_squared() <= (p[1] - p[3]).norm_squared() {
        mesh.triangles.extend([[a, b, c], [a, c, d]]);
    } else {
        mesh.triangles.extend([[a, b, d], [b, c, d]]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ball_and_a_ring_come_out_closed_outward_and_in_place() {
        let ball = |p: &Vec3| p.norm() - 0.005;
        let mesh = polygonise(&ball, Vec3::repeat(-0.006), Vec3::repeat(0.006), 0.0004);
        let report = crate::mesh::check::check(&mesh, "ball").expect("closed");
        assert_eq!(report.genus, 0);
        assert!(mesh.vertices.iter().all(|v| ball(v).abs() < 1e-9));
        let ring = |p: &Vec3| ((p.x * p.x + p.y * p.y).sqrt() - 0.004).hypot(p.z) - 0.0015;
        let mesh = polygonise(&ring, Vec3::repeat(-0.006), Vec3::repeat(0.006), 0.0004);
        assert_eq!(
            crate::mesh::check::check(&mesh, "ring")
                .expect("closed")
                .genus,
            1
        );
    }

    #[test]
    fn teeth_have_the_same_bits_with_fewer_evaluations() {
        use std::sync::atomic::{AtomicUsize, Ordering};
        for fdi in [31, 34, 37] {
            let tooth = crate::anatomy::Tooth::lower(fdi).expect("a tooth");
            let count = AtomicUsize::new(0);
            let inside = |p: &Vec3| {
                count.fetch_add(1, Ordering::Relaxed);
                tooth.distance(p)
            };
            let (low, high, cell) = (Vec3::new(-8.0, -8.0, -16.0), Vec3::new(8.0, 8.0, 10.0), 0.3);
            let whole = polygonise(&inside, low, high, cell);
            let all = count.swap(0, Ordering::Relaxed);
            assert_eq!(
                polygonise_distance(&inside, low, high, cell),
                whole,
                "tooth {fdi}"
            );
            let few = count.load(Ordering::Relaxed);
            assert!(4 * few < 3 * all, "{few} of {all} evaluations");
        }
    }
}
