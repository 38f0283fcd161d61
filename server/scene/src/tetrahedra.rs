//! Tetrahedra for a closed surface by isosurface stuffing (Labelle and Shewchuk 2007, doi:10.1145/1276377.1276448): what
//! finite elements of an organ need, without an outside mesher.
//!
//! Space is filled with the tetrahedra of a body-centred cubic lattice, whose dihedral angles are 60 and 90 degrees. Where an
//! edge crosses the surface its cut point is found on the true signed distance. A lattice node that a cut point comes too
//! near to is moved onto it; the tetrahedra that still cross are cut and their outer parts dropped. Whatever
//! the surface is, no tetrahedron turns inside out and every dihedral angle stays over 10.5 and under 163.8 degrees (the paper
//! proves 10.7 and 164.8 for its own constants): only how well the surface is followed depends on it.
//!
//! What is smaller than an edge (a thin wall, a narrow gap, a sharp edge) is smoothed away or missed.

mod lattice;
mod pieces;
mod stencil;

use sulcus_core::Vec3;
use sulcus_fem::{FemError, TetMesh};

use crate::check::{MeshError, check};
use crate::distance::MeshDistance;
use crate::mesh::TriMesh;
use crate::parallel;
use lattice::{Filled, Lattice};

/// Most nodes of the lattice around the surface: some hundred megabytes.
pub const MOST_NODES: f64 = 2e6;

/// Largest share of the volume that may hang apart from the largest piece; it is left out.
pub const MOST_APART: f64 = 0.01;

/// Places of the lattice that are tried, until the boundary nowhere touches itself: chance decides whether the two sides of a
/// gap narrower than an edge get an edge in common.
const PLACES: usize = 8;

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
    /// The boundary of the tetrahedra is not that of a solid, wherever the lattice is placed.
    #[error("lattice of {mm} mm: {error}; choose a smaller size")]
    Touching {
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
/// lattice's cubes, metres; its other edges are 0.87 of it. `progress` gets how much is done, up to 1; it starts
/// again when the lattice has to be placed anew.
///
/// The corners on the boundary lie on the surface, within a billionth of `size`. The result is a function of the arguments
/// alone, whatever the number of threads.
///
/// # Errors
/// When the surface is no solid, `size` is not a length or would take more than [`MOST_NODES`], nothing is inside, more than
/// [`MOST_APART`] of the volume hangs apart, or the boundary touches itself.
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
    let mut filled = fill(threads, surface, size, shift(0), progress);
    for place in 1..PLACES {
        if !matches!(filled, Err(TetraError::Touching { .. })) {
            break;
        }
        filled = fill(threads, surface, size, shift(place), progress);
    }
    let (nodes, tets) = filled?;
    let mesh = TetMesh::from_corners(nodes, &tets);
    mesh.validate().map_err(TetraError::Mesh)?;
    progress(1.0);
    Ok(mesh)
}

/// Where the lattice is moved to, in cubes: the additive recurrence that fills space most evenly (powers of the inverse of
/// the root of x^4 = x + 1).
fn shift(place: usize) -> Vec3 {
    Vec3::new(0.819_172_513, 0.671_043_607, 0.549_700_478).map(|step| {
        let along = step * place as f64;
        along - along.round()
    })
}

/// Corners and tetrahedra of the largest piece, on a lattice moved by `shift` cubes.
fn fill(
    threads: usize,
    surface: &MeshDistance,
    size: f64,
    shift: Vec3,
    progress: &dyn Fn(f64),
) -> Result<Filled, TetraError> {
    let (low, high) = surface.mesh().bounds();
    let mm = size * 1e3;
    let filled = Lattice::around(low, high, size, shift)?.stuff(threads, surface, progress);
    let (nodes, tets) = pieces::largest(filled).map_err(|apart| match apart {
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
    })?;
    match check(&pieces::outside(&nodes, &tets), "boundary") {
        Ok(_) => Ok((nodes, tets)),
        Err(error) => Err(TetraError::Touching { mm, error }),
    }
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
    let tets: Vec<_> = mesh
        .tets
        .iter()
        .map(|&[a, b, c, d, ..]| [a, b, c, d])
        .collect();
    pieces::outside(&mesh.nodes, &tets)
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
