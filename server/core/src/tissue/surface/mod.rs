//! Organ by the compliance of its surface: finite elements condensed offline to a few hundred *masters* on the surface.
//!
//! # Small displacements
//! The displacement of the masters is `U = S F`, with the forces `F` on them and the condensed compliance `S`. Every
//! sphere of the tree follows the masters near it with smooth weights. The load on the sphere goes to the masters with
//! the same weights, so no work is lost or created between skin and organ.
//!
//! In time the organ creeps like a Maxwell-Voigt solid in a viscous bath. The displacement follows the filtered load,
//! `F' = (tau F'_before + dt F) / (tau + dt)`. The state holds the masters' displacement, its linear part `S F'`, and
//! the displacement gradients of the cells (see below).
//!
//! # Large displacements
//! The linear part is sufficient up to a millimetre or two. At larger displacements an organ turns, thickens and thins.
//! The complementary energy of the finite elements to third order in the load gives the next term exactly. With the
//! displacement field `u1 = K^-1 F`,
//!
//! `U = S F - sum_e R_e P2(G_e)`, `G_e = R_e' F / V_e`.
//!
//! - `G_e`: mean of `grad u1` in cell `e` of volume `V_e`.
//! - `P2`: part of the neo-Hookean stress that is quadratic in the displacement gradient.
//! - `R_e`: displacement of the masters for a unit stress in the cell.
//!
//! The term is the derivative of `-sum_e V_e W3(G_e)` by the load, with `W3` the cubic part of the energy. The same
//! matrix therefore reads the gradient and writes the displacement, and a closed path yields no energy.
//!
//! The only approximation is a constant gradient in each of some 32 cells. This is the hyper-reduction of An, Kim and
//! James 2008 (doi:10.1145/1409060.1409118), with means instead of points. Measured error on a real tongue against
//! neo-Hookean elements, rms, as a fraction of the largest displacement:
//!
//! | largest displacement | linear part | with the term |
//! |---|---|---|
//! | 9 mm | 4.7 % | 1.5 % |
//! | 15 mm | 7.5 % | 2.8 % |
//!
//! A series of this order is valid for strains up to some 40 %. For deeper indentation of a narrow place the model is
//! too stiff. Indentation of a patch of 11 mm on a tongue's back of 12 kPa:
//!
//! | load | neo-Hookean elements | linear elements | this model |
//! |---|---|---|---|
//! | 1 N | 2.92 mm | 2.91 mm | 2.80 mm |
//! | 2 N | 7.6 mm | 5.8 mm | 5.3 mm |
//!
//! Within a tick the term keeps its value for the loads before the tick. The lag is a millisecond, in a correction that
//! is itself filtered. The compliance in the optimisation, `W S W' dt / (tau + dt)`, stays symmetric and positive
//! semi-definite.

mod data;
mod masters;
mod ready;
mod stress;
#[cfg(test)]
mod tests;

pub use data::{Cells, MAX_CELLS, MAX_MASTERS, SurfaceCompliance, SurfaceParams, SurfaceSkin};
pub use masters::{Masters, SURFACE_CARRIERS};
pub(in crate::tissue) use ready::Ready;
pub use stress::quadratic_stress;
