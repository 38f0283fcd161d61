//! Places of the masters, and their functions on the surface.

use std::collections::BTreeMap;

use faer::Mat;
use sulcus_core::Vec3;
use sulcus_core::tissue::surface::{Masters, SURFACE_CARRIERS};

use crate::error::FemError;
use crate::mesh::TetMesh;

/// Chooses vertices of the surface as masters, each as far as possible from those before it.
///
/// The choice ends when `most` of the masters move, or no vertex is left.
pub(super) fn choose(mesh: &TetMesh, most: usize) -> Result<Masters, FemError> {
    let mut vertices = mesh.boundary_triangles().concat();
    vertices.sort_unstable();
    vertices.dedup();
    let at = |k: usize| mesh.nodes[vertices[k] as usize];
    let held = |k: usize| mesh.held[vertices[k] as usize] == [true; 3];
    let mut away = vec![f64::INFINITY; vertices.len()];
    let (mut moving, mut still) = (Vec::new(), Vec::new());
    loop {
        let next =
            (0..vertices.len()).fold(0, |best, k| if away[k] > away[best] { k } else { best });
        if away[next] == 0.0 || (!held(next) && moving.len() == most) {
            break;
        }
        if held(next) {
            still.push(at(next));
        } else {
            moving.push(at(next));
        }
        for (k, away) in away.iter_mut().enumerate() {
            *away = away.min((at(k) - at(next)).norm());
        }
    }
    if moving.len() + still.len() <= SURFACE_CARRIERS || moving.is_empty() {
        let found = format!("{} that move of {}", moving.len(), vertices.len());
        return Err(FemError::field(
            "vertices of the surface",
            found,
            "more than 8, some that move",
        ));
    }
    let count = moving.len();
    moving.append(&mut still);
    Ok(Masters {
        places: moving,
        moving: count as u16,
    })
}

/// Functions of the moving masters on the surface: linear on each triangle, by the weights of its corners.
pub(super) struct Functions {
    nodes: usize,
    /// Consistent forces of each master's function as a traction of 1 Pa, by node, m2.
    forces: Vec<Vec<(u32, f64)>>,
    /// Integrals of the functions' products over the surface, m2.
    pub mass: Mat<f64>,
}

impl Functions {
    pub fn new(mesh: &TetMesh, masters: &Masters) -> Self {
        let count = masters.moving();
        let mut forces = vec![BTreeMap::<u32, f64>::new(); count];
        let mut mass = Mat::<f64>::zeros(count, count);
        for [a, b, c, middles @ ..] in mesh.boundary_faces() {
            let corners = [a, b, c];
            let places = corners.map(|k| mesh.nodes[k as usize]);
            let weights = places.map(|p| masters.weights(&p));
            let carried = |corner: usize| {
                let moves = |(k, w): &(usize, f64)| *k < count && *w > 0.0;
                weights[corner].into_iter().filter(moves)
            };
            let area = 0.5
                * (places[1] - places[0])
                    .cross(&(places[2] - places[0]))
                    .norm();
            for k in 0..3 {
                for (a, w) in carried(k) {
                    let forces = &mut forces[a];
                    for l in 0..3 {
                        // Integral of the product of a corner's linear function with a quadratic one, exact.
                        let of_corner = if k == l { 1.0 / 30.0 } else { -1.0 / 60.0 };
                        *forces.entry(corners[l]).or_default() += w * area * of_corner;
                        let ends = k == l || k == (l + 1) % 3;
                        let of_middle = if ends { 2.0 / 15.0 } else { 1.0 / 15.0 };
                        *forces.entry(middles[l]).or_default() += w * area * of_middle;
                        let both = if k == l { 1.0 / 6.0 } else { 1.0 / 12.0 };
                        for (b, v) in carried(l) {
                            mass[(a, b)] += w * v * area * both;
                        }
                    }
                }
            }
        }
        Self {
            nodes: mesh.nodes.len(),
            forces: forces
                .into_iter()
                .map(|f| f.into_iter().collect())
                .collect(),
            mass,
        }
    }

    /// Returns the forces of a master's function as a traction of 1 Pa along an axis, N, node by node.
    pub fn traction(&self, master: usize, axis: usize) -> Vec<Vec3> {
        let mut load = vec![Vec3::zeros(); self.nodes];
        for &(node, force) in &self.forces[master] {
            load[node as usize][axis] = force;
        }
        load
    }

    /// Writes the integrals of a displacement times each master's function over the surface (m3) into a column.
    ///
    /// Rows are x, y, z of each master in turn.
    pub fn read_all(&self, moved: &[Vec3], into: &mut Mat<f64>, column: usize) {
        for master in 0..into.nrows() / 3 {
            let read = self.read(master, moved);
            for axis in 0..3 {
                into[(3 * master + axis, column)] = read[axis];
            }
        }
    }

    fn read(&self, master: usize, moved: &[Vec3]) -> Vec3 {
        let terms = self.forces[master].iter();
        terms.fold(Vec3::zeros(), |sum, &(node, w)| {
            sum + moved[node as usize] * w
        })
    }
}
