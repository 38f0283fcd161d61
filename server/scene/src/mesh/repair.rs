//! Repair of faults that have one right repair. [`Repairs`] counts and locates all of them.
//!
//! The modules of this folder and this file depend on each other: this file runs their steps in order, and they use
//! its limits and its `drop_unused`.
//!
//! Repairs are made in this order.
//!
//! - Vertices of no triangle are dropped.
//! - Vertices in one place are joined where an edge is open or a triangle has no length.
//! - Vertices nearly in one place ([`WELD_SHARE`]) are joined where that closes open edges.
//! - Degenerate and duplicate triangles are dropped.
//! - Triangles are turned to agree with the majority of their neighbours.
//! - Small holes ([`SMALL_HOLE_SHARE`], [`MISSING_TRIANGLE_SHARE`], [`LONGEST_RIM`]) are closed.
//! - A closed surface that faces inwards is turned outward.
//!
//! Two repairs are made on request only ([`Asked`]): all pieces except the largest are dropped, and the one opening
//! of a scan without base is closed by a flat lid.
//!
//! Other faults stay, and [`crate::mesh::check`] refuses them: large holes, edges with more than two triangles,
//! surfaces that touch themselves, several pieces, no enclosed volume.
//!
//! A mesh without faults is returned bit by bit.

mod base;
mod fill;
mod holes;
mod orient;
mod pieces;
mod weld;

use std::fmt;

use serde::Serialize;
use sulcus_core::Vec3;

use crate::mesh::TriMesh;
use crate::mesh::edges::{Length, Opening, Place, first_few, open_sides, rounded, sides};

pub use base::{BASE_FLAT_SHARE, ClosedBase};
pub use pieces::DroppedPieces;
pub(crate) use weld::join_equal;

/// Largest distance between two vertices on open edges that count as one place, as a share of the diagonal of the
/// mesh's box.
///
/// For a tooth the distance is 0.25 um: above the noise of single precision, far below the resolution of a scanner.
/// Edges are never collapsed.
pub const WELD_SHARE: f64 = 1e-5;

/// Largest width of a small hole, which is closed, as a share of the diagonal of the mesh's box: about 1.2 mm for a
/// tooth.
///
/// Wider holes may be intended, or hide a surface of unknown shape.
pub const SMALL_HOLE_SHARE: f64 = 0.05;

/// Largest width of a hole with three edges. It is one missing triangle, which has one right repair.
pub const MISSING_TRIANGLE_SHARE: f64 = 0.2;

/// Largest number of edges of a small hole.
pub const LONGEST_RIM: usize = 64;

/// Repairs that change the drawn shape, made on request only.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Asked {
    /// Keeps the piece with the largest area and drops all others.
    pub keep_largest: bool,
    /// Closes the one remaining opening by a lid, if its rim is nearly flat.
    pub close_base: bool,
}

/// Repairs made. All are zero for a mesh without faults.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Repairs {
    /// Vertices that no triangle used, dropped.
    pub unused_vertices: usize,
    /// Vertices that lay exactly in the place of another and were joined with it.
    pub duplicate_vertices: usize,
    /// Vertices that lay nearly in the place of another and were welded to it.
    pub welded_vertices: usize,
    /// Largest distance over which a vertex was welded, mm.
    pub largest_weld_mm: f64,
    /// Triangles with two corners in one place, dropped.
    pub degenerate_triangles: usize,
    /// Triangles with the same corners as another, dropped.
    pub duplicate_triangles: usize,
    /// Triangles turned to agree with their neighbours.
    pub turned_triangles: usize,
    /// Centre of the first triangle turned, mm.
    pub first_turned_mm: Option<[f64; 3]>,
    /// Holes that were closed.
    pub holes: Vec<ClosedHole>,
    /// Whether the surface was inside out as a whole and was turned.
    pub turned_outward: bool,
    /// Pieces that were dropped on request.
    pub dropped: Option<DroppedPieces>,
    /// The base that was closed on request.
    pub base: Option<ClosedBase>,
    /// The openings of a mesh whose base could not be closed as requested.
    pub base_refused: Option<String>,
}

