//! Level of a skeleton prepared for ticks: step, compliance, displacement of the carried spheres.

use crate::math::{Vec3, fmax, norm};
use crate::tissue::{Gram, Site};
use crate::tree::SphereTree;

use super::data::{CARRIERS, SkeletonLevel, StretchLaw};
use super::entry::{Axes, Entry, add_product};
use super::factor::{Factor, Matrix, elimination_order};

/// Spring between two free nodes, or between a free node and a fixed node. The index of a fixed node is the number of
/// free nodes.
#[derive(Clone, Copy, Debug)]
struct Bond<E> {
    a: u32,
    b: u32,
    /// Stiffness at rest, N/m, world axes.
    stiffness: E,
    /// Stiffness scaled to 1/m2. `d' stretch d`, with `d` the difference of the ends' displacements in metres, is the
    /// `x` of [`StretchLaw`].
    stretch: E,
    /// Factor from `stiffness` to `stretch`, 1/(N m).
    #[cfg(test)]
    unit: f64,
}

/// Free nodes that carry a sphere. A fixed carrier is stored as node 0 with weight zero.
#[derive(Clone, Copy, Debug)]
struct Carrier {
    nodes: [u16; CARRIERS],
    weights: [f64; CARRIERS],
}

/// Level of a skeleton prepared for ticks. Free nodes are numbered in the order of elimination.
#[derive(Debug)]
pub(super) struct Lattice<E> {
    free: usize,
    bonds: Vec<Bond<E>>,
    law: StretchLaw,
    /// Length of a tick, seconds.
    tick_s: f64,
    mass: f64,
    damping: f64,
    factor: Factor<E>,
    /// Inverse of the step matrix `A = M/dt2 + B/dt + K`, with the stiffest `K` of the law: row-major, m/N. Entry `(i,
    /// j)` is the displacement of free node `i` in one tick for a unit force on free node `j`.
    inverse: Vec<E>,
    /// Carriers of each node of the tree, in the order of the tree's nodes.
    carriers: Vec<Carrier>,
    /// Node of the tree at each free node.
    tree_nodes: Vec<u32>,
    /// Displacements of the free nodes, then a zero for all fixed nodes, metres.
    padded: Vec<Axes>,
    /// Forces on the free nodes, then their unused sum on the fixed nodes, newtons.
    forces: Vec<Axes>,
    loads: Loads<E>,
}

/// Scratch for the contact rows on the tissue and their loads.
#[derive(Debug)]
struct Loads<E> {
    /// Free nodes that carry a touched sphere.
    touched: Vec<u16>,
    /// Index in `touched` of each free node, or `NOWHERE`.
    places: Vec<u16>,
    /// Displacement of one sphere for a unit force on each touched node, m/N, times the scale of [`Lattice::add_gram`].
    column: Vec<E>,
    /// Minus the force on each touched node, newtons: sum of normals times loads, weighted by the carriers of each
    /// sphere.
    pushed: Vec<Axes>,
    /// Runs of rows on one sphere: first row and end.
    runs: Vec<(u32, u32)>,
}

const NOWHERE: u16 = u16::MAX;
/// Capacity for the runs of rows on one tissue in a problem.
const MOST_SITES: usize = 2048;

