//! One level of a skeleton made ready: step, compliance, displacement of what it carries.

use crate::TICK_S;
use crate::math::{Vec3, fmax, norm};
use crate::tissue::{Gram, Site};
use crate::tree::SphereTree;

use super::data::{CARRIERS, SkeletonLevel, StretchLaw};
use super::factor::{Axes, Factor, Matrix, add_product, elimination_order, subtract_product};

/// A spring between two free nodes, or one and a fixed one (which then has the number of free nodes).
#[derive(Clone, Copy, Debug)]
struct Bond {
    a: u32,
    b: u32,
    /// At rest, N/m.
    stiffness: Axes,
    /// Weight of the squared change of each axis in the square of the stretch over `half`, 1/m2.
    stretch: Axes,
}

/// Free nodes that carry a sphere; a fixed one keeps its place with weight zero.
#[derive(Clone, Copy, Debug)]
struct Carrier {
    nodes: [u16; CARRIERS],
    weights: [f64; CARRIERS],
}

/// A level made ready. Free nodes are numbered in the order of elimination.
#[derive(Debug)]
pub(super) struct Lattice {
    free: usize,
    bonds: Vec<Bond>,
    law: StretchLaw,
    mass: f64,
    damping: f64,
    factor: Factor,
    /// `A^-1`, row by row: how far each node goes for a unit load on one in this tick, m/N.
    inverse: Vec<Axes>,
    /// For each node of the tree.
    carriers: Vec<Carrier>,
    /// Node of the tree that each free node is.
    tree_nodes: Vec<u32>,
    /// Displacements with a zero for what is fixed at the end, and forces likewise.
    padded: Vec<Axes>,
    forces: Vec<Axes>,
    loads: Loads,
}

/// Scratch of rows and loads.
#[derive(Debug)]
struct Loads {
    /// Free nodes that carry a touched sphere, and for each free node its place in that list.
    touched: Vec<u16>,
    places: Vec<u16>,
    /// Compliance of one sphere to each touched node, or force on each touched node.
    column: Vec<Axes>,
    /// Runs of rows on one sphere.
    runs: Vec<(u32, u32)>,
}

const NOWHERE: u16 = u16::MAX;
/// Rows that one tissue can have in a problem.
const MOST_SITES: usize = 2048;

impl Lattice {
    /// `level` must have passed its check against `rest`.
    pub fn new(level: &SkeletonLevel, rest: &SphereTree) -> Self {
        let free = level.free();
        // First numbered as they come, then in the order of elimination.
        let movable: Vec<usize> = (0..level.nodes.len())
            .filter(|&k| !level.fixed[k])
            .collect();
        let mut number = vec![usize::MAX; level.nodes.len()];
        for (new, &old) in movable.iter().enumerate() {
            number[old] = new;
        }
        let edges = level.springs.iter().filter_map(|spring| {
            let (a, b) = (number[usize::from(spring.a)], number[usize::from(spring.b)]);
            (a < free && b < free).then_some((a, b))
        });
        let order = elimination_order(free, edges);
        let mut number = vec![free; level.nodes.len()];
        for (new, &old) in order.iter().enumerate() {
            number[movable[old]] = new;
        }
        let (params, law) = (&level.params, level.params.law);
        let bonds: Vec<Bond> = level
            .springs
            .iter()
            .map(|spring| {
                let [x, y, z] = spring.stiffness;
                let at_half = norm(&level.reach(spring, rest)) * law.half;
                let unit = 3.0 / ((x + y + z) * at_half * at_half);
                Bond {
                    a: number[usize::from(spring.a)] as u32,
                    b: number[usize::from(spring.b)] as u32,
                    stiffness: [x, y, z, 0.0],
                    stretch: [x * unit, y * unit, z * unit, 0.0],
                }
            })
            .collect();
        let mut matrix = stiffness(&bonds, free, law.steepest());
        let own = params.mass / (TICK_S * TICK_S) + params.damping / TICK_S;
        for i in 0..free {
            matrix.at(i, i)[..3].iter_mut().for_each(|x| *x += own);
        }
        let factor = Factor::new(matrix);
        let inverse = factor.inverse();
        let carriers = level.skin.iter().map(|skin| {
            let mut carrier = Carrier {
                nodes: [0; CARRIERS],
                weights: [0.0; CARRIERS],
            };
            for k in 0..CARRIERS {
                let node = number[usize::from(skin.nodes[k])];
                if node < free {
                    carrier.nodes[k] = node as u16;
                    carrier.weights[k] = skin.weights[k];
                }
            }
            carrier
        });
        Self {
            free,
            law,
            mass: params.mass,
            damping: params.damping,
            factor,
            inverse,
            carriers: carriers.collect(),
            tree_nodes: order.iter().map(|&k| level.nodes[movable[k]]).collect(),
            padded: vec![[0.0; 4]; free + 1],
            forces: vec![[0.0; 4]; free + 1],
            loads: Loads {
                touched: Vec::with_capacity(free),
                places: vec![NOWHERE; free],
                column: vec![[0.0; 4]; free],
                runs: Vec::with_capacity(MOST_SITES),
            },
            bonds,
        }
    }

