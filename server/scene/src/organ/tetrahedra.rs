//! Tetrahedra for a closed surface by isosurface stuffing (Labelle and Shewchuk 2007, doi:10.1145/1276377.1276448): what
//! finite elements of an organ need, without an outside mesher.
//!
//! Space is filled with the tetrahedra of a body-centred cubic lattice, whose dihedral angles are 60 and 90 degrees. Where an
//! edge crosses the surface its cut point is found on the true signed distance. A lattice node that a cut point comes too
//! near to is moved onto it; the tetrahedra that still cross are cut and their outer parts dropped. Where that would let two
//! sides of a narrow gap touch, the node stays and the cut point is moved.
//!
//! Whatever the surface is, no tetrahedron turns inside out and every dihedral angle stays over 10.5 and under 163.8 degrees:
//! so a test measures over all ways to be cut; the paper proves 10.7 and 164.8 for its own constants. Only how well the
//! surface is followed depends on it.
//!
//! What is smaller than an edge (a thin wall, a narrow gap, a sharp edge) is smoothed away or missed.

mod lattice;
mod pieces;
mod stencil;

use std::collections::BTreeSet;

use sulcus_core::Vec3;
use sulcus_fem::{FemError, TetMesh};

use crate::mesh::TriMesh;
use crate::mesh::check::{MeshError, check};
use crate::mesh::distance::MeshDistance;
use crate::parallel;
use lattice::{Filled, Lattice};
use pieces::Piece;

/// Most nodes of the lattice around the surface; what is inside has six tetrahedra for each.
pub const MOST_NODES: f64 = 2e6;

/// Largest share of the volume that may hang apart from the largest piece; it is left out.
pub const MOST_APART: f64 = 0.01;

/// Most times that nodes are fixed where the boundary touches itself. More are each time, and between fixed ones it cannot.
const ROUNDS: usize = 32;

/// Why a surface cannot be filled.
#[derive(Debug, thiserror::Error)]
pub enum TetraError {
    /// A number is out of range.
    #[error("{field} is {found}, expected {expected}")]
    Field {
        /// What it is.
        field: &'static str,
        /// What it was.
        found: String,
        /// What it may be.
        expected: String,
    },
    /// The surface is not a solid.
    #[error(transparent)]
    Surface(MeshError),
    /// The boundary of the tetrahedra is not that of a solid.
    #[error("lattice of {mm} mm: {error}; choose a smaller size")]
    Boundary {
        /// Edge of the lattice's cubes, mm.
        mm: f64,
        /// What is wrong with the boundary.
        error: MeshError,
    },
    /// The tetrahedra are not what finite elements need.
    #[error(transparent)]
    Mesh(FemError),
}

impl TetraError {
    fn field(field: &'static str, found: impl Into<String>, expected: impl Into<String>) -> Self {
        Self::Field {
            field,
            found: found.into(),
            expected: expected.into(),
        }
    }
}

/// Fills a closed surface with quadratic tetrahedra, middle nodes on straight edges, nothing held. `size` is the edge of the
/// lattice's cubes, metres; its other edges are 0.87 of it. `progress` gets how much is done, up to 1.
///
/// The corners on the boundary lie on the surface, within a billionth of `size`, but for a few where two sides of the surface
/// are nearer to each other than an edge: they may be up to 0.35 of `size` off, so that the sides do not touch. The
/// result is a function of the arguments alone, whatever the number of threads.
///
/// # Errors
/// When the surface is no solid, `size` is not a length or would take more than [`MOST_NODES`], nothing is inside, more than
/// [`MOST_APART`] of the volume hangs apart, or the boundary is not that of a solid.
pub fn tetrahedra(
    surface: &MeshDistance,
    size: f64,
    progress: &dyn Fn(f64),
) -> Result<TetMesh, TetraError> {
    tetrahedra_on(parallel::threads(), surface, size, progress)
}

