//! Gingiva around one tooth: a collar of places, each softer away from the tooth than along it, coupled to its
//! neighbours.
//!
//! # Compliance
//! The compliance between the places i and j at the surface points `x_i` and `x_j` is
//!
//! `C_ij = exp(-|x_i - x_j| / l) D_i^1/2 D_j^1/2`, `D = (1/k_d) mm' + (1/k_t)(1 - mm')`,
//!
//! with `m` the direction away from the tooth. `C` is positive semi-definite by construction (`kernel`).
//!
//! `C` is the local displacement of Wang et al. 2014 (doi:10.1109/TOH.2014.2304734, Eq. 11 to 16) as a matrix.
//! Neighbours (Eq. 14), types of hybrid contact (Eq. 15) and release (Eq. 16) follow from solving all contacts at once.
//!
//! The compliance of a place does not depend on the number of spheres that represent the surface. A load on a sphere is
//! spread along the tooth's axis over the length that the sphere represents. `exp` is then the mean over both lengths.
//! The wall is therefore as stiff at level 3 as at level 4.
//!
//! The floor of the pocket is soft along the tooth's axis, so the probing depth grows with the force.
//!
//! # Time
//! The gingiva is a Kelvin-Voigt solid, `f = K (u + tau du/dt)` with `K = C^-1`. A step of implicit Euler is
//!
//! `u = tau / (tau + dt) u_last + dt / (tau + dt) C f`.

mod kernel;
mod params;
mod pocket;
mod ready;
mod sites;
#[cfg(test)]
mod tests;

use serde::{Deserialize, Serialize};

use super::{TissueError, wrong};
use crate::MAX_TOOLS;
use crate::math::{Vec3, norm};
use crate::scene::params::within;
use crate::tree::SphereTree;

pub use params::GingivaParams;
pub(super) use ready::Ready;
pub use sites::{Prescribed, Site};

/// Count of numbers in the state before the displacements: floor force, force zone and entry flag of each tool.
const MEMORY: usize = 3 * MAX_TOOLS;

/// Position and orientation of a tooth, world axes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ToothFrame {
    /// Point on the tooth's axis, metres.
    pub origin: Vec3,
    /// Unit vector along the tooth's axis, towards the chewing surface.
    pub axis: Vec3,
    /// Unit vector across the axis, mesially.
    pub mesial: Vec3,
    /// Unit vector across `axis` and `mesial`, buccally.
    pub buccal: Vec3,
}

impl ToothFrame {
    /// Returns angle and height of a point. The angle is about the axis, radians from mesial over buccal, -pi to pi.
    /// The height is along the axis over `origin`, metres.
    pub fn cylindrical(&self, point: &Vec3) -> (f64, f64) {
        let from = point - self.origin;
        let angle = libm::atan2(from.dot(&self.buccal), from.dot(&self.mesial));
        (angle, from.dot(&self.axis))
    }

    /// Returns the distance of a point from the axis, metres.
    pub fn from_axis(&self, point: &Vec3) -> f64 {
        let from = point - self.origin;
        norm(&(from - self.axis * from.dot(&self.axis)))
    }
}

/// Geometry of one node of the gingiva's tree, relative to tooth and pocket.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Place {
    /// Unit vector away from the tooth, across its axis, world axes.
    pub away: Vec3,
    /// Point of the pocket's surface that the sphere represents, world axes, metres. Compliance falls with the distance
    /// between these points. Centres are unsuitable, because they lie deeper at coarser levels.
    pub on_surface: Vec3,
    /// Length along the tooth's axis over which a load on the sphere is spread, metres, 0 to 0.1; 0 for a load at a
    /// point.
    pub spread: f64,
    /// Height of the centre over the pocket's floor at the centre's angle, along the tooth's axis, metres; negative
    /// below.
    pub height: f64,
    /// Whether the sphere represents the floor of the pocket or the tissue under the floor.
    pub floor: bool,
}