    /// Numbers in a configuration: four for each free node, the last of them zero.
    pub fn shape_len(&self) -> usize {
        4 * self.free
    }

    /// Nodes that can move.
    pub fn free(&self) -> usize {
        self.free
    }

    /// Nodes of the tree that the free nodes are.
    pub fn tree_nodes(&self) -> &[u32] {
        &self.tree_nodes
    }

    /// Where the nodes would be at the end of the tick without contact: implicit Euler,
    /// `(M/dt2 + B/dt + K) u0 = M/dt2 (u + dt v) + B/dt u + r`, with the stiffest `K` of the law in the matrix and
    /// `r` its excess over the present one at the present displacement.
    ///
    /// The stiffest `K` is a bound on the elastic energy's curvature, so the sum of kinetic and elastic energy
    /// never grows in a free step, whatever the stretch: over a step `d`, the elastic energy grows by at most
    /// `f(u).d + d'Kd/2` and the kinetic one by at most `-f(u).d - d'Kd - d'Bd/dt`.
    pub fn free_step(&mut self, u: &[Axes], v: &[Axes], free: &mut [Axes]) {
        let (of_u, of_v) = (
            self.mass / (TICK_S * TICK_S) + self.damping / TICK_S,
            self.mass / TICK_S,
        );
        for ((out, u), v) in free.iter_mut().zip(u).zip(v) {
            for k in 0..4 {
                out[k] = of_u * u[k] + of_v * v[k];
            }
        }
        if self.law.limit > 1.0 {
            self.padded[..u.len()].copy_from_slice(u);
            self.forces.fill([0.0; 4]);
            let steepest = self.law.steepest();
            for bond in &self.bonds {
                let (d, factor) = bond.stretched(&self.padded, &self.law);
                let excess = steepest - factor;
                let (a, b) = (bond.a as usize, bond.b as usize);
                for (k, (stiffness, d)) in bond.stiffness.iter().zip(&d).enumerate() {
                    let force = excess * stiffness * d;
                    self.forces[a][k] += force;
                    self.forces[b][k] -= force;
                }
            }
            for (out, force) in free.iter_mut().zip(&self.forces) {
                for k in 0..4 {
                    out[k] += force[k];
                }
            }
        }
        self.factor.solve(free);
    }

    /// Displacement of a node of the tree, metres.
    #[inline(always)]
    pub fn displacement(&self, u: &[Axes], node: u32) -> Axes {
        let carrier = &self.carriers[node as usize];
        let mut sum = [0.0; 4];
        for c in 0..CARRIERS {
            let w = carrier.weights[c];
            add_product(&mut sum, &[w; 4], &u[usize::from(carrier.nodes[c])]);
        }
        sum
    }

    /// Adds the displacements of nodes of the tree to their centres `rest`.
    pub fn centres(&self, u: &[Axes], rest: &[Vec3], ids: &[u32], out: &mut [Vec3]) {
        for (id, centre) in ids.iter().zip(out) {
            let [x, y, z, _] = self.displacement(u, *id);
            let rest = &rest[*id as usize];
            *centre = Vec3::new(rest.x + x, rest.y + y, rest.z + z);
        }
    }

