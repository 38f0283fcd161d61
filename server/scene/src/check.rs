//! Whether a mesh is a solid that can be touched: finite, of plausible size, closed, manifold,
//! consistently oriented, outward, one piece. What fails is refused with numbers, never repaired.

use serde::Serialize;
use sulcus_core::Vec3;

use crate::mesh::TriMesh;

/// Smallest and largest plausible overall size (longest edge of the bounding box), metres.
pub const PLAUSIBLE_SIZE_M: (f64, f64) = (0.5e-3, 0.5);

/// What a usable mesh is like.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MeshReport {
    /// Number of vertices.
    pub vertices: usize,
    /// Number of triangles.
    pub triangles: usize,
    /// Edges of the bounding box, millimetres.
    pub size_mm: [f64; 3],
    /// Enclosed volume, cubic millimetres.
    pub volume_mm3: f64,
    /// Surface area, square millimetres.
    pub area_mm2: f64,
    /// Handles through the solid: 0 for a ball, 1 for a ring.
    pub genus: i64,
}

/// Why a mesh cannot be used. `file` is the file, or what else the mesh is called.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// There is nothing in it.
    #[error("{file}: found no triangle, expected a closed surface")]
    Empty {
        /// Which mesh.
        file: String,
    },
    /// A triangle names a vertex that is not there.
    #[error("{file}: triangle {triangle} names vertex {vertex}, expected one of {vertices}")]
    Index {
        /// Which mesh.
        file: String,
        /// The triangle.
        triangle: usize,
        /// The vertex it names.
        vertex: u32,
        /// How many there are.
        vertices: usize,
    },
    /// A coordinate is not a number.
    #[error("{file}: vertex {vertex} is ({}, {}, {}), expected finite coordinates", found[0], found[1], found[2])]
    NotFinite {
        /// Which mesh.
        file: String,
        /// The vertex.
        vertex: usize,
        /// Its coordinates.
        found: [f64; 3],
    },
    /// Implausible size, mostly a wrong unit.
    #[error(
        "{file}: found an overall size of {size_mm} mm, expected 0.5 to 500 mm: is it in another unit?"
    )]
    Scale {
        /// Which mesh.
        file: String,
        /// Longest edge of the bounding box, millimetres.
        size_mm: f64,
    },
    /// The surface has holes.
    #[error("{file}: found {edges} open edges, expected a closed surface without holes")]
    Open {
        /// Which mesh.
        file: String,
        /// Edges with one triangle only.
        edges: usize,
    },
    /// More than two triangles share an edge.
    #[error(
        "{file}: found {edges} edges shared by more than two triangles, expected exactly two everywhere"
    )]
    NonManifold {
        /// Which mesh.
        file: String,
        /// Such edges.
        edges: usize,
    },
    /// Neighbouring triangles face opposite ways.
    #[error(
        "{file}: found {edges} edges whose two triangles face opposite ways, expected all triangles to face outwards"
    )]
    Flipped {
        /// Which mesh.
        file: String,
        /// Such edges.
        edges: usize,
    },
    /// Two parts of the surface touch in one vertex.
    #[error(
        "{file}: found {vertices} vertices where the surface touches itself, expected a manifold"
    )]
    Pinched {
        /// Which mesh.
        file: String,
        /// Such vertices.
        vertices: usize,
    },
    /// More than one piece.
    #[error("{file}: found {pieces} separate pieces, expected one")]
    Pieces {
        /// Which mesh.
        file: String,
        /// How many.
        pieces: usize,
    },
    /// All triangles face inwards, or nothing is enclosed.
    #[error(
        "{file}: found an enclosed volume of {volume_mm3} mm3, expected a positive one (triangles facing outwards)"
    )]
    InsideOut {
        /// Which mesh.
        file: String,
        /// The signed volume, cubic millimetres.
        volume_mm3: f64,
    },
}

