//! Triangle mesh on a grid of 16 bits.

use serde::{Deserialize, Serialize};

use super::{finite, rule};
use crate::CodecError;

/// Number of grid steps along the longest edge of the mesh's box.
const STEPS: f32 = 65_535.0;

/// Triangles as indices of vertices; the outward normal follows the right-hand rule.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Triangles {
    /// Triangles of a mesh with at most 65,536 vertices.
    Small(Vec<[u16; 3]>),
    /// Triangles of a larger mesh.
    Large(Vec<[u32; 3]>),
}

/// Finish of a surface at a vertex. A display without a finish chooses one by the kind of the object.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Finish {
    /// Perceptual roughness of the highlight, 255ths: 0 is a mirror. A screen squares it for the width of the
    /// highlight.
    pub roughness: u8,
    /// Depth of the stippling, 255ths of the deepest.
    pub stipple: u8,
    /// Share of light that passes a thin edge, 255ths.
    pub thin: u8,
}

/// Triangle mesh for display. Vertices lie on a grid: rounding moves a vertex by at most half a step along each axis.
/// A tooth's step is 0.4 um, a whole jaw's 1.5 um.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DisplayMesh {
    /// Lowest corner of the mesh's box, metres.
    low: [f32; 3],
    /// Step of the grid, metres, the same along all axes.
    step: f32,
    /// Vertices, steps from `low`.
    grid: Vec<[u16; 3]>,
    triangles: Triangles,
    /// Colour of the whole mesh, sRGB with alpha.
    pub colour: [u8; 4],
    /// Colours of the vertices, sRGB with alpha: one for each vertex, or none for a mesh of one colour.
    pub vertex_colours: Vec<[u8; 4]>,
    /// Finishes of the vertices: one for each vertex, or none.
    pub finishes: Vec<Finish>,
}

impl DisplayMesh {
    /// Creates a mesh from vertices (metres), triangles and colours.
    ///
    /// # Errors
    /// A vertex is not finite, a triangle names a vertex that does not exist, or the colours do not fit the vertices.
    pub fn new(
        vertices: &[[f32; 3]],
        triangles: &[[u32; 3]],
        colour: [u8; 4],
        vertex_colours: &[[u8; 4]],
    ) -> Result<Self, CodecError> {
        finite("a vertex", vertices.iter().flatten())?;
        let (mut low, mut high) = ([0.0f32; 3], [0.0f32; 3]);
        if let Some(first) = vertices.first() {
            (low, high) = (*first, *first);
        }
        for vertex in vertices {
            for (low, x) in low.iter_mut().zip(vertex) {
                *low = low.min(*x);
            }
            for (high, x) in high.iter_mut().zip(vertex) {
                *high = high.max(*x);
            }
        }
        let longest = (0..3).fold(0.0f32, |most, k| most.max(high[k] - low[k]));
        let step = longest / STEPS;
        let on_grid = |vertex: &[f32; 3]| {
            std::array::from_fn(|k| {
                // A mesh of one point has no step. The conversion limits to the range of 16 bits.
                if step > 0.0 {
                    ((vertex[k] - low[k]) / step).round() as u16
                } else {
                    0
                }
            })
        };
        let n = vertices.len();
        if triangles.iter().flatten().any(|&v| v as usize >= n) {
            return Err(CodecError::NotCanonical("a triangle has no such vertex"));
        }
        let mesh = Self {
            low,
            step,
            grid: vertices.iter().map(on_grid).collect(),
            triangles: if is_small(n) {
                Triangles::Small(triangles.iter().map(|t| t.map(|v| v as u16)).collect())
            } else {
                Triangles::Large(triangles.to_vec())
            },
            colour,
            vertex_colours: vertex_colours.to_vec(),
            finishes: Vec::new(),
        };
        mesh.check()?;
        Ok(mesh)
    }

    /// The same mesh with a finish for each vertex.
    ///
    /// # Errors
    /// The finishes do not fit the vertices.
    pub fn with_finishes(mut self, finishes: Vec<Finish>) -> Result<Self, CodecError> {
        self.finishes = finishes;
        self.check()?;
        Ok(self)
    }

    /// Number of vertices.
    pub fn len(&self) -> usize {
        self.grid.len()
    }

    /// Whether the mesh has no vertex.
    pub fn is_empty(&self) -> bool {
        self.grid.is_empty()
    }

    /// Vertices, metres: in the tool's frame for a tool, in world axes at rest for an object.
    pub fn vertices(&self) -> impl ExactSizeIterator<Item = [f32; 3]> + '_ {
        let place = |steps: u16, k: usize| self.low[k] + self.step * f32::from(steps);
        self.grid
            .iter()
            .map(move |at| std::array::from_fn(|k| place(at[k], k)))
    }

    /// Triangles as indices of vertices.
    pub fn triangles(&self) -> impl Iterator<Item = [u32; 3]> + '_ {
        let (small, large) = match &self.triangles {
            Triangles::Small(small) => (&small[..], &[][..]),
            Triangles::Large(large) => (&[][..], &large[..]),
        };
        let small = small.iter().map(|t| t.map(u32::from));
        small.chain(large.iter().copied())
    }

    pub(super) fn check(&self) -> Result<(), CodecError> {
        finite(
            "the box of a mesh",
            self.low.iter().chain(std::iter::once(&self.step)),
        )?;
        rule(
            self.step >= 0.0
                && (self.low.iter().map(|x| x.abs())).all(|x| x <= super::scene::FAR_M),
            "a mesh lies beyond 10 m",
        )?;
        rule(
            f64::from(self.step) * f64::from(STEPS) <= 2.1 * f64::from(super::scene::FAR_M),
            "a mesh is larger than 20 m",
        )?;
        let n = self.grid.len();
        let whole = match &self.triangles {
            Triangles::Small(all) => {
                is_small(n) && all.iter().flatten().all(|&v| usize::from(v) < n)
            }
            Triangles::Large(all) => {
                !is_small(n) && all.iter().flatten().all(|&v| (v as usize) < n)
            }
        };
        rule(whole, "a triangle has no such vertex")?;
        let coloured = self.vertex_colours.len();
        rule(
            coloured == 0 || coloured == n,
            "a mesh has neither one colour for each vertex nor none",
        )?;
        let finished = self.finishes.len();
        rule(
            finished == 0 || finished == n,
            "a mesh has neither one finish for each vertex nor none",
        )
    }
}

fn is_small(vertices: usize) -> bool {
    vertices <= 1 << 16
}
