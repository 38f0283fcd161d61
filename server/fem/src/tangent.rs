//! Change of the forces of a neo-Hookean tetrahedron with its displacements: the consistent tangent of Newton's
//! method.

use std::array::from_fn;

use sulcus_core::Vec3;
use sulcus_core::math::Mat3;

use crate::assembly::Blocks;
use crate::element::gradients;
use crate::mesh::TetMesh;
use crate::neo_hookean::{NeoHookean, gradient};

/// Returns the change of a tetrahedron's forces with the displacements of its nodes, N/m; `None` if it is inside out.
pub(crate) fn tangent(
    mesh: &TetMesh,
    solid: &NeoHookean,
    tet: &[u32; 10],
    moved: &[Vec3],
) -> Option<Blocks> {
    let mut blocks = [[Mat3::zeros(); 10]; 10];
    for (slopes, volume) in &gradients(&mesh.corners(tet))? {
        let f = gradient(tet, slopes, moved);
        // Change of the stress with each entry of the gradient.
        let mut by = [[Mat3::zeros(); 3]; 3];
        for (k, by) in by.iter_mut().enumerate() {
            for (l, by) in by.iter_mut().enumerate() {
                let mut df = Mat3::zeros();
                df[(k, l)] = 1.0;
                *by = solid.stress_change(&f, &df)? * *volume;
            }
        }
        for b in 0..10 {
            // Node b, moved along each axis.
            let by: [Mat3; 3] =
                from_fn(|k| (0..3).fold(Mat3::zeros(), |sum, l| sum + by[k][l] * slopes[b][l]));
            for a in 0..10 {
                let columns = by.map(|by| by * slopes[a]);
                blocks[a][b] += Mat3::from_columns(&columns);
            }
        }
    }
    Some(blocks)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::neo_hookean::neo_hookean_forces;
    use crate::stiffness::Elastic;

    #[test]
    fn the_tangent_is_the_slope_of_the_forces() {
        let corners = [
            [0.0, 0.0, 0.0],
            [9.0, 1.0, 0.0],
            [1.0, 8.0, 1.0],
            [0.5, 1.0, 7.0],
        ];
        let corners = corners.map(|x| Vec3::from(x) * 1e-3).to_vec();
        let mesh = TetMesh::from_corners(corners, &[[0, 1, 2, 3]]);
        let material = Elastic {
            young: 1e5,
            poisson: 0.49,
        };
        // Displacements up to a tenth of the element.
        let moved: Vec<Vec3> = (0..10)
            .map(|k| {
                let t = f64::from(k);
                Vec3::from([0.3, 0.7, 0.4].map(|by| libm::sin(3.0 + by * t * t))) * 6e-4
            })
            .collect();
        let solid = NeoHookean::of(&material);
        let blocks = tangent(&mesh, &solid, &mesh.tets[0], &moved).expect("upright");
        let scale = blocks.iter().flatten().map(Mat3::norm).fold(0.0, f64::max);
        let h = 1e-8;
        for b in 0..10 {
            for k in 0..3 {
                let [less, more] = [-h, h].map(|h| {
                    let mut moved = moved.clone();
                    moved[mesh.tets[0][b] as usize][k] += h;
                    neo_hookean_forces(&mesh, &material, &moved).expect("upright")
                });
                for (a, row) in blocks.iter().enumerate() {
                    let node = mesh.tets[0][a] as usize;
                    let slope = (more[node] - less[node]) / (2.0 * h);
                    let column = row[b].column(k).into_owned();
                    assert!(
                        (column - slope).norm() < 1e-7 * scale,
                        "{a} {b} {k}: {column} {slope}"
                    );
                    let mirrored = blocks[b][a].row(k).transpose();
                    assert!((column - mirrored).norm() < 1e-12 * scale);
                }
            }
        }
    }
}
