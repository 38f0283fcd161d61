//! The body-centred cubic lattice around a surface: its nodes, crossings of its edges, nodes that move onto the
//! surface.
//!
//! A node has whole coordinates in halves of a cube's edge, all even (corners of cubes) or all odd (their middles).

use std::collections::BTreeSet;

use sulcus_core::Vec3;

use super::error::TetraError;
use super::stencil::{Side, fill};
use crate::mesh::distance::MeshDistance;
use crate::parallel;

/// Largest number of nodes of the lattice around the surface. There are six tetrahedra for each inner node.
pub const MOST_NODES: f64 = 2e6;

/// Shares of a long and of a short edge within which a cut point moves the node onto it.
///
/// Over all cuts of the test below, the angles are 10.5 to 163.8 degrees with these. They are 9.3 to 161.7 with 0.25
/// and 0.412, 8.0 to 160.6 with 0.25 and 0.36, 10.6 to 164.7 with 0.285 and 0.395.
const NEAR: [f64; 2] = [0.28, 0.40];
/// Tolerance of a cut point's distance to the surface, in edges.
const FOUND: f64 = 1e-9;
/// Largest number of steps to a cut point. Every third step halves the interval, so the last is below [`FOUND`].
const STEPS: usize = 120;
/// Edge of the blocks that are tested as a whole, in halves of a cube's edge.
const BLOCK: usize = 8;
/// Half of the 14 edges at a node: three long ones, four short ones.
const EDGES: [[i32; 3]; 7] = [
    [2, 0, 0],
    [0, 2, 0],
    [0, 0, 2],
    [1, 1, 1],
    [1, 1, -1],
    [1, -1, 1],
    [1, -1, -1],
];

/// Vertices (metres) and tetrahedra. The nodes of the lattice come first, then cut points.
pub type Filled = (Vec<Vec3>, Vec<[u32; 4]>);

/// Place of the lattice.
pub struct Lattice {
    low: Vec3,
    half: f64,
    cubes: [usize; 3],
}

/// Samples of the surface at the lattice.
pub struct Sampled {
    /// Side of each node: inside (1) or outside (-1).
    sides: Vec<Side>,
    /// The edges that cross, each as its two nodes, sorted.
    ends: Vec<[u32; 2]>,
    /// Places of the crossings, metres.
    cuts: Vec<Vec3>,
}

impl Lattice {
    /// Returns the lattice around a box, with the same middle.
    pub fn around(low: Vec3, high: Vec3, size: f64) -> Result<Self, TetraError> {
        // Each side has an additional cube, because the outermost half cubes are not filled.
        let wanted = (high - low).map(|length| (length / size).ceil() + 2.0);
        let nodes = 2.0 * wanted.map(|n| n + 1.0).product();
        if nodes.is_nan() || nodes > MOST_NODES {
            let found = format!("{} mm, which makes {nodes:.2e} nodes", size * 1e3);
            let expected = format!("a length that makes at most {MOST_NODES:.0e} nodes");
            return Err(TetraError::field("size", found, expected));
        }
        Ok(Self {
            low: (low + high - wanted * size) * 0.5,
            half: 0.5 * size,
            cubes: [0, 1, 2].map(|axis| wanted[axis] as usize),
        })
    }

    fn corners(&self) -> usize {
        self.cubes.iter().map(|n| n + 1).product()
    }

    fn nodes(&self) -> usize {
        self.corners() + self.cubes.iter().product::<usize>()
    }

    /// Returns the index of a node, if it exists.
    fn index(&self, at: [i32; 3]) -> Option<usize> {
        let odd = at[0] & 1;
        let (mut index, mut known) = (0, true);
        for (x, cubes) in at.into_iter().zip(self.cubes) {
            let along = cubes + usize::from(odd == 0);
            known &= x >= 0 && x & 1 == odd && ((x / 2) as usize) < along;
            index = index * along + (x / 2) as usize;
        }
        known.then(|| index + if odd == 0 { 0 } else { self.corners() })
    }

    /// Returns the coordinates of a node.
    fn at(&self, node: usize) -> [i32; 3] {
        let odd = node >= self.corners();
        let mut rest = if odd { node - self.corners() } else { node };
        let mut at = [0; 3];
        for axis in [2, 1, 0] {
            let along = self.cubes[axis] + usize::from(!odd);
            at[axis] = 2 * (rest % along) as i32 + i32::from(odd);
            rest /= along;
        }
        at
    }

