//! Tongue and gingiva **as printed**: the tissue of doi:10.1109/TOH.2014.2304734 by its own equations, beside
//! the coupled default, for comparison. Nothing here is meant for a student's hand.
//!
//! What sets it apart from the coupled models: deformation comes *before* the optimisation and from a penalty,
//! not from the optimisation's answer. In [`crate::tissue::Tissue::free_step`] the contact spheres found by
//! contact prediction are loaded with `K_p` times the way from the last graphic tool to the present haptic
//! one (Eq. 2, 3); the tongue's skeleton makes an explicit Euler step under that load (Eq. 1, 4), the gingiva is
//! displaced (Eq. 11 to 16); the tool is then optimised against the deformed thing as if that were rigid
//! (section 7). Load and reaction are therefore not the same force, and the shape lags the tool by a tick.
//!
//! Where the text is wrong or silent, this is what is done:
//!
//! | Place | In the text | Here |
//! |---|---|---|
//! | Eq. 1 | sign pushes away from rest | `-k_s sum (u_i - u_j) - b_c v_i` |
//! | 3.1 | springs between which spheres | the spring graph of the coupled skeleton |
//! | Eq. 2, 3 | index is the tissue's sphere on the left, the tool's on the right | one load `K_p dp` per *pair*, summed |
//! | 3.2, 4.2 | "the object" in contact prediction | as deformed at the end of the last tick |
//! | 4.2 | "out of contact at t" | no sphere of the whole haptic tool overlaps that shape |
//! | 4.2, 6 | contact on level 3, skeleton on level 2 | load on the ancestor; children shift as their ancestor does; in a tree of inscribed spheres, whose ancestors may lie on the other side, on the skeleton's sphere that is named for each ([`PrintedSkeleton::carriers`]) |
//! | Eq. 9 | one spring | all eigenvalues of the skeleton ([`stability`]) |
//! | Eq. 11, 12 | several pairs on one fringe sphere | the largest displacement of them |
//! | Eq. 13 | direction of the arrow | from the tooth to the gingiva |
//! | Eq. 14 | unit of the distance; several fringe spheres | millimetres; the largest displacement |
//! | Eq. 15 | R | radius of the tool's tip |
//! | Fig. 12, Eq. 16 | type 3 in a figure only | the haptic tip is above the gingival margin |
//! | 5.2 | memory "hybrid contact at the previous step" | last tick's loads on both, tooth and gingiva |
//! | Eq. 17 | from which centre | from the rest centre, so that bounds shrink again |

mod followers;
mod gingiva;
mod load;
mod pairs;
mod skeleton;
pub mod stability;
#[cfg(test)]
mod tests;
mod whole;

pub use gingiva::PrintedGingiva;
pub(crate) use gingiva::ReadyGingiva;
pub(crate) use skeleton::ReadySkeleton;
pub use skeleton::{PenaltyMeter, PrintedSkeleton};
pub use whole::as_printed;

use super::{TissueError, wrong};
use crate::scene::params::within;

/// Checks one number against its range.
fn ranged(
    field: &'static str,
    found: f64,
    low: f64,
    high: f64,
    unit: &str,
) -> Result<(), TissueError> {
    if within(found, low, high) {
        return Ok(());
    }
    wrong(
        field,
        format!("{found} {unit}"),
        format!("{low} to {high} {unit}"),
    )
}
