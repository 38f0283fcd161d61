//! Cells of an organ. The displacement gradient is constant in each cell.

use sulcus_core::Vec3;
use sulcus_core::math::Mat3;

use crate::mesh::TetMesh;
use crate::neo_hookean::gradient;

/// Gradients of the shape functions and volume at each point of integration of a tetrahedron, 1/m and m3.
pub(super) type Points = [([Vec3; 10], f64); 4];

/// Rounds of moving the centres of the cells.
const ROUNDS: usize = 30;

/// Cell of each tetrahedron, and volumes of the cells, m3.
pub(super) struct Division {
    pub of: Vec<usize>,
    pub volumes: Vec<f64>,
}

/// Adds the square of each tetrahedron's mean displacement gradient, times its volume.
pub(super) fn add_strain(mesh: &TetMesh, points: &[Points], moved: &[Vec3], sums: &mut [f64]) {
    for ((tet, points), sum) in mesh.tets.iter().zip(points).zip(sums) {
        let (mut mean, mut all) = (Mat3::zeros(), 0.0);
        for (slopes, volume) in points {
            mean += (gradient(tet, slopes, moved) - Mat3::identity()) * *volume;
            all += volume;
        }
        *sum += mean.norm_squared() / all;
    }
}

/// Divides the mesh into at most `count` cells by k-means on the centres of the tetrahedra.
///
/// Cells are small where loads on the surface strain the organ much (`strained`).
pub(super) fn divide(
    mesh: &TetMesh,
    points: &[Points],
    strained: &[f64],
    count: usize,
) -> Division {
    if count == 0 {
        return Division {
            of: vec![usize::MAX; mesh.tets.len()],
            volumes: Vec::new(),
        };
    }
    let volume = |k: usize| points[k].iter().map(|(_, v)| v).sum::<f64>();
    let middle = |tet: &[u32; 10]| {
        tet[..4]
            .iter()
            .map(|n| mesh.nodes[*n as usize])
            .sum::<Vec3>()
            / 4.0
    };
    let middles: Vec<Vec3> = mesh.tets.iter().map(middle).collect();
    // The first centres are as far apart as possible, beginning with the most strained places.
    let mut centres: Vec<Vec3> = Vec::new();
    let mut away = vec![1.0; middles.len()];
    while centres.len() < count {
        let worth = |k: usize| away[k] * strained[k] / volume(k).sqrt();
        let next =
            (0..middles.len()).fold(0, |best, k| if worth(k) > worth(best) { k } else { best });
        if worth(next) <= 0.0 {
            break;
        }
        let centre = middles[next];
        for (away, at) in away.iter_mut().zip(&middles) {
            *away = away.min((at - centre).norm_squared());
        }
        centres.push(centre);
    }
    let mut of = vec![0; middles.len()];
    for _ in 0..ROUNDS {
        assign(&middles, &centres, &mut of);
        let mut sums = vec![(Vec3::zeros(), 0.0); centres.len()];
        for (k, &cell) in of.iter().enumerate() {
            sums[cell].0 += middles[k] * strained[k];
            sums[cell].1 += strained[k];
        }
        for (centre, (sum, weight)) in centres.iter_mut().zip(sums) {
            if weight > 0.0 {
                *centre = sum / weight;
            }
        }
    }
    assign(&middles, &centres, &mut of);
    let mut volumes = vec![0.0; centres.len()];
    for (k, &cell) in of.iter().enumerate() {
        volumes[cell] += volume(k);
    }
    // A centre without tetrahedra is dropped.
    let mut number = vec![usize::MAX; centres.len()];
    let mut kept = Vec::new();
    for (cell, volume) in volumes.into_iter().enumerate() {
        if volume > 0.0 {
            number[cell] = kept.len();
            kept.push(volume);
        }
    }
    Division {
        of: of.into_iter().map(|cell| number[cell]).collect(),
        volumes: kept,
    }
}

fn assign(middles: &[Vec3], centres: &[Vec3], of: &mut [usize]) {
    for (of, at) in of.iter_mut().zip(middles) {
        let from = |k: usize| (centres[k] - at).norm_squared();
        *of = (0..centres.len()).fold(0, |best, k| if from(k) < from(best) { k } else { best });
    }
}

/// Returns the forces on the nodes of a cell, N, node by node.
///
/// The cause is a first Piola-Kirchhoff stress of 1 Pa in row `i`, column `j`.
pub(super) fn polarised(
    mesh: &TetMesh,
    points: &[Points],
    of: &[usize],
    cell: usize,
    i: usize,
    j: usize,
) -> Vec<Vec3> {
    let mut load = vec![Vec3::zeros(); mesh.nodes.len()];
    let tets = mesh.tets.iter().zip(points).zip(of);
    for ((tet, points), _) in tets.filter(|(_, of)| **of == cell) {
        for (slopes, volume) in points {
            for (node, slope) in tet.iter().zip(slopes) {
                load[*node as usize][i] += slope[j] * volume;
            }
        }
    }
    load
}