    fn place(&self, at: [i32; 3]) -> Vec3 {
        self.low + Vec3::from(at.map(f64::from)) * self.half
    }

    /// Samples the surface.
    pub fn sample(
        &self,
        threads: usize,
        surface: &MeshDistance,
        progress: &dyn Fn(f64),
    ) -> Sampled {
        let distances = self.distances(threads, surface, &|share| progress(0.8 * share));
        // A node on the surface counts as outside, and is its own cut point.
        let sides: Vec<Side> = distances
            .iter()
            .map(|d| if *d < 0.0 { 1 } else { -1 })
            .collect();
        let ends = self.crossed(&sides);
        let cuts = parallel::map_on(threads, ends.len(), |k| {
            let of = |node: u32| (self.place(self.at(node as usize)), distances[node as usize]);
            crossing(surface, of(ends[k][0]), of(ends[k][1]), FOUND * self.half)
        });
        progress(1.0);
        Sampled { sides, ends, cuts }
    }

    /// Returns the tetrahedra inside. Nodes in `fixed` are not moved onto the surface.
    ///
    /// The order of vertices decides how faces are split: cut points of long edges, nodes of even parity, nodes of
    /// odd parity, cut points of short edges.
    ///
    /// - A face that is cut through its long edge is split from there.
    /// - A face that is cut through both short edges is split from the even end of its long edge. Each long edge has
    ///   one, so all tetrahedra around the edge agree: the paper's parity rule.
    ///
    /// With 0.25 and 0.412 for [`NEAR`] the smallest angle is 9.3 degrees. In the order of the nodes' indices it
    /// would be 4.1 degrees.
    pub fn fill(&self, sampled: &Sampled, fixed: &BTreeSet<u32>) -> Filled {
        let (places, sides) = self.warp(sampled, fixed);
        let nodes = self.nodes() as u32;
        let rank = |vertex: u32| {
            let class = match vertex.checked_sub(nodes) {
                Some(cut) => 3 * u64::from(!self.is_long(sampled.ends[cut as usize])),
                None => {
                    let at = self.at(vertex as usize);
                    1 + ((at.iter().sum::<i32>() >> 1) & 1) as u64
                }
            };
            (class << 32) | u64::from(vertex)
        };
        let cut = |a: u32, b: u32| nodes + sampled.cut(a, b);
        let mut tets = Vec::new();
        for middle in self.corners()..self.nodes() {
            for corners in self.tets_from(middle) {
                let sides = corners.map(|k| sides[k as usize]);
                fill(corners, sides, cut, rank, &places, &mut tets);
            }
        }
        (places, tets)
    }

    /// Returns the tetrahedra between the middle of a cube and those of the next cubes along the three axes.
    fn tets_from(&self, middle: usize) -> impl Iterator<Item = [u32; 4]> {
        let at = self.at(middle);
        let node = move |step: [i32; 3]| {
            let at = [0, 1, 2].map(|axis| at[axis] + step[axis]);
            self.index(at).map(|index| index as u32)
        };
        // The face between the cubes, anticlockwise as seen along the axis.
        let around = [[1, 1], [-1, 1], [-1, -1], [1, -1]];
        (0..3).flat_map(move |axis| {
            let towards = move |along: i32, [b, c]: [i32; 2]| {
                let mut step = [0; 3];
                step[axis] = along;
                step[(axis + 1) % 3] = b;
                step[(axis + 2) % 3] = c;
                step
            };
            (0..4).filter_map(move |k| {
                let next = node(towards(2, [0, 0]))?;
                let (from, to) = (around[k], around[(k + 1) % 4]);
                Some([
                    middle as u32,
                    next,
                    node(towards(1, from))?,
                    node(towards(1, to))?,
                ])
            })
        })
    }