/// A hole that was closed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClosedHole {
    /// Edges of its rim.
    pub edges: usize,
    /// Largest distance between two vertices of its rim, mm.
    pub diameter_mm: f64,
    /// Mean of the vertices of its rim, mm, in the mesh's frame.
    pub at_mm: [f64; 3],
}

impl From<Opening> for ClosedHole {
    fn from(opening: Opening) -> Self {
        Self {
            edges: opening.edges,
            diameter_mm: rounded(opening.diameter_mm),
            at_mm: opening.at_mm.map(rounded),
        }
    }
}

impl fmt::Display for ClosedHole {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (edges, across, at) = (self.edges, Length(self.diameter_mm), Place(self.at_mm));
        write!(f, "{edges} edges, {across} mm across, at {at} mm")
    }
}

impl Repairs {
    /// Returns whether no repair was made.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Returns one sentence for each kind of repair, with numbers and places in mm.
    pub fn sentences(&self) -> Vec<String> {
        let counted = |count: usize, one: &str, many: &str| match count {
            1 => format!("1 {one} was"),
            _ => format!("{count} {many} were"),
        };
        let vertices = |count| counted(count, "vertex", "vertices");
        let triangles = |count| counted(count, "triangle", "triangles");
        let mut said = Vec::new();
        if let Some(dropped) = &self.dropped {
            said.push(format!(
                "{} dropped because only the largest piece was requested: {} triangles, the largest {} mm across; {} triangles with {} mm2 were kept",
                counted(dropped.pieces, "piece", "pieces"),
                dropped.triangles,
                Length(dropped.largest_mm),
                dropped.kept_triangles,
                Length(dropped.kept_area_mm2)
            ));
        }
        if let Some(base) = &self.base {
            said.push(format!("the open base was closed on request: {base}"));
        }
        if let Some(found) = &self.base_refused {
            said.push(format!("the open base was not closed: found {found}"));
        }
        if self.unused_vertices > 0 {
            let vertices = vertices(self.unused_vertices);
            said.push(format!("{vertices} dropped because no triangle used them"));
        }
        if self.duplicate_vertices > 0 {
            let vertices = vertices(self.duplicate_vertices);
            said.push(format!("{vertices} joined with another in the same place"));
        }
        if self.welded_vertices > 0 {
            said.push(format!(
                "{} welded to another no farther away than {} mm",
                vertices(self.welded_vertices),
                Length(self.largest_weld_mm)
            ));
        }
        if self.degenerate_triangles > 0 {
            let triangles = triangles(self.degenerate_triangles);
            said.push(format!(
                "{triangles} dropped because two corners were in one place"
            ));
        }
        if self.duplicate_triangles > 0 {
            let triangles = triangles(self.duplicate_triangles);
            said.push(format!(
                "{triangles} dropped because another had the same corners"
            ));
        }
        if self.turned_triangles > 0 {
            said.push(format!(
                "{} turned to agree with their neighbours, the first at {} mm",
                triangles(self.turned_triangles),
                Place(self.first_turned_mm.unwrap_or_default())
            ));
        }
        if !self.holes.is_empty() {
            said.push(format!(
                "{} closed ({})",
                counted(self.holes.len(), "small hole", "small holes"),
                first_few(&self.holes)
            ));
        }
        if self.turned_outward {
            said.push("the whole surface faced inwards and was turned outward".to_owned());
        }
        said
    }
}

impl fmt::Display for Repairs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_empty() {
            return write!(f, "nothing was repaired");
        }
        write!(f, "{}", self.sentences().join("\n"))
    }
}

/// Repairs a mesh.
///
/// The mesh may have any content. If it names vertices that do not exist, or has coordinates that are not finite, it
/// is returned unchanged.
pub fn repair(mesh: TriMesh) -> (TriMesh, Repairs) {
    repair_as(mesh, &Asked::default())
}

