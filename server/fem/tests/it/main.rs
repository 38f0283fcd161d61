//! Finite elements against exact answers and references.

mod common;
mod condense;
mod convergence;
mod exact;
mod msh;
mod msh_damaged;
mod nonlinear;
mod nonlinear_reference;
mod reference;
mod surface;