    /// Returns the signed distance of every node: exact near the surface, elsewhere a smaller one with the right
    /// sign.
    fn distances(
        &self,
        threads: usize,
        surface: &MeshDistance,
        progress: &dyn Fn(f64),
    ) -> Vec<f64> {
        let blocks = self.cubes.map(|n| 2 * n / BLOCK + 1);
        let count: usize = blocks.iter().product();
        let half_way = 0.5 * (BLOCK - 1) as f64;
        let reach = half_way * 3.0_f64.sqrt() * self.half;
        let of_block = |block: usize| {
            let first = [
                block / (blocks[1] * blocks[2]),
                block / blocks[2] % blocks[1],
                block % blocks[2],
            ]
            .map(|k| (k * BLOCK) as i32);
            let whole = surface.signed(&(self.place(first) + Vec3::repeat(half_way * self.half)));
            // The ends of an edge that crosses are nearer to the surface than the edge's length.
            let far = whole.abs() - reach > 2.0 * self.half;
            let mut found = Vec::new();
            for k in 0..BLOCK * BLOCK * BLOCK {
                let step = [k / (BLOCK * BLOCK), k / BLOCK % BLOCK, k % BLOCK];
                let at = [0, 1, 2].map(|axis| first[axis] + step[axis] as i32);
                if let Some(node) = self.index(at) {
                    let exact = || surface.signed(&self.place(at));
                    let distance = if far {
                        whole - reach.copysign(whole)
                    } else {
                        exact()
                    };
                    found.push((node, distance));
                }
            }
            found
        };
        let mut distances = vec![f64::INFINITY; self.nodes()];
        let batch = count.div_ceil(20).max(1);
        for start in (0..count).step_by(batch) {
            let blocks = batch.min(count - start);
            for (node, distance) in parallel::map_on(threads, blocks, |k| of_block(start + k))
                .into_iter()
                .flatten()
            {
                distances[node] = distance;
            }
            progress((start + blocks) as f64 / count as f64);
        }
        distances
    }

    fn is_long(&self, ends: [u32; 2]) -> bool {
        let corners = self.corners() as u32;
        (ends[0] < corners) == (ends[1] < corners)
    }

    /// Returns the edges from inside to outside.
    fn crossed(&self, sides: &[Side]) -> Vec<[u32; 2]> {
        let mut ends = Vec::new();
        for (a, side) in sides.iter().enumerate() {
            let at = self.at(a);
            for step in EDGES {
                let next = self.index([0, 1, 2].map(|axis| at[axis] + step[axis]));
                if let Some(b) = next
                    && side * sides[b] < 0
                {
                    ends.push([a.min(b) as u32, a.max(b) as u32]);
                }
            }
        }
        ends.sort_unstable();
        ends
    }

    /// Returns the places of all nodes and cut points, and the sides of the nodes, 0 on the surface.
    ///
    /// Nodes too near to a cut point are moved onto it, one after the other, each to the nearest. The cut points of
    /// all its edges then disappear. Near `fixed` nodes the cut points are moved instead, along their edges.
    fn warp(&self, sampled: &Sampled, fixed: &BTreeSet<u32>) -> (Vec<Vec3>, Vec<Side>) {
        let mut at_nodes: Vec<(u32, u32)> = Vec::with_capacity(2 * sampled.ends.len());
        for (cut, ends) in sampled.ends.iter().enumerate() {
            at_nodes.extend(ends.map(|node| (node, cut as u32)));
        }
        at_nodes.sort_unstable();
        let (nodes, mut sides) = (self.nodes(), sampled.sides.clone());
        let mut places: Vec<Vec3> = (0..nodes).map(|k| self.place(self.at(k))).collect();
        places.extend(&sampled.cuts);
        let lengths = [2.0 * self.half, 3.0_f64.sqrt() * self.half];
        for of_node in at_nodes.chunk_by(|a, b| a.0 == b.0) {
            let node = of_node[0].0;
            let from = places[node as usize];
            let mut nearest = (f64::INFINITY, from);
            for &(_, cut) in of_node {
                let ends = sampled.ends[cut as usize];
                if ends.iter().any(|&end| sides[end as usize] == 0) {
                    continue;
                }
                let kind = usize::from(!self.is_long(ends));
                let cut = nodes + cut as usize;
                let away = (places[cut] - from).norm();
                let too_near = away < NEAR[kind] * lengths[kind];
                if too_near && fixed.contains(&node) {
                    let other = if ends[0] == node { ends[1] } else { ends[0] };
                    let along = self.place(self.at(other as usize)) - from;
                    places[cut] = from + along * NEAR[kind];
                } else if too_near && away < nearest.0 {
                    nearest = (away, places[cut]);
                }
            }
            if nearest.0 < f64::INFINITY {
                places[node as usize] = nearest.1;
                sides[node as usize] = 0;
            }
        }
        (places, sides)
    }
}