impl<E: Entry> Lattice<E> {
    /// Prepares `level` for ticks of `tick_s` seconds. The level must have passed its validation against `rest`.
    pub fn new(level: &SkeletonLevel, rest: &SphereTree, tick_s: f64) -> Self {
        let free = level.free();
        // Free nodes are numbered in the order of the data first, then in the order of elimination.
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
        let bonds: Vec<Bond<E>> = level
            .springs
            .iter()
            .map(|spring| {
                let [x, y, z] = spring.stiffness;
                let at_half = norm(&level.reach(spring, rest)) * law.half;
                let unit = 3.0 / ((x + y + z) * at_half * at_half);
                let scaled = |by: f64| {
                    E::of(
                        spring.stiffness.map(|k| k * by),
                        spring.coupling.map(|k| k * by),
                    )
                };
                Bond {
                    a: number[usize::from(spring.a)] as u32,
                    b: number[usize::from(spring.b)] as u32,
                    stiffness: scaled(1.0),
                    stretch: scaled(unit),
                    #[cfg(test)]
                    unit,
                }
            })
            .collect();
        let mut matrix = stiffness(&bonds, free, law.steepest());
        let own = params.mass / (tick_s * tick_s) + params.damping / tick_s;
        for i in 0..free {
            matrix.at(i, i).add_diagonal(own);
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
            tick_s,
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
                column: vec![E::ZERO; free],
                pushed: vec![[0.0; 4]; free],
                runs: Vec::with_capacity(MOST_SITES),
            },
            bonds,
        }
    }

    /// Returns the count of numbers in a configuration: x, y, z (metres) and a zero for each free node.
    pub fn shape_len(&self) -> usize {
        4 * self.free
    }

    /// Returns the number of free nodes.
    pub fn free(&self) -> usize {
        self.free
    }

    /// Returns the node of the tree at each free node.
    pub fn tree_nodes(&self) -> &[u32] {
        &self.tree_nodes
    }

    /// Computes the displacements of the nodes at the end of the tick without contact, by implicit Euler:
    ///
    /// `(M/dt2 + B/dt + K) u0 = M/dt2 (u + dt v) + B/dt u + r`,
    ///
    /// with the displacements `u` (m) and velocities `v` (m/s) at the start of the tick, and the stiffest `K` of the
    /// law in the matrix. `r` is the excess of the stiffest force over the present force, at the present displacement.
    ///
    /// The stiffest `K` is a bound on the curvature of the elastic energy. The sum of kinetic and elastic energy
    /// therefore never grows in a free step, at any stretch. Over a step `d`, the elastic energy grows by at most
    /// `f(u).d + d'Kd/2`. The kinetic energy grows by at most `-f(u).d - d'Kd - d'Bd/dt`.
    pub fn free_step(&mut self, u: &[Axes], v: &[Axes], free: &mut [Axes]) {
        let (of_u, of_v) = (
            self.mass / (self.tick_s * self.tick_s) + self.damping / self.tick_s,
            self.mass / self.tick_s,
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
                let force = bond.stiffness.product(excess, &d);
                for (k, force) in force.iter().enumerate() {
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

    /// Returns the displacement of a node of the tree, world axes, metres, for the displacements `u` of the free nodes.
    /// Maps velocities in the same way.
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

    /// Writes the centres of the nodes `ids` of the tree: the centres `rest` plus the displacements, world axes,
    /// metres. `u` holds the displacements of the free nodes.
    pub fn centres(&self, u: &[Axes], rest: &[Vec3], ids: &[u32], out: &mut [Vec3]) {
        for (id, centre) in ids.iter().zip(out) {
            let [x, y, z, _] = self.displacement(u, *id);
            let rest = &rest[*id as usize];
            *centre = Vec3::new(rest.x + x, rest.y + y, rest.z + z);
        }
    }

    /// Adds `scale n_i' C_ij n_j` for all pairs of `sites`, metres per newton. `C_ij` is the displacement of sphere `i`
    /// in one tick for a unit force on sphere `j`. `scale` is the share of this level, 0 to 1.
    pub fn add_gram(&mut self, sites: &[Site], scale: f64, gram: &mut Gram<'_>) {
        self.touch(sites);
        let Loads {
            touched,
            places,
            column,
            runs,
            ..
        } = &mut self.loads;
        let n = self.free;
        for (p, &(first, end)) in runs.iter().enumerate() {
            let of = &self.carriers[sites[first as usize].sphere as usize];
            // The inverse is symmetric, so its rows serve as columns.
            let rows: [&[E]; CARRIERS] = std::array::from_fn(|c| {
                let at = usize::from(of.nodes[c]) * n;
                &self.inverse[at..at + n]
            });
            for (entry, &node) in column.iter_mut().zip(&*touched) {
                *entry = E::ZERO;
                for (row, w) in rows.iter().zip(of.weights) {
                    entry.add_scaled(w * scale, &row[usize::from(node)]);
                }
            }
            for (q, &(other, last)) in runs[..=p].iter().enumerate() {
                let carrier = &self.carriers[sites[other as usize].sphere as usize];
                let mut compliance = E::ZERO;
                for (&node, w) in carrier.nodes.iter().zip(carrier.weights) {
                    let place = usize::from(places[usize::from(node)]);
                    compliance.add_scaled(w, &column[place]);
                }
                for i in first as usize..end as usize {
                    let moved = compliance.before(&sites[i].normal);
                    let others = sites.iter().enumerate();
                    for (j, site) in others.take(last as usize).skip(other as usize) {
                        let entry = moved.dot(&site.normal);
                        if p == q {
                            // The loops over one sphere's rows visit `(i, j)` and `(j, i)`.
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

    /// Adds to `shape` the displacements of the free nodes (metres) under the load `-lambda_i n_i` (newtons) on each
    /// site.
    pub fn load(&mut self, sites: &[Site], lambda: &[f64], shape: &mut [Axes]) {
        self.touch(sites);
        let Loads {
            touched,
            places,
            pushed,
            ..
        } = &mut self.loads;
        pushed[..touched.len()].fill([0.0; 4]);
        for (site, load) in sites.iter().zip(lambda) {
            if *load == 0.0 {
                continue;
            }
            let n = &site.normal;
            let force = [n.x * load, n.y * load, n.z * load, 0.0];
            let carrier = &self.carriers[site.sphere as usize];
            for (&node, w) in carrier.nodes.iter().zip(carrier.weights) {
                let place = usize::from(places[usize::from(node)]);
                add_product(&mut pushed[place], &[w; 4], &force);
            }
        }
        for (force, &node) in pushed.iter().zip(&*touched) {
            if *force == [0.0; 4] {
                continue;
            }
            let at = usize::from(node) * self.free;
            let row = &self.inverse[at..at + self.free];
            for (moved, compliance) in shape.iter_mut().zip(row) {
                compliance.subtract_transposed_from(moved, force);
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

    /// Returns the elastic energy by the law's potential, joules.
    #[cfg(test)]
    pub fn elastic_energy(&self, u: &[Axes]) -> f64 {
        let mut padded = u.to_vec();
        padded.push([0.0; 4]);
        let c = self.law.limit - 1.0;
        let of = |bond: &Bond<E>| {
            let (d, _) = bond.stretched(&padded, &self.law);
            let energy = 0.5 * bond.stiffness.quadratic(&d);
            let x = bond.stretch.quadratic(&d);
            energy + c * (energy - 0.5 / bond.unit * libm::log(1.0 + x))
        };
        self.bonds.iter().map(of).sum()
    }

    /// Returns the force of the springs on each free node, newtons.
    #[cfg(test)]
    pub fn elastic_force(&self, u: &[Axes]) -> Vec<Axes> {
        let mut padded = u.to_vec();
        padded.push([0.0; 4]);
        let mut forces = vec![[0.0; 4]; self.free + 1];
        for bond in &self.bonds {
            let (d, factor) = bond.stretched(&padded, &self.law);
            let force = bond.stiffness.product(factor, &d);
            for k in 0..4 {
                forces[bond.a as usize][k] -= force[k];
                forces[bond.b as usize][k] += force[k];
            }
        }
        forces.pop();
        forces
    }

    #[cfg(test)]
    pub fn inverse(&self) -> &[E] {
        &self.inverse
    }

    #[cfg(test)]
    pub fn fill(&self) -> usize {
        self.factor.fill()
    }

    /// Returns the stiffness matrix `K` of the free nodes at rest, N/m.
    #[cfg(test)]
    pub fn stiffness_at_rest(&self) -> Matrix<E> {
        stiffness(&self.bonds, self.free, 1.0)
    }
}

impl<E: Entry> Bond<E> {
    /// Returns the displacement of end `a` minus that of end `b`, metres, and the ratio of the present stiffness to
    /// that at rest.
    #[inline(always)]
    fn stretched(&self, padded: &[Axes], law: &StretchLaw) -> (Axes, f64) {
        let (a, b) = (&padded[self.a as usize], &padded[self.b as usize]);
        let d = std::array::from_fn(|k| a[k] - b[k]);
        (d, law.factor(self.stretch.quadratic(&d)))
    }
}

/// Returns the stiffness matrix of the free nodes, `factor` times that at rest, N/m.
fn stiffness<E: Entry>(bonds: &[Bond<E>], free: usize, factor: f64) -> Matrix<E> {
    let mut matrix: Matrix<E> = Matrix::zeros(free);
    for bond in bonds {
        let ends = [bond.a as usize, bond.b as usize];
        for i in ends.into_iter().filter(|&i| i < free) {
            for j in ends.into_iter().filter(|&j| j < free) {
                let sign = if i == j { factor } else { -factor };
                matrix.at(i, j).add_scaled(sign, &bond.stiffness);
            }
        }
    }
    matrix
}

/// Returns the largest motion of a free node between two lists of displacements, metres.
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

/// Returns the largest displacement of a free node, metres.
pub(super) fn longest(u: &[Axes]) -> f64 {
    let most = u.iter().fold(0.0, |most, a| {
        fmax(most, a[0] * a[0] + a[1] * a[1] + a[2] * a[2])
    });
    most.sqrt()
}
