//! Closed meshes from formulas. Lengths in millimetres.

use std::f64::consts::TAU;

use nalgebra::{Rotation3, Vector3};
use sulcus_proto::display::DisplayMesh;

/// Vector in millimetres.
pub type V = Vector3<f64>;
/// Colour, sRGB with alpha.
pub type Colour = [u8; 4];

/// Mesh with a colour for each vertex; triangles run counterclockwise as seen from outside.
#[derive(Clone, Default)]
pub struct Shape {
    pub places: Vec<V>,
    pub triangles: Vec<[u32; 3]>,
    pub colours: Vec<Colour>,
}

impl Shape {
    /// Grid of points over two parameters from 0 to 1. The normal is the cross product of the first and the second
    /// parameter's direction.
    fn grid(n: usize, m: usize, at: impl Fn(f64, f64) -> V) -> Self {
        let mut shape = Self::default();
        for i in 0..=n {
            for j in 0..=m {
                shape
                    .places
                    .push(at(i as f64 / n as f64, j as f64 / m as f64));
            }
        }
        let number = |i: usize, j: usize| (i * (m + 1) + j) as u32;
        for (i, j) in (0..n).flat_map(|i| (0..m).map(move |j| (i, j))) {
            let [a, b] = [number(i, j), number(i + 1, j)];
            let [d, c] = [number(i, j + 1), number(i + 1, j + 1)];
            shape.triangles.extend([[a, b, c], [a, c, d]]);
        }
        shape
    }

    /// Body of revolution about z, from radii and heights listed upwards. Each stretch has vertices of its own and the
    /// colour given with its lower end, so that borders of colours are sharp.
    pub fn lathe(profile: &[(f64, f64, Colour)], sides: usize) -> Self {
        let mut whole = Self::default();
        for pair in profile.windows(2) {
            let ((r0, z0, colour), (r1, z1, _)) = (pair[0], pair[1]);
            let ring = |u: f64, v: f64| {
                let (sine, cosine) = (u * TAU).sin_cos();
                let r = r0 + (r1 - r0) * v;
                V::new(r * cosine, r * sine, z0 + (z1 - z0) * v)
            };
            whole.join(Self::grid(sides, 1, ring).coloured(colour));
        }
        whole
    }

    /// Ellipsoid about the origin.
    pub fn ellipsoid(radii: V, sides: usize) -> Self {
        let at = |u: f64, v: f64| {
            let (sine, cosine) = (u * TAU).sin_cos();
            let (up, out) = (-(v * TAU / 2.0).cos(), (v * TAU / 2.0).sin());
            V::new(out * cosine, out * sine, up).component_mul(&radii)
        };
        Self::grid(sides, sides / 2, at)
    }

    /// Torus about z with the radius of its circle and of its tube.
    pub fn torus(circle: f64, tube: f64, sides: [usize; 2]) -> Self {
        let at = |u: f64, v: f64| {
            let (sine, cosine) = (u * TAU).sin_cos();
            let (rise, out) = (v * TAU).sin_cos();
            let r = circle + tube * out;
            V::new(r * cosine, r * sine, tube * rise)
        };
        Self::grid(sides[0], sides[1], at)
    }

    /// Box between two corners; each face is a grid of `n` by `n` cells.
    pub fn block(low: V, high: V, n: usize) -> Self {
        let mut whole = Self::default();
        let size = high - low;
        for axis in 0..3 {
            let (along, across) = ((axis + 1) % 3, (axis + 2) % 3);
            for upper in [false, true] {
                let face = |u: f64, v: f64| {
                    let (u, v) = if upper { (u, v) } else { (v, u) };
                    let mut at = low;
                    at[axis] = if upper { high[axis] } else { low[axis] };
                    at[along] += u * size[along];
                    at[across] += v * size[across];
                    at
                };
                whole.join(Self::grid(n, n, face));
            }
        }
        whole
    }

    pub fn coloured(mut self, colour: Colour) -> Self {
        self.colours = vec![colour; self.places.len()];
        self
    }

    pub fn join(&mut self, other: Self) {
        let first = self.places.len() as u32;
        self.places.extend(other.places);
        self.colours.extend(other.colours);
        self.triangles
            .extend(other.triangles.iter().map(|t| t.map(|v| v + first)));
    }

    pub fn moved(mut self, by: V) -> Self {
        self.places.iter_mut().for_each(|at| *at += by);
        self
    }

    pub fn turned(mut self, by: &Rotation3<f64>) -> Self {
        self.places.iter_mut().for_each(|at| *at = by * *at);
        self
    }

    /// Mesh for display, metres.
    pub fn mesh(&self) -> DisplayMesh {
        assert!(self.volume() > 0.0, "the triangles face inwards");
        let metres = |at: &V| <[f32; 3]>::from((at * 1e-3).cast::<f32>());
        let places: Vec<[f32; 3]> = self.places.iter().map(metres).collect();
        DisplayMesh::new(&places, &self.triangles, [128; 4], &self.colours).expect("a mesh")
    }

    /// Enclosed volume, mm3.
    fn volume(&self) -> f64 {
        let of = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| self.places[v as usize]);
            a.dot(&b.cross(&c)) / 6.0
        };
        self.triangles.iter().map(of).sum()
    }
}