    /// Adds `scale n_i' C_ij n_j` for all pairs of `sites`.
    pub fn add_gram(&mut self, sites: &[Site], scale: f64, gram: &mut Gram<'_>) {
        self.touch(sites);
        let Loads {
            touched,
            places,
            column,
            runs,
        } = &mut self.loads;
        let n = self.free;
        for (p, &(first, end)) in runs.iter().enumerate() {
            let of = &self.carriers[sites[first as usize].sphere as usize];
            // Rows of the symmetric inverse serve as its columns.
            let rows: [&[Axes]; CARRIERS] = std::array::from_fn(|c| {
                let at = usize::from(of.nodes[c]) * n;
                &self.inverse[at..at + n]
            });
            for (entry, &node) in column.iter_mut().zip(&*touched) {
                *entry = [0.0; 4];
                for (row, w) in rows.iter().zip(of.weights) {
                    add_product(entry, &[w * scale; 4], &row[usize::from(node)]);
                }
            }
            for (q, &(other, last)) in runs[..=p].iter().enumerate() {
                let carrier = &self.carriers[sites[other as usize].sphere as usize];
                let mut compliance = [0.0; 4];
                for (&node, w) in carrier.nodes.iter().zip(carrier.weights) {
                    let place = usize::from(places[usize::from(node)]);
                    add_product(&mut compliance, &[w; 4], &column[place]);
                }
                for i in first as usize..end as usize {
                    let a = &sites[i].normal;
                    let moved = Vec3::new(
                        a.x * compliance[0],
                        a.y * compliance[1],
                        a.z * compliance[2],
                    );
                    let others = sites.iter().enumerate();
                    for (j, site) in others.take(last as usize).skip(other as usize) {
                        let entry = moved.dot(&site.normal);
                        if p == q {
                            // The whole block, row by row.
                            gram.add(i, j, entry);
                        } else {
                            gram.add(i, j, entry);
                            gram.add(j, i, entry);
                        }
                    }
                }
            }
        }
        self.forget();
    }

    /// Adds to `shape` what it moves under the load `-lambda_i n_i` on each site.
    pub fn load(&mut self, sites: &[Site], lambda: &[f64], shape: &mut [Axes]) {
        self.touch(sites);
        let Loads {
            touched,
            places,
            column,
            ..
        } = &mut self.loads;
        column[..touched.len()].fill([0.0; 4]);
        for (site, load) in sites.iter().zip(lambda) {
            if *load == 0.0 {
                continue;
            }
            let n = &site.normal;
            let force = [n.x * load, n.y * load, n.z * load, 0.0];
            let carrier = &self.carriers[site.sphere as usize];
            for (&node, w) in carrier.nodes.iter().zip(carrier.weights) {
                let place = usize::from(places[usize::from(node)]);
                add_product(&mut column[place], &[w; 4], &force);
            }
        }
        for (force, &node) in column.iter().zip(&*touched) {
            if *force == [0.0; 4] {
                continue;
            }
            let at = usize::from(node) * self.free;
            let row = &self.inverse[at..at + self.free];
            for (moved, compliance) in shape.iter_mut().zip(row) {
                subtract_product(moved, compliance, force);
            }
        }
        self.forget();
    }

    /// Lists the free nodes that carry a touched sphere, and the runs of sites on one sphere.
    fn touch(&mut self, sites: &[Site]) {
        let Loads {
            touched,
            places,
            runs,
            ..
        } = &mut self.loads;
        touched.clear();
        runs.clear();
        for (k, site) in sites.iter().enumerate() {
            let k = k as u32;
            match runs.last_mut() {
                Some((first, end)) if sites[*first as usize].sphere == site.sphere => {
                    *end = k + 1;
                    continue;
                }
                _ => runs.push((k, k + 1)),
            }
            for &node in &self.carriers[site.sphere as usize].nodes {
                let place = &mut places[usize::from(node)];
                if *place == NOWHERE {
                    *place = touched.len() as u16;
                    touched.push(node);
                }
            }
        }
    }

