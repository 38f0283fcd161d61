//! Triangle meshes, the base of every shape. Metres, right-handed; triangles are counter-clockwise as seen from
//! outside.

pub mod check;
pub mod distance;
pub(crate) mod edges;
pub(crate) mod implicit;
pub mod load;
pub mod polygon;
pub mod polygonise;
pub mod repair;
pub mod sample;
pub mod shapes;
pub mod size;
pub mod solid;
pub mod turned;

use sulcus_core::{DisplayMesh, Vec3};

/// A triangle mesh with any content. [`crate::mesh::check::check`] decides whether it is a solid.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriMesh {
    /// Vertices, metres.
    pub vertices: Vec<Vec3>,
    /// Triangles as vertex indices, counter-clockwise as seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

impl TriMesh {
    /// The three corners of a triangle, metres.
    #[inline]
    pub fn corners(&self, triangle: usize) -> [Vec3; 3] {
        self.triangles[triangle].map(|v| self.vertices[v as usize])
    }

    /// Normal of a triangle times twice its area, square metres.
    #[inline]
    pub fn area_vector(&self, triangle: usize) -> Vec3 {
        let [a, b, c] = self.corners(triangle);
        (b - a).cross(&(c - a))
    }

    /// Lowest and highest corner of the axis-aligned box around all vertices, metres.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        let mut low = Vec3::repeat(f64::INFINITY);
        let mut high = Vec3::repeat(f64::NEG_INFINITY);
        for vertex in &self.vertices {
            low = low.zip_map(vertex, sulcus_core::math::fmin);
            high = high.zip_map(vertex, sulcus_core::math::fmax);
        }
        (low, high)
    }

    /// Returns the enclosed volume, cubic metres; negative if the triangles face inwards.
    pub fn signed_volume(&self) -> f64 {
        // The first vertex is the reference, so a mesh far from the origin keeps its digits.
        let Some(&origin) = self.vertices.first() else {
            return 0.0;
        };
        let mut six = 0.0;
        for triangle in 0..self.triangles.len() {
            let [a, b, c] = self.corners(triangle).map(|v| v - origin);
            six += a.dot(&b.cross(&c));
        }
        six / 6.0
    }

    /// Area of all triangles, square metres.
    pub fn area(&self) -> f64 {
        (0..self.triangles.len())
            .map(|t| 0.5 * self.area_vector(t).norm())
            .sum()
    }

    /// Returns the mesh with vertices multiplied by `factor` and then moved by `offset` (metres).
    pub fn placed(mut self, factor: f64, offset: Vec3) -> Self {
        for vertex in &mut self.vertices {
            *vertex = *vertex * factor + offset;
        }
        self
    }

    /// Returns the mesh for display: single precision, metres, one colour (sRGB with alpha).
    pub fn to_display(&self, colour: [u8; 4]) -> DisplayMesh {
        DisplayMesh {
            vertices: self
                .vertices
                .iter()
                .map(|v| [v.x as f32, v.y as f32, v.z as f32])
                .collect(),
            triangles: self.triangles.clone(),
            colour,
            vertex_colours: Vec::new(),
        }
    }

    /// Adds every bit of the mesh to a hash.
    pub fn hash_into(&self, hasher: &mut blake3::Hasher) {
        hasher.update(&(self.vertices.len() as u64).to_le_bytes());
        for vertex in &self.vertices {
            for x in vertex.iter() {
                hasher.update(&x.to_bits().to_le_bytes());
            }
        }
        hasher.update(&(self.triangles.len() as u64).to_le_bytes());
        for index in self.triangles.iter().flatten() {
            hasher.update(&index.to_le_bytes());
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::mesh::shapes::icosphere;

    #[test]
    fn a_sphere_has_the_volume_and_area_of_a_sphere() {
        let mesh = icosphere(0.005, 4);
        let (volume, area) = (
            4.0 / 3.0 * std::f64::consts::PI * 0.005_f64.powi(3),
            4.0 * std::f64::consts::PI * 0.005_f64.powi(2),
        );
        assert!((mesh.signed_volume() / volume - 1.0).abs() < 0.01);
        assert!((mesh.area() / area - 1.0).abs() < 0.01);
    }
}
