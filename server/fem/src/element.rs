//! The quadratic tetrahedron: four corners, then the middles of the edges 01, 12, 02, 03, 13, 23.
//!
//! The order is that of C3D10 of Abaqus and CalculiX.

use sulcus_core::Vec3;
use sulcus_core::math::Mat3;

/// Corners at the ends of each edge that has a midside node.
pub const EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [0, 2], [0, 3], [1, 3], [2, 3]];

/// Returns the points of integration, in volume coordinates. Each has the weight of a quarter.
///
/// The rule is exact to second degree, as straight-edged elements need (Keast 1986,
/// doi:10.1016/0045-7825(86)90059-9).
pub fn points() -> [[f64; 4]; 4] {
    let near = (5.0 + 3.0 * 5.0_f64.sqrt()) / 20.0;
    let far = (5.0 - 5.0_f64.sqrt()) / 20.0;
    std::array::from_fn(|k| std::array::from_fn(|i| if i == k { near } else { far }))
}

/// Returns the ten shape functions at volume coordinates `l`.
#[cfg(test)]
pub fn shape(l: &[f64; 4]) -> [f64; 10] {
    std::array::from_fn(|a| match a.checked_sub(4) {
        None => l[a] * (2.0 * l[a] - 1.0),
        Some(edge) => 4.0 * l[EDGES[edge][0]] * l[EDGES[edge][1]],
    })
}

/// Returns the derivatives of the shape functions by the last three volume coordinates. The first coordinate is 1
/// minus their sum.
pub fn slopes(l: &[f64; 4]) -> [Vec3; 10] {
    // Derivatives by each of the four coordinates, as if they were independent.
    let own = |a: usize| -> [f64; 4] {
        let mut by = [0.0; 4];
        match a.checked_sub(4) {
            None => by[a] = 4.0 * l[a] - 1.0,
            Some(edge) => {
                let [i, j] = EDGES[edge];
                by[i] = 4.0 * l[j];
                by[j] = 4.0 * l[i];
            }
        }
        by
    };
    std::array::from_fn(|a| {
        let by = own(a);
        Vec3::new(by[1] - by[0], by[2] - by[0], by[3] - by[0])
    })
}

/// Returns the derivatives of the place by the coordinates, column by column.
fn jacobian(nodes: &[Vec3; 10], slopes: &[Vec3; 10]) -> Mat3 {
    let terms = nodes.iter().zip(slopes);
    terms.fold(Mat3::zeros(), |sum, (x, slope)| sum + x * slope.transpose())
}

/// Returns whether the element has positive volume at its corners and at its points of integration.
pub fn is_upright(nodes: &[Vec3; 10]) -> bool {
    let corners: [[f64; 4]; 4] =
        std::array::from_fn(|k| std::array::from_fn(|i| f64::from(u8::from(i == k))));
    let all = corners.into_iter().chain(points());
    // The comparison fails for a NaN.
    all.map(|l| jacobian(nodes, &slopes(&l)).determinant())
        .all(|volume| volume > 0.0)
}

/// Returns the gradients of the shape functions in space (1/m) at each point of integration, with its share of the
/// volume (m3).
///
/// `None` if the element is turned inside out at a point.
pub fn gradients(corners: &[Vec3; 10]) -> Option<[([Vec3; 10], f64); 4]> {
    let mut all = [([Vec3::zeros(); 10], 0.0); 4];
    for (at, l) in all.iter_mut().zip(points()) {
        let slopes = slopes(&l);
        let jacobian = jacobian(corners, &slopes);
        let volume = jacobian.determinant() / 24.0;
        let back = jacobian.try_inverse()?.transpose();
        // A NaN counts as turned inside out.
        if volume.is_nan() || volume <= 0.0 {
            return None;
        }
        *at = (slopes.map(|slope| back * slope), volume);
    }
    Some(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shape_functions_are_one_at_their_node_and_sum_to_one() {
        for a in 0..10 {
            let mut l = [0.0; 4];
            match a {
                0..4 => l[a] = 1.0,
                _ => EDGES[a - 4].iter().for_each(|&i| l[i] = 0.5),
            }
            for (b, value) in shape(&l).iter().enumerate() {
                assert_eq!(*value, f64::from(u8::from(a == b)));
            }
        }
        for l in points() {
            assert!((l.iter().sum::<f64>() - 1.0).abs() < 1e-15);
            assert!((shape(&l).iter().sum::<f64>() - 1.0).abs() < 1e-15);
            assert!(slopes(&l).iter().sum::<Vec3>().norm() < 1e-14);
        }
    }

    #[test]
    fn slopes_are_those_of_the_shape_functions() {
        let at = |x: f64, y: f64, z: f64| shape(&[1.0 - x - y - z, x, y, z]);
        let (x, y, z, h) = (0.2, 0.3, 0.15, 1e-6);
        let exact = slopes(&[1.0 - x - y - z, x, y, z]);
        for (a, exact) in exact.iter().enumerate() {
            let found = Vec3::new(
                (at(x + h, y, z)[a] - at(x - h, y, z)[a]) / (2.0 * h),
                (at(x, y + h, z)[a] - at(x, y - h, z)[a]) / (2.0 * h),
                (at(x, y, z + h)[a] - at(x, y, z - h)[a]) / (2.0 * h),
            );
            assert!((found - exact).norm() < 1e-8, "{a}: {found} {exact}");
        }
    }
}