fn tetrahedra_on(
    threads: usize,
    surface: &MeshDistance,
    size: f64,
    progress: &dyn Fn(f64),
) -> Result<TetMesh, TetraError> {
    if !(size.is_finite() && size > 0.0) {
        let found = format!("{size}");
        return Err(TetraError::field("size", found, "a length over 0, metres"));
    }
    check(surface.mesh(), "surface").map_err(TetraError::Surface)?;
    let (low, high) = surface.mesh().bounds();
    let lattice = Lattice::around(low, high, size)?;
    let sampled = lattice.sample(threads, surface, &|share| progress(0.7 * share));
    let mut fixed = BTreeSet::new();
    let mut piece = largest(&lattice.fill(&sampled, &fixed), size)?;
    for _ in 0..ROUNDS {
        let touching = piece.touching();
        if touching.is_empty() {
            break;
        }
        fixed.extend(touching);
        piece = largest(&lattice.fill(&sampled, &fixed), size)?;
    }
    progress(0.9);
    let mesh = TetMesh::from_corners(piece.nodes, &piece.tets);
    check(&boundary(&mesh), "boundary").map_err(|error| {
        let mm = size * 1e3;
        TetraError::Boundary { mm, error }
    })?;
    mesh.validate().map_err(TetraError::Mesh)?;
    progress(1.0);
    Ok(mesh)
}

/// The largest piece.
fn largest(filled: &Filled, size: f64) -> Result<Piece, TetraError> {
    let mm = size * 1e3;
    pieces::largest(filled).map_err(|apart| match apart {
        None => TetraError::field(
            "number of tetrahedra",
            format!("0 with a lattice of {mm} mm"),
            "at least 1: choose a smaller size",
        ),
        Some((pieces, share)) => TetraError::field(
            "volume apart from the largest piece",
            format!(
                "{:.1} % in {pieces} more with a lattice of {mm} mm",
                100.0 * share
            ),
            format!("at most {} %: choose a smaller size", 100.0 * MOST_APART),
        ),
    })
}

/// Holds the nodes whose place says so along all axes; how many they are.
pub fn hold(mesh: &mut TetMesh, is_held: impl Fn(&Vec3) -> bool) -> usize {
    let mut count = 0;
    for (node, held) in mesh.nodes.iter().zip(&mut mesh.held) {
        if is_held(node) {
            *held = [true; 3];
            count += 1;
        }
    }
    count
}

/// The surface of a mesh, outward: triangles between the corners of its tetrahedra, metres.
pub fn boundary(mesh: &TetMesh) -> TriMesh {
    let mut surface = TriMesh::default();
    let mut new = vec![u32::MAX; mesh.nodes.len()];
    for triangle in mesh.boundary_triangles() {
        surface.triangles.push(triangle.map(|node| {
            let node = node as usize;
            if new[node] == u32::MAX {
                new[node] = surface.vertices.len() as u32;
                surface.vertices.push(mesh.nodes[node]);
            }
            new[node]
        }));
    }
    surface
}

/// Smallest and largest angle between two faces of a tetrahedron of the mesh, degrees, as their corners have it.
pub fn dihedral_angles(mesh: &TetMesh) -> [f64; 2] {
    let degrees = 180.0 / std::f64::consts::PI;
    let mut cosines = [1.0_f64, -1.0];
    for tet in &mesh.tets {
        let corners = [0, 1, 2, 3].map(|k| mesh.nodes[tet[k] as usize]);
        for cosine in stencil::dihedral_cosines(&corners) {
            cosines = [
                sulcus_core::math::fmin(cosines[0], cosine),
                sulcus_core::math::fmax(cosines[1], cosine),
            ];
        }
    }
    [cosines[1], cosines[0]].map(|cosine| libm::acos(cosine) * degrees)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::shapes::ellipsoid;

    #[test]
    fn any_number_of_threads_gives_the_same_bits() {
        let surface = MeshDistance::new(ellipsoid(Vec3::new(0.02, 0.012, 0.007), 4));
        let of = |threads| {
            let mesh = tetrahedra_on(threads, &surface, 1.7e-3, &|_| ()).expect("a mesh");
            let bits = |x: &Vec3| [x.x, x.y, x.z].map(f64::to_bits);
            let nodes: Vec<_> = mesh.nodes.iter().map(bits).collect();
            (nodes, mesh.tets)
        };
        let alone = of(1);
        for threads in 2..6 {
            assert!(of(threads) == alone, "{threads} threads");
        }
    }
}
