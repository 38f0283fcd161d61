//! Place of a probe's tip in a tick and its force: the data of a grade.

use sulcus_core::output::ForceZone;
use sulcus_core::tissue::gingiva::Site;

use super::angle::Tilt;

/// Tip of a probe in a pocket.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Standing {
    /// FDI number of the tooth, 0 without a tooth in the scene.
    pub tooth: u8,
    /// Zone of the tip.
    pub site: Site,
    /// Angle about the tooth's axis, radians from mesial over buccal.
    pub around: f64,
    /// Distance from the tooth's axis, metres.
    pub from_axis: f64,
    /// Depth below the gingival margin, metres; negative above it.
    pub depth: f64,
    /// Length of the working end below the margin, metres: the depth that the bands show. A tilted probe shows more
    /// than `depth`.
    pub shown: f64,
    /// Force on the floor along the tooth's axis, newtons.
    pub force: f64,
    /// Zone of that force by the scene's own thresholds.
    pub zone: ForceZone,
    /// Tilt of the working end against the tooth.
    pub tilt: Tilt,
}
