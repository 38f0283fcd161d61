//! What linear elasticity says of the held press: finite elements of 2.5 mm, the capsule rigid and without friction behind the
//! coupling's spring. By it one sees whether the engines' blocks are equally stiff.
//!
//! Unknown is the pressure at the corners of the surface, linear between them; gaps are weighted with the same functions, so
//! that the answer settles as the elements get finer, which that of forces at points does not.

use std::collections::BTreeMap;

use sulcus_core::Vec3;
use sulcus_fem::{Elastic, Factored, TetMesh};
use sulcus_scene::mesh::distance::MeshDistance;
use sulcus_scene::organ::tetrahedra::{hold, tetrahedra};

use crate::block::{self, CAPSULE, EDGES, POISSON, PRESS, YOUNG};
use crate::capsule::{HALF, STIFFNESS};

/// Edge of the elements' lattice, metres.
const ELEMENTS: f64 = 2.5e-3;
/// Sweeps of Gauss and Seidel.
const SWEEPS: usize = 3000;

/// Integrals of a corner's function with those of the nodes of the surface: by corner, node and weight (m2).
type Weights = BTreeMap<u32, BTreeMap<u32, f64>>;

/// The weights of the top: a function that is linear on each triangle with the quadratic ones of the elements.
fn weights(mesh: &TetMesh) -> Weights {
    let mut all = Weights::new();
    for face in mesh.boundary_faces() {
        let [a, b, c] = [face[0], face[1], face[2]].map(|k| mesh.nodes[k as usize]);
        if [a, b, c].iter().any(|node| node.z < EDGES[2] - 1e-6) {
            continue;
        }
        let area = 0.5 * (b - a).cross(&(c - a)).norm();
        for k in 0..3 {
            let of = all.entry(face[k]).or_default();
            // Corners, then the middles of the edges 01, 12, 20: exact integrals of the products.
            for i in 0..3 {
                let corner = if i == k { 1.0 / 30.0 } else { -1.0 / 60.0 };
                let middle = if (k + 1) % 3 == i {
                    1.0 / 15.0
                } else {
                    2.0 / 15.0
                };
                *of.entry(face[i]).or_default() += corner * area;
                *of.entry(face[3 + i]).or_default() += middle * area;
            }
        }
    }
    all
}

/// Force with which the capsule is held 6 mm deep above `x`, `y`, newtons.
pub fn held_force(x: f64, y: f64) -> f64 {
    let surface = MeshDistance::new(block::surface());
    let mut mesh = tetrahedra(&surface, ELEMENTS, &|_| ()).expect("elements of a box");
    hold(&mut mesh, block::held);
    // How far each place of the top would be inside of a capsule that nothing holds back.
    let inside = |place: &Vec3| {
        let (dx, dy) = (place.x - x, ((place.y - y).abs() - HALF).max(0.0));
        let below = CAPSULE.radius * CAPSULE.radius - dx * dx - dy * dy;
        (below > 0.0).then(|| PRESS - CAPSULE.radius + below.sqrt())
    };
    let functions: Vec<(BTreeMap<u32, f64>, f64)> = weights(&mesh)
        .into_iter()
        .filter_map(|(corner, of)| Some((of, inside(&mesh.nodes[corner as usize])?)))
        .filter(|(_, depth)| *depth > 0.0)
        .collect();
    let load = |of: &BTreeMap<u32, f64>| {
        let mut load = vec![Vec3::zeros(); mesh.nodes.len()];
        of.iter()
            .for_each(|(node, weight)| load[*node as usize].z = -weight);
        load
    };
    let loads: Vec<Vec<Vec3>> = functions.iter().map(|(of, _)| load(of)).collect();
    let material = Elastic {
        young: YOUNG,
        poisson: POISSON,
    };
    let factored = Factored::new(&mesh, &material).expect("a held block");
    let moved = factored.solve(&loads).expect("finite loads");
    let area = |k: usize| functions[k].0.values().sum::<f64>();
    // What the block gives way there and the spring gives, for a pressure of 1 Pa at another corner.
    let given = |i: usize, j: usize| {
        let way = |(node, weight): (&u32, &f64)| -weight * moved[j][*node as usize].z;
        functions[i].0.iter().map(way).sum::<f64>() + area(i) * area(j) / STIFFNESS
    };
    let count = functions.len();
    let matrix: Vec<Vec<f64>> = (0..count)
        .map(|i| (0..count).map(|j| given(i, j)).collect())
        .collect();
    let mut pressures = vec![0.0; count];
    for _ in 0..SWEEPS {
        for i in 0..count {
            let sum: f64 = matrix[i].iter().zip(&pressures).map(|(a, p)| a * p).sum();
            let short = functions[i].1 * area(i) - sum;
            pressures[i] = f64::max(pressures[i] + short / matrix[i][i], 0.0);
        }
    }
    pressures.iter().enumerate().map(|(k, p)| p * area(k)).sum()
}