/// Repairs a mesh, and makes the requested repairs.
pub fn repair_as(mut mesh: TriMesh, asked: &Asked) -> (TriMesh, Repairs) {
    let mut done = Repairs::default();
    let vertices = mesh.vertices.len() as u64;
    if mesh
        .triangles
        .iter()
        .flatten()
        .any(|&v| u64::from(v) >= vertices)
    {
        return (mesh, done);
    }
    done.unused_vertices = drop_unused(&mut mesh);
    let (low, high) = mesh.bounds();
    let mut size = (high - low).norm();
    // The test also fails if a coordinate or the size is not finite.
    if !(size > 0.0 && size.is_finite() && mesh.vertices.iter().flatten().all(|x| x.is_finite())) {
        return (mesh, done);
    }

    done.duplicate_vertices = weld::duplicates(&mut mesh);
    let welded = weld::nearly(&mut mesh, WELD_SHARE * size);
    done.welded_vertices = welded.vertices;
    done.largest_weld_mm = welded.largest * 1e3;
    (done.degenerate_triangles, done.duplicate_triangles) = drop_useless(&mut mesh);
    if asked.keep_largest {
        done.dropped = pieces::keep_largest(&mut mesh);
        let (low, high) = mesh.bounds();
        size = (high - low).norm();
    }
    let turned = orient::agree(&mut mesh);
    done.turned_triangles = turned.len();
    done.first_turned_mm = turned.first().map(|&triangle| {
        let sum: Vec3 = mesh.corners(triangle as usize).iter().sum();
        (sum * (1e3 / 3.0)).map(rounded).into()
    });
    done.holes = holes::close(&mut mesh, size);
    if asked.close_base {
        match base::close(&mut mesh) {
            Ok(closed) => done.base = closed,
            Err(found) => done.base_refused = Some(found),
        }
    }
    done.turned_outward = orient::outward(&mut mesh);
    drop_unused(&mut mesh);
    (mesh, done)
}

/// Drops vertices of no triangle; the others keep their order. Returns their number.
pub(crate) fn drop_unused(mesh: &mut TriMesh) -> usize {
    let mut used = vec![false; mesh.vertices.len()];
    for &v in mesh.triangles.iter().flatten() {
        used[v as usize] = true;
    }
    let unused = used.iter().filter(|used| !**used).count();
    // An empty mesh is left to the check, with its vertices.
    if unused == 0 || mesh.triangles.is_empty() {
        return 0;
    }
    let mut next = 0;
    let new: Vec<u32> = used
        .iter()
        .map(|&used| {
            let index = next;
            next += u32::from(used);
            index
        })
        .collect();
    let mut at = 0;
    mesh.vertices.retain(|_| {
        at += 1;
        used[at - 1]
    });
    for v in mesh.triangles.iter_mut().flatten() {
        *v = new[*v as usize];
    }
    unused
}

/// Drops triangles with two equal corners, and all but the first of those with the same corners in any order. Returns
/// both numbers.
fn drop_useless(mesh: &mut TriMesh) -> (usize, usize) {
    let before = mesh.triangles.len();
    mesh.triangles
        .retain(|&[a, b, c]| a != b && b != c && c != a);
    let degenerate = before - mesh.triangles.len();
    let mut keys: Vec<([u32; 3], u32)> = mesh
        .triangles
        .iter()
        .zip(0..)
        .map(|(triangle, index)| {
            let mut corners = *triangle;
            corners.sort_unstable();
            (corners, index)
        })
        .collect();
    keys.sort_unstable();
    let mut double = vec![false; mesh.triangles.len()];
    for pair in keys.windows(2) {
        double[pair[1].1 as usize] = pair[0].0 == pair[1].0;
    }
    let mut at = 0;
    mesh.triangles.retain(|_| {
        at += 1;
        !double[at - 1]
    });
    (degenerate, double.iter().filter(|double| **double).count())
}

/// Returns whether every edge has two triangles in opposite directions.
fn closed(mesh: &TriMesh) -> bool {
    let sides = sides(mesh);
    open_sides(&sides).is_empty()
        && crate::mesh::edges::by_edge(&sides)
            .all(|edge| edge.len() == 2 && edge[0].forward != edge[1].forward)
}
