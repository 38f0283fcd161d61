//! Share of the surroundings that a vertex sees, computed once for the scene at rest.
//!
//! The surfaces of all objects fill cells of a grid. Rays from a vertex over the hemisphere of its normal end in a filled
//! cell or at [`REACH_MM`]. A ray counts by the distance it gets, so that near surfaces darken most. Tools are left out.

use nalgebra::Vector3;

use crate::stage::{Moving, Part, Still};

/// Length of a ray, mm.
const REACH_MM: f32 = 10.0;
/// Edge of a cell and step of a ray, mm.
const CELL_MM: f32 = 0.5;
/// Distance of a ray's start from its surface, mm: out of the surface's own cells.
const START_MM: f32 = 0.9;
/// Number of steps within which a ray may leave the cells in which it begins.
const LEAVES: usize = 3;
/// Number of times that the shares are averaged with those of the neighbouring vertices.
const SMOOTHED: usize = 3;
/// Number of rays of a vertex.
const RAYS: usize = 48;
/// Largest number of cells along an edge of the grid.
const MOST: usize = 512;

type V = Vector3<f32>;

/// Writes the open share of every vertex of the parts into the last number of its finish.
pub(crate) fn bake(parts: &[Part], corners: &[u32], moving: &[Moving], still: &mut [Still]) {
    let Some(grid) = Grid::new(parts, corners, moving) else {
        return;
    };
    let (Some(first), Some(last)) = (parts.first(), parts.last()) else {
        return;
    };
    let all = first.vertices.start..last.vertices.end;
    let rays = rays();
    let workers = std::thread::available_parallelism().map_or(1, usize::from);
    let size = all.len().div_ceil(workers).max(1);
    std::thread::scope(|scope| {
        let places = moving[all.clone()].chunks(size);
        for (still, moving) in still[all].chunks_mut(size).zip(places) {
            let (grid, rays) = (&grid, &rays);
            scope.spawn(move || {
                for (still, moving) in still.iter_mut().zip(moving) {
                    let open = grid.open(&V::from(moving.at), &V::from(moving.normal), rays);
                    still.finish[3] = (open * 255.0).round() as u8;
                }
            });
        }
    });
}

/// Averages the open shares of neighbouring vertices: the cells of the grid would show as steps.
/// Vertices of one group lie in one place and keep one share.
pub(crate) fn smooth(corners: &[u32], groups: &[Vec<u32>], still: &mut [Still]) {
    for _ in 0..SMOOTHED {
        let mut sums: Vec<(u32, u32)> = still
            .iter()
            .map(|still| (2 * u32::from(still.finish[3]), 2))
            .collect();
        for triangle in corners.chunks_exact(3) {
            for k in 0..3 {
                let other = u32::from(still[triangle[(k + 1) % 3] as usize].finish[3]);
                let own = &mut sums[triangle[k] as usize];
                *own = (own.0 + other, own.1 + 1);
            }
        }
        for group in groups {
            let members = group.iter().map(|v| sums[*v as usize]);
            let whole = members.fold((0, 0), |(a, b), (sum, count)| (a + sum, b + count));
            for v in group {
                sums[*v as usize] = whole;
            }
        }
        for (still, (sum, count)) in still.iter_mut().zip(sums) {
            still.finish[3] = (sum / count.max(1)) as u8;
        }
    }
}

/// Directions over the hemisphere of z, with a density that falls with the cosine: a spiral of equal steps.
fn rays() -> [V; RAYS] {
    std::array::from_fn(|k| {
        let share = (k as f32 + 0.5) / RAYS as f32;
        let around = k as f32 * 2.399_963;
        let aside = share.sqrt();
        V::new(
            aside * around.cos(),
            aside * around.sin(),
            (1.0 - share).sqrt(),
        )
    })
}

/// Cells that a surface goes through.
struct Grid {
    low: V,
    count: [usize; 3],
    filled: Vec<bool>,
}

impl Grid {
    fn new(parts: &[Part], corners: &[u32], moving: &[Moving]) -> Option<Self> {
        let place = |v: u32| V::from(moving[v as usize].at);
        let used = || parts.iter().flat_map(|part| &corners[part.corners.clone()]);
        let first = place(*used().next()?);
        let (low, high) = used().fold((first, first), |(low, high), v| {
            (low.inf(&place(*v)), high.sup(&place(*v)))
        });
        // Half a cell more: the outermost surfaces lie in the middle of their cells, and both sides of a gap agree.
        let low = low - V::repeat(1.5 * CELL_MM);
        let size = high - low;
        let count: [usize; 3] = std::array::from_fn(|k| (size[k] / CELL_MM) as usize + 3);
        if count.iter().any(|n| *n > MOST) {
            // A scene larger than a head has no mouth to darken.
            return None;
        }
        let mut grid = Self {
            low,
            count,
            filled: vec![false; count.iter().product()],
        };
        for part in parts {
            for triangle in corners[part.corners.clone()].chunks_exact(3) {
                grid.fill([0, 1, 2].map(|k| place(triangle[k])));
            }
        }
        Some(grid)
    }

