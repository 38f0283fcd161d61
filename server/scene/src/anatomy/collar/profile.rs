//! Profile of the sulcus round one tooth: depth and height of the margin by angle.
//!
//! Six sites are prescribed. In a proximal zone the floor is deepest beside the midline, in the col under the contact
//! point. It rises towards the line angle, where an upright probe does not reach it.
//!
//! Between two zones the floor has the height of the shallower prescription. The deepest place of each zone is
//! therefore its own.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::anatomy::sections::Sections;
use crate::mesh::implicit::ramp;

/// Distance of a proximal site's deepest place from the midline, and the stretch of this depth, mm.
const PEAK: f64 = 0.85;
const PLATEAU: [f64; 2] = [0.5, 1.2];
/// Share of the tooth's half width at the end of a proximal zone, and the range of the angle there, radians.
const BORDER: f64 = 0.9;
const BORDERS: [f64; 2] = [0.84, 1.02];
/// Angle between a border and the change of depth beside it, radians.
const BESIDE: f64 = 0.09;
/// Half width of the stretch with the prescribed depth at a mid site, radians.
const MIDDLE: f64 = 0.3;
/// Smallest angle from the midline at which the margin begins to fall from the papilla, and angle at which it is
/// down, radians.
const SCALLOP: [f64; 2] = [0.35, FRAC_PI_2];

/// Depth at which the shape of a margin is taken, mm. Chosen between healthy and deep pockets.
pub const USUAL_MM: f64 = 4.0;

/// The prescribed depths and margins of a tooth, in the order mesiobuccal, buccal, distobuccal, distolingual, lingual,
/// mesiolingual.
#[derive(Clone, Debug, PartialEq)]
pub struct SulcusProfile {
    /// Probing depths, mm.
    pub depths: [f64; 6],
    /// Heights of the margin over the tooth's origin, mm. At a proximal site it is the height of the papilla.
    pub margins: [f64; 6],
    /// Distance from the axis to the mesial or distal end of the tooth at each site's floor, mm.
    ///
    /// On a tapered root, the same distance from the midline is another angle than at the neck.
    ends: [f64; 6],
    /// The same at a usual depth. The margin follows these distances, so that its shape does not tell the depths.
    usual: [f64; 6],
    /// Angle between the midline and the border of a proximal zone, radians.
    border: f64,
}

/// Position of an angle between two sites.
struct Between {
    /// The nearer site, and the other one.
    own: usize,
    other: usize,
    /// Angle from the own site's midline: of the tooth for a proximal site, of the side for a mid one.
    off: f64,
    /// Whether the other site shares the tooth's midline.
    across: bool,
}

impl SulcusProfile {
    /// Returns the profile of a tooth with these sections.
    pub fn new(sections: &Sections, depths: [f64; 6], margins: [f64; 6]) -> Self {
        let at = |site: usize, depth: f64| {
            let end = if matches!(site, 2 | 3) { PI } else { 0.0 };
            sections.radius(end, margins[site] - depth)
        };
        let neck = 0.5 * (sections.radius(0.0, 0.0) + sections.radius(PI, 0.0));
        let side = 0.5 * (sections.radius(FRAC_PI_2, 0.0) + sections.radius(-FRAC_PI_2, 0.0));
        let border = libm::atan2(BORDER * side, neck);
        Self {
            depths,
            margins,
            ends: std::array::from_fn(|site| at(site, depths[site])),
            usual: std::array::from_fn(|site| at(site, USUAL_MM)),
            border: border.clamp(BORDERS[0], BORDERS[1]),
        }
    }

    /// Angle between the midline and the border of a proximal zone, radians.
    pub fn proximal(&self) -> f64 {
        self.border
    }

    /// Angle from mesial over buccal at which the floor of each site is deepest, radians, -pi to pi.
    pub fn sites(&self) -> [f64; 6] {
        let [mb, _, db, dl, _, ml] = self.ends.map(|end| libm::atan2(PEAK, end));
        [mb, FRAC_PI_2, PI - db, dl - PI, -FRAC_PI_2, -ml]
    }

    /// Depth at an angle, mm.
    pub fn depth(&self, around: f64) -> f64 {
        let at = self.between(around);
        let (own, other) = (self.depths[at.own], self.depths[at.other]);
        let shallow = own.min(other);
        let end = self.end_of(at.own);
        let share = if at.own % 3 == 1 {
            // From the middle of the side towards the proximal zone.
            1.0 - ramp(at.off, MIDDLE, FRAC_PI_2 - self.border - BESIDE)
        } else if at.across {
            ramp(at.off, 0.0, libm::atan2(PLATEAU[0], end))
        } else {
            let from = libm::atan2(PLATEAU[1], end);
            1.0 - ramp(at.off, from, (self.border - BESIDE).max(from + 0.1))
        };
        shallow + (own - shallow) * share
    }

    /// Height of the margin that depths are read against, mm.
    pub fn margin(&self, around: f64) -> f64 {
        let at = self.between(around);
        let own = self.margins[at.own];
        if at.across {
            let reach = libm::atan2(PLATEAU[0], self.usual[at.own]);
            let middle = 0.5 * (own + self.margins[at.other]);
            return middle + (own - middle) * ramp(at.off, 0.0, reach);
        }
        // One curve from the papilla down to the middle of the side.
        let (corner, middle, off) = if at.own % 3 == 1 {
            (at.other, at.own, FRAC_PI_2 - at.off)
        } else {
            (at.own, at.other, at.off)
        };
        let (papilla, middle) = (self.margins[corner], self.margins[middle]);
        // The margin is level where the floor is deepest: on a slope a tip would not reach the floor.
        let from = SCALLOP[0].max(libm::atan2(PLATEAU[1], self.usual[corner]));
        // An arc: the margin falls fast beside the papilla and is nearly level over the middle of the root. A recession
        // is a U for the same reason.
        let share = ((off - from) / (SCALLOP[1] - from)).clamp(0.0, 1.0);
        papilla + (middle - papilla) * ramp(share * (2.0 - share), 0.0, 1.0)
    }

    fn end_of(&self, site: usize) -> f64 {
        self.ends[site]
    }

    fn between(&self, around: f64) -> Between {
        let turn = around - 2.0 * PI * libm::floor(around / (2.0 * PI) + 0.5);
        let lingual = turn < 0.0;
        // The angle is folded onto the buccal side, then onto its mesial half.
        let side = turn.abs();
        let distal = side > FRAC_PI_2;
        let off = if distal { PI - side } else { side };
        let site = |buccal: usize| if lingual { 5 - buccal } else { buccal };
        let (corner, middle) = (site(if distal { 2 } else { 0 }), site(1));
        if off >= self.border {
            return Between {
                own: middle,
                other: corner,
                off: FRAC_PI_2 - off,
                across: false,
            };
        }
        let across = off < libm::atan2(PEAK, self.end_of(corner));
        Between {
            own: corner,
            other: if across { 5 - corner } else { middle },
            off,
            across,
        }
    }
}
