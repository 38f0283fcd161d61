//! Tongue and gingiva **as printed**: the tissue models of doi:10.1109/TOH.2014.2304734 with the paper's equations.
//!
//! These models serve for comparison with the coupled default models, not for training.
//!
//! In contrast to the coupled models, deformation comes *before* the optimisation and from a penalty, not from the
//! multipliers. [`crate::tissue::Tissue::free_step`] has these steps:
//! 1. Contact prediction finds the contact spheres.
//! 2. Each contact sphere is loaded with `K_p` times the displacement from the last graphic tool to the current haptic
//!    tool (Eq. 2, 3).
//! 3. The tongue's skeleton makes an explicit Euler step under that load (Eq. 1, 4). The gingiva is displaced by Eq. 11
//!    to 16.
//!
//! The optimisation then treats the deformed tissue as rigid (section 7). Load and reaction are therefore different
//! forces, and the shape lags the tool by a tick.
//!
//! Interpretation of the passages in which the text is wrong or incomplete:
//!
//! | Place | In the text | Here |
//! |---|---|---|
//! | Eq. 1 | sign pushes away from rest | `-k_s sum (u_i - u_j) - b_c v_i` |
//! | 3.1 | springs between which spheres | the spring graph of the coupled skeleton |
//! | Eq. 2, 3 | index: tissue sphere on the left, tool sphere on the right | one load `K_p dp` per *pair*, summed |
//! | 3.2, 4.2 | "the object" in contact prediction | as deformed at the end of the last tick |
//! | 4.2 | "out of contact at t" | no sphere of the whole haptic tool overlaps that shape |
//! | 4.2, 6 | contact on level 3, skeleton on level 2 | load on the ancestor or carrier; descendants shift with it |
//! | Eq. 9 | one spring | all eigenvalues of the skeleton ([`stability`]) |
//! | Eq. 11, 12 | several pairs on one fringe sphere | the largest displacement of them |
//! | Eq. 13 | direction of the arrow | from the tooth to the gingiva |
//! | Eq. 14 | unit of the distance; several fringe spheres | millimetres; the largest displacement |
//! | Eq. 15 | R | radius of the tool's tip |
//! | Fig. 12, Eq. 16 | type 3 in a figure only | the haptic tip is above the gingival margin |
//! | 5.2 | memory "hybrid contact at the previous step" | last tick's loads on both, tooth and gingiva |
//! | Eq. 17 | from which centre | from the rest centre, so that bounds shrink again |
//!
//! In a tree of inscribed spheres, an ancestor may lie on the opposite side of the organ. [`PrintedSkeleton::carriers`]
//! then names a skeleton sphere for each node instead of its ancestor.

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

/// Checks that `found`, the value of the parameter `field`, lies in the range from `low` to `high`, inclusive. `unit`
/// is the unit of all three numbers, for the message.
///
/// # Errors
/// The value is outside the range or NaN.
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
