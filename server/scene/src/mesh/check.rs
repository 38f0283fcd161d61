//! Check that a mesh is a solid: finite, of plausible size, closed, manifold, consistently oriented, outward, one
//! piece.
//!
//! Faults are refused with numbers and places, never repaired. Places are millimetres in the frame of the file.

use std::fmt;

use serde::Serialize;
use sulcus_core::Vec3;

use crate::mesh::TriMesh;
pub use crate::mesh::edges::Opening;
use crate::mesh::edges::{
    Length, Place, Sets, Side, by_edge, first_few, open_sides, openings, rounded, sides,
};
use crate::mesh::load::Unit;
use crate::mesh::repair::SMALL_HOLE_SHARE;
use crate::mesh::size::{Size, advice, expected};

/// Least enclosed volume as a share of the cube of the size; less is rounding. A needle a thousand times as long as
/// thick encloses a millionth.
pub const LEAST_VOLUME_SHARE: f64 = 1e-9;

/// Measures of a valid mesh.
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

/// Reason why a mesh cannot be used. `file` is its file or another name of the mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// The mesh is empty.
    #[error("{file}: found no triangle, expected a closed surface")]
    Empty {
        /// Name of the mesh.
        file: String,
    },
    /// A triangle names a vertex that does not exist.
    #[error("{file}: triangle {triangle} names vertex {vertex}, expected one of {vertices}")]
    Index {
        /// Name of the mesh.
        file: String,
        /// The triangle.
        triangle: usize,
        /// The vertex it names.
        vertex: u32,
        /// Number of vertices.
        vertices: usize,
    },
    /// A coordinate is not a number.
    #[error("{file}: vertex {vertex} is ({}, {}, {}), expected finite coordinates", found[0], found[1], found[2])]
    NotFinite {
        /// Name of the mesh.
        file: String,
        /// The vertex.
        vertex: usize,
        /// Its coordinates.
        found: [f64; 3],
    },
    /// The size is implausible, mostly because of a wrong unit.
    #[error("{file}: found an overall size of {} mm, expected {}: {}", Length(*size_mm), expected(*of), advice(*size_mm, *of, *unit))]
    Scale {
        /// Name of the mesh.
        file: String,
        /// Longest edge of the bounding box, millimetres.
        size_mm: f64,
        /// Kind of object that was expected.
        of: Size,
        /// Unit of the reading, if known.
        unit: Option<Unit>,
    },
    /// The surface has holes.
    #[error(
        "{file}: found {edges} open edges in {} ({}), expected a closed surface without holes (of those in files, small ones up to {} % of the size are closed on reading{})",
        counted(openings.len(), "hole"), first_few(openings), 100.0 * SMALL_HOLE_SHARE, base_advice(openings)
    )]
    Open {
        /// Name of the mesh.
        file: String,
        /// Edges with one triangle only.
        edges: usize,
        /// Openings, widest first.
        openings: Vec<Opening>,
    },
    /// More than two triangles share an edge.
    #[error(
        "{file}: found {} shared by more than two triangles (non-manifold), the first at {} mm, expected exactly two everywhere",
        counted(*edges, "edge"), Place(*at_mm)
    )]
    NonManifold {
        /// Name of the mesh.
        file: String,
        /// Such edges.
        edges: usize,
        /// Middle of the first one, mm.
        at_mm: [f64; 3],
    },
    /// Neighbouring triangles face opposite ways.
    #[error(
        "{file}: found {} whose two triangles face opposite ways, the first at {} mm, expected all triangles to face outwards",
        counted(*edges, "edge"), Place(*at_mm)
    )]
    Flipped {
        /// Name of the mesh.
        file: String,
        /// Such edges.
        edges: usize,
        /// Middle of the first one, mm.
        at_mm: [f64; 3],
    },
    /// Two parts of the surface touch in one vertex.
    #[error(
        "{file}: found {} where the surface touches itself, the first at {} mm, expected a manifold",
        if *vertices == 1 { "1 vertex".to_owned() } else { format!("{vertices} vertices") }, Place(*at_mm)
    )]
    Pinched {
        /// Name of the mesh.
        file: String,
        /// Such vertices.
        vertices: usize,
        /// The first one, mm.
        at_mm: [f64; 3],
    },
    /// More than one piece.
    #[error(
        "{file}: found {} separate pieces ({}), expected one (`--keep-largest`, or `keep_largest = true` in a scene file, drops all but the largest)",
        pieces.len(), first_few(pieces)
    )]
    Pieces {
        /// Name of the mesh.
        file: String,
        /// The pieces, most triangles first.
        pieces: Vec<Piece>,
    },
    /// All triangles face inwards, or no volume is enclosed.
    #[error(
        "{file}: found an enclosed volume of {volume_mm3} mm3 between {} and {} mm, expected a positive one (triangles facing outwards)",
        Place(*low_mm), Place(*high_mm)
    )]
    InsideOut {
        /// Name of the mesh.
        file: String,
        /// The signed volume, cubic millimetres.
        volume_mm3: f64,
        /// Lowest corner of its box, mm.
        low_mm: [f64; 3],
        /// Highest corner of its box, mm.
        high_mm: [f64; 3],
    },
    /// The enclosed volume is so small that it is rounding.
    #[error(
        "{file}: found an enclosed volume of {volume_mm3:.1e} mm3 between {} and {} mm, which is flat, expected a solid",
        Place(*low_mm), Place(*high_mm)
    )]
    Flat {
        /// Name of the mesh.
        file: String,
        /// The signed volume, cubic millimetres.
        volume_mm3: f64,
        /// Lowest corner of its box, mm.
        low_mm: [f64; 3],
        /// Highest corner of its box, mm.
        high_mm: [f64; 3],
    },
}