impl Sampled {
    /// Returns the index of the cut between a node inside and a node outside.
    fn cut(&self, a: u32, b: u32) -> u32 {
        let found = self.ends.binary_search(&[a.min(b), a.max(b)]);
        found.unwrap_or_else(|next| next) as u32
    }
}

/// Returns the crossing of the surface with the line between two places on either side.
///
/// The method is false position with the weights of Dowell and Jarratt's Illinois rule (1971,
/// doi:10.1007/BF01934364). Every third step is a bisection.
fn crossing(surface: &MeshDistance, a: (Vec3, f64), b: (Vec3, f64), near: f64) -> Vec3 {
    let ((from, mut fa), (to, mut fb)) = (a, b);
    let (mut ta, mut tb) = (0.0, 1.0);
    let mut best = if fa.abs() < fb.abs() {
        (fa.abs(), from)
    } else {
        (fb.abs(), to)
    };
    for step in 0..STEPS {
        let t = match step % 3 {
            2 => 0.5 * (ta + tb),
            _ => ta + (tb - ta) * fa / (fa - fb),
        };
        let place = from + (to - from) * t;
        let d = surface.signed(&place);
        if d.abs() < best.0 {
            best = (d.abs(), place);
        }
        if best.0 <= near {
            break;
        }
        if d * fb < 0.0 {
            (ta, fa) = (tb, fb);
        } else {
            fa *= 0.5;
        }
        (tb, fb) = (t, d);
    }
    best.1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::organ::tetrahedra::stencil::{dihedral_cosines, six_volumes};
    use crate::random::Random;

    /// The paper's theorem, on every possible cut of a tetrahedron: random sides, cut points anywhere on their edges.
    ///
    /// Most cut points lie where nodes just move or just stay.
    #[test]
    fn no_cut_turns_a_tetrahedron_inside_out_or_makes_it_flat() {
        let lattice = Lattice {
            low: Vec3::zeros(),
            half: 1.0,
            cubes: [20; 3],
        };
        let mut random = Random::new(5);
        let (mut least, mut most, mut count) = (180.0_f64, 0.0_f64, 0);
        for inside in [0.2, 0.5, 0.5, 0.5, 0.5, 0.8, 0.97] {
            let sides: Vec<Side> = (0..lattice.nodes())
                .map(|_| if random.unit() < inside { 1 } else { -1 })
                .collect();
            let ends = lattice.crossed(&sides);
            let cuts = ends.iter().map(|&ends| {
                let near = NEAR[usize::from(!lattice.is_long(ends))];
                let share = match random.between(0.0, 7.0) as u32 {
                    0 => random.unit(),
                    1 => near * 0.999_999,
                    2 => near * 1.000_001,
                    3 => 1.0 - near * 1.000_001,
                    4 => 1.0 - near * 0.999_999,
                    5 => 0.5,
                    _ => 0.0,
                };
                let [a, b] = ends.map(|node| lattice.place(lattice.at(node as usize)));
                a + (b - a) * share
            });
            let cuts = cuts.collect();
            let fixed = (0..lattice.nodes() as u32).filter(|_| random.unit() < 0.1);
            let fixed = fixed.collect();
            let (places, tets) = lattice.fill(&Sampled { sides, ends, cuts }, &fixed);
            for tet in &tets {
                let corners = tet.map(|k| places[k as usize]);
                assert!(six_volumes(&corners) > 0.0, "{corners:?}");
                for cosine in dihedral_cosines(&corners) {
                    let angle = libm::acos(cosine).to_degrees();
                    least = least.min(angle);
                    most = most.max(angle);
                }
            }
            count += tets.len();
        }
        println!("{count} tetrahedra, angles {least:.2} to {most:.2} degrees");
        assert!(count > 100_000, "{count}");
        assert!(least > 10.5 && most < 163.8, "{least} {most}");
    }
}
