//! Check that a deformed surface still faces outwards everywhere.

use sulcus_core::Vec3;
use sulcus_core::math::Mat3;

use crate::mesh::TriMesh;

/// Returns the number of inverted triangles of `mesh` after its vertices moved by `moved` (metres), and the least
/// ratio of an area to its area at rest.
///
/// A triangle is inverted if it faces against the rotated surface around it. The rotation is the best fit to the
/// vertices of all triangles around it (Kabsch 1976, doi:10.1107/S0567739476001873).
pub fn turned(mesh: &TriMesh, moved: &[Vec3]) -> (usize, f64) {
    let mut after = mesh.clone();
    for (vertex, by) in after.vertices.iter_mut().zip(moved) {
        *vertex += by;
    }
    let mut with = vec![Vec::new(); mesh.vertices.len()];
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        triangle.iter().for_each(|v| with[*v as usize].push(t));
    }
    let (mut count, mut least) = (0, f64::INFINITY);
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        let near = triangle.iter().flat_map(|v| &with[*v as usize]);
        let mut around: Vec<usize> = near
            .flat_map(|&t| mesh.triangles[t].map(|v| v as usize))
            .collect();
        around.sort_unstable();
        around.dedup();
        let mean = |of: &[Vec3]| around.iter().map(|&v| of[v]).sum::<Vec3>() / around.len() as f64;
        let (before, now) = (mean(&mesh.vertices), mean(&after.vertices));
        let product = around.iter().fold(Mat3::zeros(), |sum, &v| {
            sum + (after.vertices[v] - now) * (mesh.vertices[v] - before).transpose()
        });
        let svd = product.svd(true, true);
        let (own, then) = (mesh.area_vector(t), after.area_vector(t));
        let looks = match (svd.u, svd.v_t) {
            (Some(u), Some(v)) => {
                let mut proper = Mat3::identity();
                proper[(2, 2)] = (u * v).determinant().signum();
                (u * proper * v * own).dot(&then)
            }
            _ => own.dot(&then),
        };
        count += usize::from(looks.is_nan() || looks <= 0.0);
        least = least.min(then.norm() / own.norm());
    }
    (count, least)
}

#[cfg(test)]
mod tests {
    use sulcus_core::math::exp_rotation;

    use super::*;
    use crate::mesh::shapes::icosphere;

    #[test]
    fn a_turned_ball_has_none_and_a_vertex_pulled_through_has_some() {
        let ball = icosphere(0.01, 2);
        let turn = exp_rotation(&Vec3::new(1.0, -2.0, 0.5));
        let mut moved: Vec<Vec3> = ball.vertices.iter().map(|v| turn * v - v).collect();
        let (count, least) = turned(&ball, &moved);
        assert_eq!(count, 0);
        assert!((least - 1.0).abs() < 1e-12);
        // The vertex moves to the other side of a neighbour.
        let [a, b, _] = ball.triangles[7].map(|v| v as usize);
        moved[a] = turn * (ball.vertices[b] * 2.0 - ball.vertices[a]) - ball.vertices[a];
        assert!(turned(&ball, &moved).0 > 0);
    }
}