/// A connected part of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece {
    /// Its triangles.
    pub triangles: usize,
    /// Lowest corner of its box, mm.
    pub low_mm: [f64; 3],
    /// Highest corner of its box, mm.
    pub high_mm: [f64; 3],
}

impl fmt::Display for Piece {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (low, high) = (Place(self.low_mm), Place(self.high_mm));
        let triangles = counted(self.triangles, "triangle");
        write!(f, "{triangles} between {low} and {high} mm")
    }
}

/// Returns the advice to close a scan without a base, if there is exactly one hole.
fn base_advice(openings: &[Opening]) -> &'static str {
    match openings {
        [_] => {
            "; `--close-base`, or `close_base = true` in a scene file, closes the one flat opening of a scan without base"
        }
        _ => "",
    }
}

fn counted(count: usize, what: &str) -> String {
    match count {
        1 => format!("1 {what}"),
        _ => format!("{count} {what}s"),
    }
}

/// Checks a mesh. Messages name it as `file`.
///
/// # Errors
/// [`MeshError`] with the first fault, the value found and the value expected.
pub fn check(mesh: &TriMesh, file: &str) -> Result<MeshReport, MeshError> {
    check_as(mesh, file, Size::Any, None)
}

/// Checks a mesh of a kind that was read in a unit.
///
/// # Errors
/// Errors of [`check`], and an implausible size for the kind.
pub fn check_as(
    mesh: &TriMesh,
    file: &str,
    of: Size,
    unit: Option<Unit>,
) -> Result<MeshReport, MeshError> {
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
    let size_mm = size.max() * 1e3;
    if !of.holds(size_mm) {
        return Err(MeshError::Scale {
            file: file(),
            size_mm,
            of,
            unit,
        });
    }
    let sides = sides(mesh);
    let middle = |side: &Side| -> [f64; 3] {
        let [a, b] = side.walked().map(|v| mesh.vertices[v as usize]);
        ((a + b) * 0.5e3).into()
    };
    let edges = Edges::of(&sides);
    if let Some(first) = edges.first_crowded {
        return Err(MeshError::NonManifold {
            file: file(),
            edges: edges.crowded,
            at_mm: middle(&first),
        });
    }
    // This check follows that of edges with too many triangles: a triangle on a surface has two open edges, but is no
    // hole.
    let open = open_sides(&sides);
    if !open.is_empty() {
        return Err(MeshError::Open {
            file: file(),
            edges: open.len(),
            openings: openings(mesh, &open),
        });
    }
    if let Some(first) = edges.first_flipped {
        return Err(MeshError::Flipped {
            file: file(),
            edges: edges.flipped,
            at_mm: middle(&first),
        });
    }
    let pinched = pinched(mesh);
    if let Some(&first) = pinched.first() {
        return Err(MeshError::Pinched {
            file: file(),
            vertices: pinched.len(),
            at_mm: (mesh.vertices[first as usize] * 1e3).into(),
        });
    }
    let (pieces, used) = pieces(mesh);
    if pieces.len() > 1 {
        return Err(MeshError::Pieces {
            file: file(),
            pieces,
        });
    }
    let volume_mm3 = rounded(mesh.signed_volume() * 1e9);
    let (low_mm, high_mm) = ((low * 1e3).into(), (high * 1e3).into());
    let least_mm3 = LEAST_VOLUME_SHARE * 1e9 * size.max() * size.max() * size.max();
    if volume_mm3.abs() <= least_mm3 {
        return Err(MeshError::Flat {
            file: file(),
            volume_mm3,
            low_mm,
            high_mm,
        });
    }
    if volume_mm3 < 0.0 {
        return Err(MeshError::InsideOut {
            file: file(),
            volume_mm3,
            low_mm,
            high_mm,
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

#[derive(Default)]
struct Edges {
    total: usize,
    crowded: usize,
    first_crowded: Option<Side>,
    flipped: usize,
    first_flipped: Option<Side>,
}

impl Edges {
    fn of(sides: &[Side]) -> Self {
        let mut edges = Edges::default();
        for edge in by_edge(sides) {
            edges.total += 1;
            if edge.len() > 2 {
                edges.crowded += 1;
                edges.first_crowded.get_or_insert(edge[0]);
            } else if edge.len() == 2 && edge[0].forward == edge[1].forward {
                edges.flipped += 1;
                edges.first_flipped.get_or_insert(edge[0]);
            }
        }
        edges
    }
}

/// Returns the vertices whose triangles form more than one fan. The surface must be oriented and closed.
fn pinched(mesh: &TriMesh) -> Vec<u32> {
    // Around a vertex v each triangle leads from one neighbour to the next: (v, from) -> to.
    let mut steps: Vec<(u32, u32, u32)> = Vec::with_capacity(mesh.triangles.len() * 3);
    for &[a, b, c] in &mesh.triangles {
        steps.extend([(a, b, c), (b, c, a), (c, a, b)]);
    }
    steps.sort_unstable();
    let mut pinched = Vec::new();
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
        if walked != fan.len() {
            pinched.push(fan[0].0);
        }
    }
    pinched
}

/// The connected pieces, most triangles first, and the number of vertices that belong to a triangle.
fn pieces(mesh: &TriMesh) -> (Vec<Piece>, usize) {
    let mut sets = Sets::new(mesh.vertices.len());
    let mut used = vec![false; mesh.vertices.len()];
    for &[a, b, c] in &mesh.triangles {
        for v in [a, b, c] {
            used[v as usize] = true;
            sets.join(a, v);
        }
    }
    let mut piece_of = vec![usize::MAX; mesh.vertices.len()];
    let mut pieces: Vec<(usize, Vec3, Vec3)> = Vec::new();
    for triangle in &mesh.triangles {
        let set = sets.find(triangle[0]) as usize;
        if piece_of[set] == usize::MAX {
            piece_of[set] = pieces.len();
            let corner = mesh.vertices[set];
            pieces.push((0, corner, corner));
        }
        let piece = &mut pieces[piece_of[set]];
        piece.0 += 1;
        for v in triangle.map(|v| mesh.vertices[v as usize]) {
            piece.1 = piece.1.zip_map(&v, sulcus_core::math::fmin);
            piece.2 = piece.2.zip_map(&v, sulcus_core::math::fmax);
        }
    }
    pieces.sort_by_key(|piece| std::cmp::Reverse(piece.0));
    let pieces = pieces.into_iter().map(|(triangles, low, high)| Piece {
        triangles,
        low_mm: (low * 1e3).into(),
        high_mm: (high * 1e3).into(),
    });
    (pieces.collect(), used.iter().filter(|&&used| used).count())
}