    fn forget(&mut self) {
        for &node in &self.loads.touched {
            self.loads.places[usize::from(node)] = NOWHERE;
        }
    }

    /// Elastic energy of the law's potential, joules: for tests.
    #[cfg(test)]
    pub fn elastic_energy(&self, u: &[Axes]) -> f64 {
        let mut padded = u.to_vec();
        padded.push([0.0; 4]);
        let c = self.law.limit - 1.0;
        let of = |bond: &Bond| {
            let (a, b) = (&padded[bond.a as usize], &padded[bond.b as usize]);
            let (mut energy, mut x) = (0.0, 0.0);
            for k in 0..3 {
                let d = a[k] - b[k];
                energy += 0.5 * bond.stiffness[k] * d * d;
                x += bond.stretch[k] * d * d;
            }
            let at_half = 0.5 * bond.stiffness[0] / bond.stretch[0];
            energy + c * (energy - at_half * libm::log(1.0 + x))
        };
        self.bonds.iter().map(of).sum()
    }

    /// Force of the springs on each free node, newtons: for tests.
    #[cfg(test)]
    pub fn elastic_force(&self, u: &[Axes]) -> Vec<Axes> {
        let mut padded = u.to_vec();
        padded.push([0.0; 4]);
        let mut forces = vec![[0.0; 4]; self.free + 1];
        for bond in &self.bonds {
            let (d, factor) = bond.stretched(&padded, &self.law);
            for k in 0..4 {
                let force = factor * bond.stiffness[k] * d[k];
                forces[bond.a as usize][k] -= force;
                forces[bond.b as usize][k] += force;
            }
        }
        forces.pop();
        forces
    }

    #[cfg(test)]
    pub fn inverse(&self) -> &[Axes] {
        &self.inverse
    }

    #[cfg(test)]
    pub fn fill(&self) -> usize {
        self.factor.fill()
    }

    /// `K` at rest.
    #[cfg(test)]
    pub fn stiffness_at_rest(&self) -> Matrix {
        stiffness(&self.bonds, self.free, 1.0)
    }
}

impl Bond {
    /// Difference of its ends' displacements, and its stiffness now over that at rest.
    #[inline(always)]
    fn stretched(&self, padded: &[Axes], law: &StretchLaw) -> (Axes, f64) {
        let (a, b) = (&padded[self.a as usize], &padded[self.b as usize]);
        let (mut d, mut x) = ([0.0; 4], 0.0);
        for k in 0..4 {
            d[k] = a[k] - b[k];
            x += self.stretch[k] * d[k] * d[k];
        }
        (d, law.factor(x))
    }
}

/// Stiffness matrix of the free nodes, `factor` times that at rest, N/m.
fn stiffness(bonds: &[Bond], free: usize, factor: f64) -> Matrix {
    let mut matrix = Matrix::zeros(free);
    for bond in bonds {
        let ends = [bond.a as usize, bond.b as usize];
        for i in ends.into_iter().filter(|&i| i < free) {
            for j in ends.into_iter().filter(|&j| j < free) {
                let sign = if i == j { factor } else { -factor };
                for k in 0..3 {
                    matrix.at(i, j)[k] += sign * bond.stiffness[k];
                }
            }
        }
    }
    matrix
}

/// Largest way of a node between two configurations, metres.
pub(super) fn farthest(from: &[Axes], to: &[Axes]) -> f64 {
    let most = from.iter().zip(to).fold(0.0, |most, (a, b)| {
        let mut squared = 0.0;
        for k in 0..4 {
            squared += (b[k] - a[k]) * (b[k] - a[k]);
        }
        fmax(most, squared)
    });
    most.sqrt()
}

/// Largest displacement of a node, metres.
pub(super) fn longest(u: &[Axes]) -> f64 {
    let most = u.iter().fold(0.0, |most, a| {
        fmax(most, a[0] * a[0] + a[1] * a[1] + a[2] * a[2])
    });
    most.sqrt()
}
