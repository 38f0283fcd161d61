//! The gingiva around one tooth: a collar whose every place gives way on its own, away from the tooth more easily than
//! along it, and takes its neighbourhood with it.
//!
//! Compliance between places i and j (points x of the surface): `C_ij = exp(-|x_i - x_j| / l) D_i^1/2 D_j^1/2`, `D = (1/k_d) mm' +
//! (1/k_t)(1 - mm')`, `m` the direction away from the tooth; positive semi-definite by construction (`kernel`). It is
//! the local displacement of Wang et al. 2014 (doi:10.1109/TOH.2014.2304734, Eq. 11 to 16) as a matrix: neighbours (Eq. 14), the
//! types of hybrid contact (Eq. 15) and release (Eq. 16) follow from solving all contacts at once. A place's compliance
//! does not depend on how many spheres stand for the surface, and a load on a sphere is spread along the tooth's axis over
//! the length that it stands for (`exp` is the mean over both lengths), so the wall is as stiff at level 3 as at level 4.
//!
//! In time it is a Kelvin-Voigt solid, `f = K (u + tau du/dt)` with `K = C^-1`: a step of implicit Euler is `u = tau / (tau +
//! dt) u_last + dt / (tau + dt) C f`.
//!
//! The floor of the pocket is soft along the tooth's axis: what a probe reads grows with its force.

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

/// Numbers of state before the displacements: floor force, zone and event for each tool.
const MEMORY: usize = 3 * MAX_TOOLS;

/// Where a tooth is and which way round, world axes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ToothFrame {
    /// A point on the tooth's axis, metres.
    pub origin: Vec3,
    /// Unit vector along the tooth's axis, towards the chewing surface.
    pub axis: Vec3,
    /// Unit vector across the axis, mesially.
    pub mesial: Vec3,
    /// Unit vector across both, buccally.
    pub buccal: Vec3,
}

impl ToothFrame {
    /// Angle about the axis, radians from mesial over buccal, -pi to pi, and height along it, metres.
    pub fn cylindrical(&self, point: &Vec3) -> (f64, f64) {
        let from = point - self.origin;
        let angle = libm::atan2(from.dot(&self.buccal), from.dot(&self.mesial));
        (angle, from.dot(&self.axis))
    }

    /// Distance of a point from the axis, metres.
    pub fn from_axis(&self, point: &Vec3) -> f64 {
        let from = point - self.origin;
        norm(&(from - self.axis * from.dot(&self.axis)))
    }
}

/// What the model knows of one node of the gingiva's tree.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Place {
    /// Unit vector away from the tooth, across its axis.
    pub away: Vec3,
    /// Point of the pocket's surface that this sphere stands for, world axes, metres: compliance falls with the distance
    /// between these points, not with that of centres, which lie deeper the coarser the level is.
    pub on_surface: Vec3,
    /// Length along the tooth's axis over which a load on this sphere is spread, metres; 0 for a load at a point.
    pub spread: f64,
    /// Height of the centre over the floor of the pocket at its angle, along the tooth's axis, metres; negative below.
    pub height: f64,
    /// Whether this sphere stands for the floor of the pocket, or for what lies under it.
    pub floor: bool,
}

/// A gingiva in a scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gingiva {
    /// How it yields.
    pub params: GingivaParams,
    /// The tooth that it surrounds.
    pub tooth: ToothFrame,
    /// Height of the gingival margin along the tooth's axis over its origin, metres, at equal angles from mesial over
    /// buccal all the way round; linear between.
    pub margin: Vec<f64>,
    /// One for each node of the tree.
    pub places: Vec<Place>,
    /// How far the proximal zones reach from the mesial and distal midlines, radians. Default 50 degrees, range 20 to 80.
    pub proximal: f64,
    /// What is prescribed at each site, in the order of [`Site::ALL`].
    pub sites: [Prescribed; 6],
    /// Level whose spheres yield each on its own: the level in contact. Coarser ones do not yield, finer ones go along.
    pub level: u8,
}

impl Gingiva {
    /// Height of the margin at an angle (radians from mesial over buccal), metres.
    pub fn margin_at(&self, around: f64) -> f64 {
        let n = self.margin.len();
        let turn = around / (2.0 * std::f64::consts::PI);
        let at = (turn - libm::floor(turn)) * n as f64;
        let k = (at as usize).min(n - 1);
        let share = at - k as f64;
        self.margin[k] + share * (self.margin[(k + 1) % n] - self.margin[k])
    }

    /// Numbers of state that outlive a tick.
    pub fn state_len(&self, rest: &SphereTree) -> usize {
        MEMORY + 3 * rest.shape_at(self.level).count()
    }

    /// Checks the data against the tree that it belongs to.
    ///
    /// # Errors
    /// Names the field, the value found and the value expected.
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
        // Written so that a NaN fails.
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
