//! Comparison of finite elements with exact answers and references.

mod common;
mod convergence;
mod exact;
mod long;
mod msh;
mod msh_damaged;
mod nonlinear;
mod reference;
mod surface;
