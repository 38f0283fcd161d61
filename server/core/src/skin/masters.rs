//! The skin of an organ by its surface compliance: each vertex goes where its masters say, by way of the spheres.
//!
//! Places on the surface follow the masters with smooth weights, and so do the spheres. Sought for each vertex is the mixture of the
//! spheres about it that comes nearest to its own weights, `min |sum_s x_s w_s - w_v|^2 + r sum_s x_s^2 / k_s`: with `k_s` falling
//! to zero, slope and all, where a sphere ceases to be felt, the mixture changes smoothly from vertex to vertex. (The weights that
//! fit a line through the spheres' centres would not do: a sphere moves as the surface that it makes, not as its middle.)

use nalgebra::{SMatrix, SVector};

use crate::math::{Vec3, fclamp, fmax, norm};
use crate::tissue::surface::{SURFACE_CARRIERS, SurfaceCompliance};
use crate::tree::Node;

/// Spheres that may carry a vertex.
const SPHERES: usize = 16;
/// How much rather a mixture has small weights than is exact.
const RIDGE: f64 = 1e-3;

/// The spheres that carry a vertex, with their weights; `spheres` are those that can be touched, at least one.
pub(super) fn carriers(
    model: &SurfaceCompliance,
    spheres: &[(u32, Node)],
    vertex: &Vec3,
) -> Vec<(u32, f64)> {
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
    // Weights by master; what is held together is one more.
    let held = model.masters.moving();
    let own = model.masters.weights(vertex);
    let mut wanted = vec![0.0; held + 1];
    for (master, weight) in own {
        wanted[if master < held { master } else { held }] += weight;
    }
    let rows: Vec<[(usize, f64); SURFACE_CARRIERS + 1]> = near
        .iter()
        .map(|(_, k)| {
            let skin = &model.skin[spheres[*k].0 as usize];
            let moving: f64 = skin.weights.iter().sum();
            std::array::from_fn(|c| match skin.masters.get(c) {
                Some(master) => (usize::from(*master), skin.weights[c]),
                None => (held, 1.0 - moving),
            })
        })
        .collect();
    let mut normal = SMatrix::<f64, SPHERES, SPHERES>::identity();
    let mut right = SVector::<f64, SPHERES>::zeros();
    let mut dense = vec![0.0; held + 1];
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
    // As much of the mixture moves as of the vertex: what is held stays, what is free is followed wholly.
    let shares = rows.iter().map(|row| 1.0 - row[SURFACE_CARRIERS].1);
    let moving: f64 = mixture.iter().zip(shares).map(|(x, share)| x * share).sum();
    let free = 1.0 - wanted[held];
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