/// Gingiva around one tooth, as stored in a scene: material, frame, margin, geometry of the nodes and prescriptions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gingiva {
    /// Material parameters and force thresholds.
    pub params: GingivaParams,
    /// Frame of the tooth that the gingiva surrounds.
    pub tooth: ToothFrame,
    /// Height of the gingival margin along the tooth's axis over the tooth's origin, metres. Samples lie at equal
    /// angles over a whole turn, from mesial over buccal, with linear interpolation.
    pub margin: Vec<f64>,
    /// Geometry of each node of the tree, in the order of the nodes.
    pub places: Vec<Place>,
    /// Half width of the proximal zones about the mesial and distal midlines, radians. Default 50, range 20 to 80
    /// degrees.
    pub proximal: f64,
    /// Prescription of each site, in the order of [`Site::ALL`].
    pub sites: [Prescribed; 6],
    /// Contact level, whose spheres have a displacement each. Coarser spheres do not move; finer spheres move with
    /// their ancestor at this level.
    pub level: u8,
}

impl Gingiva {
    /// Returns the height of the margin at an angle (radians from mesial over buccal), metres along the tooth's axis
    /// over the tooth's origin.
    pub fn margin_at(&self, around: f64) -> f64 {
        let n = self.margin.len();
        let turn = around / (2.0 * std::f64::consts::PI);
        let at = (turn - libm::floor(turn)) * n as f64;
        let k = (at as usize).min(n - 1);
        let share = at - k as f64;
        self.margin[k] + share * (self.margin[(k + 1) % n] - self.margin[k])
    }

    /// Returns the count of numbers in the state: the memory of each tool, then x, y and z of each displaced sphere of
    /// `rest`.
    pub fn state_len(&self, rest: &SphereTree) -> usize {
        MEMORY + 3 * rest.shape_at(self.level).count()
    }

    /// Checks the data against the tree of the object.
    ///
    /// # Errors
    /// A field is invalid: the error names the field, the value found and the value expected.
    pub fn validate(&self, rest: &SphereTree) -> Result<(), TissueError> {
        self.params.validate()?;
        self.validate_sites()?;
        let (nodes, places) = (rest.nodes().len(), self.places.len());
        if places != nodes {
            return wrong(
                "number of places",
                places.to_string(),
                format!("one for each of {nodes} nodes"),
            );
        }
        let small = |x: &f64| x.abs() <= 1.0;
        if self.margin.len() < 3 || !self.margin.iter().all(small) {
            return wrong(
                "margin",
                format!("{:?}", self.margin),
                "at least three heights within 1 m",
            );
        }
        let ToothFrame {
            origin,
            axis,
            mesial,
            buccal,
        } = &self.tooth;
        let skew = [
            axis.dot(axis) - 1.0,
            mesial.dot(mesial) - 1.0,
            buccal.dot(buccal) - 1.0,
            axis.dot(mesial),
            mesial.dot(buccal),
            buccal.dot(axis),
        ];
        // Comparisons are written so that a NaN fails.
        if !skew.iter().all(|x| x.abs() <= 1e-9) || !within(norm(origin), 0.0, 10.0) {
            return wrong(
                "tooth",
                format!("{:?}", self.tooth),
                "three unit vectors at right angles, within 10 m",
            );
        }
        let unsound = self.places.iter().position(|place| {
            let (away, axis) = (&place.away, &self.tooth.axis);
            !((norm(away) - 1.0).abs() <= 1e-9
                && away.dot(axis).abs() <= 1e-9
                && small(&place.height)
                && place.on_surface.iter().all(|x| within(*x, -10.0, 10.0))
                && within(place.spread, 0.0, 0.1))
        });
        if let Some(k) = unsound {
            return wrong(
                "place",
                format!("{:?} at {k}", self.places[k]),
                "a unit vector across the tooth's axis, a height within 1 m, a point within 10 m and a spread of 0 to 0.1 m",
            );
        }
        Ok(())
    }
}
