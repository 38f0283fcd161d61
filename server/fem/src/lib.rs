//! Finite elements of an organ, offline: quadratic tetrahedra, isotropic, factored by a sparse Cholesky
//! decomposition.
//!
//! The tissue models of the tick are fitted to these solutions and judged by them. No tick uses this crate.
//!
//! Small displacements are linear in the load ([`Factored`]). Large displacements are those of a neo-Hookean solid
//! with the same constants ([`solve_neo_hookean`]).
//!
//! [`TetMesh::from_corners`] makes a mesh. [`msh`] reads a file of Gmsh; [`files`] reads a folder of tables with load
//! cases.
//!
//! Units are SI: metres, newtons, pascals. Tables are in millimetres ([`files`]). The caller names the unit of a Gmsh
//! file ([`msh`]).
//!
//! A quadratic tetrahedron with four points of integration does not lock in bending. At a Poisson's ratio of 0.49 it
//! does not lock either, unlike a linear one (Hughes, The Finite Element Method, 2000, section 4.4).

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
