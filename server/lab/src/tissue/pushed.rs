//! The spheres that push an organ where forces act on its surface, in the model by surface compliance.
//!
//! A tool pushes spheres, a case of the judge vertices. Places on the surface follow the masters with smooth weights, and so do the
//! spheres. Sought for each vertex is the mixture of the spheres about it that comes nearest to its own weights,
//! `min |sum_s x_s w_s - w_v|^2 + r sum_s x_s^2 / k_s`: with `k_s` falling to zero, slope and all, where a sphere ceases to be felt, the
//! mixture changes smoothly from vertex to vertex.

use nalgebra::{SMatrix, SVector};
use sulcus_core::math::{fclamp, fmax, norm};
use sulcus_core::tissue::surface::{SURFACE_CARRIERS, SurfaceCompliance};
use sulcus_core::tree::Node;
use sulcus_core::{SphereTree, Vec3};

/// Spheres that may push for a vertex.
const SPHERES: usize = 16;
/// How much rather a mixture has small weights than is exact.
const RIDGE: f64 = 1e-3;

/// Adds to `loads` (by node of the tree, newtons) what `forces` on the `vertices` (metres, the frame of the tree) push the spheres of a
/// `level` with.
pub(super) fn push(
    model: &SurfaceCompliance,
    (tree, level): (&SphereTree, u8),
    (vertices, forces): (&[Vec3], &[Vec3]),
    loads: &mut [Vec3],
) {
    let spheres: Vec<(u32, Node)> = tree.shape_at(level).map(|(id, node)| (id, *node)).collect();
    for (vertex, force) in vertices.iter().zip(forces) {
        if *force != Vec3::zeros() {
            for (node, weight) in pushing(model, &spheres, vertex) {
                loads[node as usize] += force * weight;
            }
        }
    }
}

/// The spheres that push for a vertex, with their weights; `spheres` are those that can be touched, at least one.
fn pushing(model: &SurfaceCompliance, spheres: &[(u32, Node)], vertex: &Vec3) -> Vec<(u32, f64)> {
    let away = |(k, (_, node)): (usize, &(u32, Node))| {
        let distance = norm(&(node.centre - vertex)) - node.contact_radius;
        (distance, k)
    };
    let mut near: Vec<(f64, usize)> = spheres.iter().enumerate().map(away).collect();
    near.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let (first, last) = (near[0].0, near[near.len().min(SPHERES + 1) - 1].0);
    let reach = fmax(last - first, 1e-9);
    near.truncate(SPHERES);
    let kernel = |distance: f64| {
        let rest = fclamp(1.0 - (distance - first) / reach, 0.0, 1.0);
        rest * rest
    };
    // Weights by master that moves: of what is held none goes anywhere.
    let masters = model.masters.moving();
    let mut wanted = vec![0.0; masters];
    for (master, weight) in model.masters.weights(vertex) {
        if let Some(wanted) = wanted.get_mut(master) {
            *wanted += weight;
        }
    }
    let rows: Vec<[(usize, f64); SURFACE_CARRIERS]> = near
        .iter()
        .map(|(_, k)| {
            let skin = &model.skin[spheres[*k].0 as usize];
            std::array::from_fn(|c| (usize::from(skin.masters[c]), skin.weights[c]))
        })
        .collect();
    let mut normal = SMatrix::<f64, SPHERES, SPHERES>::identity();
    let mut right = SVector::<f64, SPHERES>::zeros();
    let mut dense = vec![0.0; masters];
    for (i, row) in rows.iter().enumerate() {
        for (master, weight) in row {
            dense[*master] += weight;
        }
        for (j, other) in rows.iter().enumerate() {
            normal[(i, j)] = other.iter().map(|(k, w)| dense[*k] * w).sum();
        }
        right[i] = row.iter().map(|(k, w)| wanted[*k] * w).sum();
        normal[(i, i)] += RIDGE / fmax(kernel(near[i].0), 1e-9);
        for (master, _) in row {
            dense[*master] = 0.0;
        }
    }
    let mixture = match normal.cholesky() {
        Some(factor) => factor.solve(&right),
        None => SVector::from_fn(|i, _| f64::from(u8::from(i == 0))),
    };
    // As much of the mixture moves as of the vertex: what is free is followed wholly.
    let free: f64 = wanted.iter().sum();
    let shares = rows
        .iter()
        .map(|row| row.iter().map(|(_, w)| w).sum::<f64>());
    let moving: f64 = mixture.iter().zip(shares).map(|(x, share)| x * share).sum();
    let scale = if moving > 0.5 * free {
        free / fmax(moving, 1e-9)
    } else {
        1.0
    };
    near.iter()
        .zip(mixture.iter())
        .map(|((_, k), x)| (spheres[*k].0, x * scale))
        .collect()
}
