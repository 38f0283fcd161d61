//! Finite elements of an organ, offline: quadratic tetrahedra, isotropic, factored by a sparse Cholesky decomposition. What
//! the tissue models of the tick are fitted to and judged by; no part of a tick.
//!
//! Small displacements are linear in the load ([`Factored`]); large ones are those of a neo-Hookean solid with the same
//! constants ([`solve_neo_hookean`]). A mesh is made ([`TetMesh::from_corners`]) or read: Gmsh's format ([`msh`]), or a folder
//! of tables with load cases ([`files`]).
//!
//! SI units: metres, newtons, pascals. Files are in millimetres, as their own README says ([`files`]), or in what the caller
//! says ([`msh`]).
//!
//! A quadratic tetrahedron with four points of integration does not lock in bending, nor at a Poisson's ratio of 0.49
//! as a linear one does (Hughes, The Finite Element Method, 2000, section 4.4).

mod assembly;
mod condense;
mod element;
mod error;
pub mod files;
mod mesh;
pub mod msh;
mod neo_hookean;
mod newton;
mod stiffness;
mod support;
mod surface;
mod tangent;

pub use condense::{CondenseOptions, Condensed, condense};
pub use error::FemError;
pub use mesh::TetMesh;
pub use neo_hookean::neo_hookean_forces;
pub use newton::{NewtonOptions, NewtonProgress, solve_neo_hookean};
pub use stiffness::{Elastic, Factored, internal_forces};