    /// Fills the cells of points that lie closer on a triangle than a cell's edge.
    fn fill(&mut self, [a, b, c]: [V; 3]) {
        let longest = (b - a).norm().max((c - a).norm()).max((c - b).norm());
        let steps = (longest / (0.7 * CELL_MM)).ceil().max(1.0);
        for i in 0..=steps as usize {
            for j in 0..=steps as usize - i {
                let (u, v) = (i as f32 / steps, j as f32 / steps);
                if let Some(cell) = self.cell(&(a + (b - a) * u + (c - a) * v)) {
                    self.filled[cell] = true;
                }
            }
        }
    }

    fn cell(&self, at: &V) -> Option<usize> {
        let place = (at - self.low) / CELL_MM;
        let inside = (0..3).all(|k| place[k] >= 0.0 && place[k] < self.count[k] as f32);
        let [x, y, z] = [0, 1, 2].map(|k| place[k] as usize);
        inside.then(|| (z * self.count[1] + y) * self.count[0] + x)
    }

    /// Mean share of the rays' length that is free.
    fn open(&self, at: &V, normal: &V, rays: &[V]) -> f32 {
        let aside = if normal.x.abs() < 0.9 { V::x() } else { V::y() };
        let u = normal.cross(&aside).normalize();
        let v = normal.cross(&u);
        let steps = (REACH_MM / CELL_MM) as usize;
        let free = |ray: &V| {
            let along = u * ray.x + v * ray.y + normal * ray.z;
            let start = at + normal * START_MM;
            let is_filled = |k: &usize| {
                let cell = self.cell(&(start + along * (*k as f32 * CELL_MM)));
                cell.is_some_and(|cell| self.filled[cell])
            };
            // Beside a margin a ray begins in the cells of the other surface. A fringe of cells would be black.
            let begin = (0..LEAVES).find(|k| !is_filled(k)).unwrap_or(0);
            let hit = (begin..steps).find(is_filled);
            hit.map_or(1.0, |k| k as f32 / steps as f32)
        };
        rays.iter().map(free).sum::<f32>() / rays.len() as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::Material;
    use crate::stage::Owner;

    /// Open shares of the middles of two parallel squares of 20 mm, `gap` mm apart, that face each other.
    fn between(gap: f32) -> [u8; 2] {
        let square = |z: f32, up: bool| {
            let at = [
                [-10.0, -10.0],
                [10.0, -10.0],
                [10.0, 10.0],
                [-10.0, 10.0],
                [0.0, 0.0],
            ];
            at.map(|[x, y]| Moving {
                at: [x, y, z],
                normal: [0.0, 0.0, if up { 1.0 } else { -1.0 }],
                blood: 0.0,
            })
        };
        let moving: Vec<Moving> = square(0.0, true)
            .into_iter()
            .chain(square(gap, false))
            .collect();
        let fan = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
        let corners: Vec<u32> = [0, 5]
            .iter()
            .flat_map(|first| fan.iter().flatten().map(move |v| v + first))
            .collect();
        let part = |k: usize| Part {
            owner: Owner::Object(k as u16),
            material: Material::Flesh,
            vertices: 5 * k..5 * k + 5,
            corners: 12 * k..12 * k + 12,
        };
        let mut still = vec![Still::default(); 10];
        bake(&[part(0), part(1)], &corners, &moving, &mut still);
        [still[4].finish[3], still[9].finish[3]]
    }

    #[test]
    fn a_gap_darkens_both_sides_by_its_width_and_open_ground_is_open() {
        let [below, above] = between(3.0);
        assert!(below.abs_diff(above) < 12, "{below} {above}");
        // Rays over the whole hemisphere with a mean slant of 1.5 get (3 - 0.9) * 1.5 of 10 mm, and the widest leave.
        assert!((50..130).contains(&below), "{below}");
        let [wide, _] = between(7.0);
        assert!(wide > below + 40, "{wide} {below}");
        assert!(between(40.0)[0] > 250);
    }
}
