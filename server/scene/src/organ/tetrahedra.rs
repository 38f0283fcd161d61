//! Tetrahedra for a closed surface by isosurface stuffing, for the finite elements of an organ.
//!
//! Source: Labelle and Shewchuk 2007, doi:10.1145/1276377.1276448.
//!
//! The tetrahedra of a body-centred cubic lattice fill space. Their dihedral angles are 60 and 90 degrees.
//!
//! The cut point of an edge that crosses the surface is found on the true signed distance. A lattice node too near to
//! a cut point is moved onto it. Tetrahedra that still cross are cut, and their outer parts dropped.
//!
//! If a moved node would make two sides of a narrow gap touch, the node stays and the cut point is moved.
//!
//! For every surface, no tetrahedron turns inside out, and every dihedral angle is between 10.5 and 163.8 degrees. A
//! test measures these limits over all cuts. The paper proves 10.7 and 164.8 for its own constants.
//!
//! The surface affects only how closely it is followed.
//!
//! Details smaller than an edge are smoothed away or missed: a thin wall, a narrow gap, a sharp edge.

mod error;
mod lattice;
mod pieces;
mod stencil;

use std::collections::BTreeSet;

use sulcus_core::Vec3;
use sulcus_fem::TetMesh;

use crate::mesh::TriMesh;
use crate::mesh::check::check;
use crate::mesh::distance::MeshDistance;
use crate::parallel;
use lattice::{Filled, Lattice};
use pieces::Piece;

pub use error::TetraError;
pub use lattice::MOST_NODES;
pub use pieces::MOST_APART;

/// Largest number of rounds in which nodes are fixed where the boundary touches itself.
///
/// Each round fixes more nodes, and the boundary cannot touch itself between fixed ones.
const ROUNDS: usize = 32;

/// Fills a closed surface with quadratic tetrahedra, middle nodes on straight edges, nothing held.
///
/// `size` is the edge of the lattice's cubes, metres; its other edges are 0.87 of it. `progress` receives the share
/// that is done, up to 1.
///
/// Corners on the boundary lie on the surface, within a billionth of `size`.
///
/// If two sides of the surface are nearer than an edge, a few corners may be up to 0.35 of `size` off, so that the
/// sides do not touch.
///
/// The result is a function of the arguments alone, for any number of threads.
///
/// # Errors
/// [`TetraError`] in these cases.
///
/// - The surface is no solid.
/// - `size` is not a length, or would need more nodes than [`MOST_NODES`].
/// - No tetrahedron is inside.
/// - More than [`MOST_APART`] of the volume is disconnected.
/// - The boundary is not that of a solid.
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

/// Returns the largest piece.
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

/// Holds the nodes at which `is_held` returns true, along all axes. Returns their number.
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

/// Returns the surface of a mesh, outward: triangles between the corners of its tetrahedra, metres.
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

/// Returns the smallest and largest angle between two faces of a tetrahedron of the mesh, degrees, from the corners.
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
