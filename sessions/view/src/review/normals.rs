//! Normals of a moving mesh.

/// Unit normal of each vertex, the mean of its triangles' normals by area. A vertex without a triangle has a normal
/// upwards.
pub(crate) fn normals(vertices: &[[f32; 3]], triangles: &[[u32; 3]]) -> Vec<[f32; 3]> {
    let mut sums = vec![[0.0f32; 3]; vertices.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|v| vertices[v as usize]);
        let (u, v) = (minus(b, a), minus(c, a));
        // The length of this vector is twice the area.
        let across = [
            u[1] * v[2] - u[2] * v[1],
            u[2] * v[0] - u[0] * v[2],
            u[0] * v[1] - u[1] * v[0],
        ];
        for corner in triangle {
            for (sum, x) in sums[*corner as usize].iter_mut().zip(across) {
                *sum += x;
            }
        }
    }
    for sum in &mut sums {
        let length = sum.iter().map(|x| x * x).sum::<f32>().sqrt();
        *sum = if length > 0.0 {
            // Steps of 1/128 are not visible, and vertices that do not move keep the same bytes.
            sum.map(|x| (x / length * 128.0).round() / 128.0)
        } else {
            [0.0, 0.0, 1.0]
        };
    }
    sums
}

fn minus(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cubes_corner_looks_away_from_all_three_sides() {
        let vertices = [
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
            [9.0, 9.0, 9.0],
        ];
        let found = normals(&vertices, &[[0, 2, 1], [0, 1, 3], [0, 3, 2]]);
        for x in found[0] {
            assert!((x + 1.0 / 3.0f32.sqrt()).abs() < 1.0 / 128.0, "{found:?}");
        }
        assert_eq!(found[4], [0.0, 0.0, 1.0], "a vertex without a triangle");
    }
}
