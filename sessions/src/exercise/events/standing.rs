//! Where a probe's tip stands in a tick, and how it bears there: what a grade is made of.

use sulcus_core::output::ForceZone;
use sulcus_core::tissue::gingiva::Site;

use super::angle::Tilt;

/// A tip in a pocket.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Standing {
    /// FDI number of the tooth, 0 where the scene has none.
    pub tooth: u8,
    /// The zone that it counts as in.
    pub site: Site,
    /// Angle about the tooth's axis, radians from mesial over buccal.
    pub around: f64,
    /// Distance from the tooth's axis, metres.
    pub from_axis: f64,
    /// Below the gingival margin there, metres; negative above it.
    pub depth: f64,
    /// Length of the working end below the margin, metres: what its bands show there. More than `depth` where it is tilted.
    pub shown: f64,
    /// On the floor along the tooth's axis, newtons.
    pub force: f64,
    /// Zone of that force by the scene's own thresholds.
    pub zone: ForceZone,
    /// How the working end stands against the tooth.
    pub tilt: Tilt,
}