/// Checks a mesh; `file` is how messages call it.
///
/// # Errors
/// The first thing that makes it unusable, with what was found and what was expected.
pub fn check(mesh: &TriMesh, file: &str) -> Result<MeshReport, MeshError> {
    let file = || file.to_owned();
    if mesh.triangles.is_empty() {
        return Err(MeshError::Empty { file: file() });
    }
    let vertices = mesh.vertices.len();
    for (triangle, corners) in mesh.triangles.iter().enumerate() {
        if let Some(&vertex) = corners.iter().find(|&&v| v as usize >= vertices) {
            return Err(MeshError::Index {
                file: file(),
                triangle,
                vertex,
                vertices,
            });
        }
    }
    if let Some(vertex) = mesh
        .vertices
        .iter()
        .position(|v| !v.iter().all(|x| x.is_finite()))
    {
        return Err(MeshError::NotFinite {
            file: file(),
            vertex,
            found: mesh.vertices[vertex].into(),
        });
    }
    let (low, high) = mesh.bounds();
    let size: Vec3 = high - low;
    if !(PLAUSIBLE_SIZE_M.0..=PLAUSIBLE_SIZE_M.1).contains(&size.max()) {
        return Err(MeshError::Scale {
            file: file(),
            size_mm: rounded(size.max() * 1e3),
        });
    }
    let edges = Edges::of(mesh);
    if edges.open > 0 {
        return Err(MeshError::Open {
            file: file(),
            edges: edges.open,
        });
    }
    if edges.crowded > 0 {
        return Err(MeshError::NonManifold {
            file: file(),
            edges: edges.crowded,
        });
    }
    if edges.flipped > 0 {
        return Err(MeshError::Flipped {
            file: file(),
            edges: edges.flipped,
        });
    }
    let pinched = pinched(mesh);
    if pinched > 0 {
        return Err(MeshError::Pinched {
            file: file(),
            vertices: pinched,
        });
    }
    let (pieces, used) = pieces(mesh);
    if pieces > 1 {
        return Err(MeshError::Pieces {
            file: file(),
            pieces,
        });
    }
    let volume_mm3 = rounded(mesh.signed_volume() * 1e9);
    if volume_mm3 <= 0.0 {
        return Err(MeshError::InsideOut {
            file: file(),
            volume_mm3,
        });
    }
    let euler = used as i64 - edges.total as i64 + mesh.triangles.len() as i64;
    Ok(MeshReport {
        vertices,
        triangles: mesh.triangles.len(),
        size_mm: size.map(|x| rounded(x * 1e3)).into(),
        volume_mm3,
        area_mm2: rounded(mesh.area() * 1e6),
        genus: 1 - euler / 2,
    })
}

/// Three decimals, for reading.
fn rounded(x: f64) -> f64 {
    if x.abs() < 1e-3 {
        x
    } else {
        (x * 1e3).round() / 1e3
    }
}

#[derive(Default)]
struct Edges {
    total: usize,
    open: usize,
    crowded: usize,
    flipped: usize,
}

impl Edges {
    fn of(mesh: &TriMesh) -> Self {
        let mut all: Vec<(u32, u32, bool)> = Vec::with_capacity(mesh.triangles.len() * 3);
        for &[a, b, c] in &mesh.triangles {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                all.push((from.min(to), from.max(to), from < to));
            }
        }
        all.sort_unstable();
        let mut edges = Edges::default();
        for same in all.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            edges.total += 1;
            match same {
                [_] => edges.open += 1,
                [one, other] => edges.flipped += usize::from(one.2 == other.2),
                _ => edges.crowded += 1,
            }
        }
        edges
    }
}

/// Number of vertices whose triangles form more than one fan. Needs an oriented closed surface.
fn pinched(mesh: &TriMesh) -> usize {
    // Around a vertex v each triangle leads from one neighbour to the next: (v, from) -> to.
    let mut steps: Vec<(u32, u32, u32)> = Vec::with_capacity(mesh.triangles.len() * 3);
    for &[a, b, c] in &mesh.triangles {
        steps.extend([(a, b, c), (b, c, a), (c, a, b)]);
    }
    steps.sort_unstable();
    let mut pinched = 0;
    for fan in steps.chunk_by(|a, b| a.0 == b.0) {
        let start = fan[0].1;
        let (mut at, mut walked) = (start, 0);
        while let Ok(found) = fan.binary_search_by_key(&at, |step| step.1) {
            at = fan[found].2;
            walked += 1;
            if at == start || walked > fan.len() {
                break;
            }
        }
        pinched += usize::from(walked != fan.len());
    }
    pinched
}

/// Number of connected pieces, and of vertices that belong to a triangle.
fn pieces(mesh: &TriMesh) -> (usize, usize) {
    let mut parent: Vec<u32> = (0..mesh.vertices.len() as u32).collect();
    fn root(parent: &mut [u32], mut v: u32) -> u32 {
        while parent[v as usize] != v {
            parent[v as usize] = parent[parent[v as usize] as usize];
            v = parent[v as usize];
        }
        v
    }
    let mut used = vec![false; mesh.vertices.len()];
    for &[a, b, c] in &mesh.triangles {
        for v in [a, b, c] {
            used[v as usize] = true;
        }
        for other in [b, c] {
            let (one, two) = (root(&mut parent, a), root(&mut parent, other));
            parent[two as usize] = one;
        }
    }
    let roots = (0..parent.len())
        .filter(|&v| used[v] && parent[v] as usize == v)
        .count();
    (roots, used.iter().filter(|&&u| u).count())
}
