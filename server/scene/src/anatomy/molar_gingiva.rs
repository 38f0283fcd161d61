//! The gingiva of one parametric molar ([`crate::anatomy::first_molar`]): a collar with a pocket between collar and
//! tooth.
//!
//! Frame: the tooth's. A point is described by its distance `r` from the tooth's surface and by its height.
//!
//! - The pocket's wall is at `r` equal to the pocket's width.
//! - The depth of the floor is given for six sites and smooth between them.
//! - The margin is scalloped, with a papilla on either side.
//! - Below the floor the collar goes a little into the tooth: it is attached. Tissue and tooth are never tested
//!   against each other.

use sulcus_core::Vec3;
use sulcus_core::math::{fmax, fmin};

use crate::file::Pocket;
use crate::mesh::TriMesh;
use crate::mesh::distance::MeshDistance;
use crate::mesh::implicit::{ramp, smooth_max, smooth_min};
use crate::mesh::polygonise::polygonise;

/// Angles of the six sites, degrees from mesial over buccal, in the order of [`Pocket::depths_mm`].
pub const SITES_DEG: [f64; 6] = [35.0, 90.0, 145.0, 215.0, 270.0, 325.0];
/// Depth of attached tissue inside the tooth, mm.
const OVERLAP: f64 = 0.8;
/// Fillet between wall and floor, mm.
const FILLET: f64 = 0.3;
/// Rounding of the lower edge, mm.
const EDGE: f64 = 0.8;
/// Height over which the crest widens to the wall's thickness, mm.
const FLARE: f64 = 4.0;
/// Weight of the pocket's surface in the distribution of spheres; the outside has 1.
const POCKET_WEIGHT: f64 = 16.0;
/// Weight of surfaces in the tooth or at the base.
const HIDDEN_WEIGHT: f64 = 0.02;

/// A pocket at its tooth.
#[derive(Clone, Debug)]
pub struct MolarCollar<'a> {
    pocket: &'a Pocket,
    tooth: &'a MeshDistance,
    /// Height of the floor at rest over the prescribed depth, mm.
    sink: f64,
    /// Height of the base, mm.
    base: f64,
}

impl<'a> MolarCollar<'a> {
    /// Returns the collar round `tooth`, its mesh in its own frame, metres. The floor lies `sink` metres above the
    /// prescribed depth.
    pub fn new(pocket: &'a Pocket, tooth: &'a MeshDistance, sink: f64) -> Self {
        let mut collar = Self {
            pocket,
            tooth,
            sink: sink * 1e3,
            base: 0.0,
        };
        let lowest = (0..360).fold(f64::INFINITY, |low, degree| {
            fmin(low, collar.floor_mm(f64::from(degree).to_radians()))
        });
        collar.base = lowest - pocket.base_mm;
        collar
    }

    /// Prescribed probing depth at an angle (radians from mesial over buccal), metres.
    pub fn depth(&self, around: f64) -> f64 {
        self.depth_mm(around) * 1e-3
    }

    /// Height of the floor at rest at an angle, metres.
    pub fn floor(&self, around: f64) -> f64 {
        self.floor_mm(around) * 1e-3
    }

    fn depth_mm(&self, around: f64) -> f64 {
        let degrees = around.to_degrees();
        let degrees = degrees - 360.0 * (degrees / 360.0).floor();
        let depths = &self.pocket.depths_mm;
        // The site before and the one after. The depth is flat at the sites, so a reading there is the site's.
        let after = SITES_DEG.iter().position(|site| degrees < *site);
        let (before, after) = match after {
            Some(0) | None => (5, 0),
            Some(k) => (k - 1, k),
        };
        let from = SITES_DEG[before] - if degrees < SITES_DEG[0] { 360.0 } else { 0.0 };
        let to = SITES_DEG[after] + if after == 0 && from > 0.0 { 360.0 } else { 0.0 };
        depths[before] + (depths[after] - depths[before]) * ramp(degrees, from, to)
    }

    fn margin_mm(&self, around: f64) -> f64 {
        let cosine = libm::cos(around);
        let scallop = cosine * cosine * cosine * cosine;
        self.pocket.margin_mm + (self.pocket.papilla_mm - self.pocket.margin_mm) * scallop
    }

    fn floor_mm(&self, around: f64) -> f64 {
        self.margin_mm(around) - self.depth_mm(around) + self.sink
    }

    /// Returns about the signed distance to the collar, mm, at a point in mm.
    fn drawn(&self, p: &Vec3) -> f64 {
        let around = libm::atan2(p.y, p.x);
        let (width, half) = (self.pocket.width_mm, 0.5 * self.pocket.crest_mm);
        let r = self.tooth.signed(&(p * 1e-3)) * 1e3;
        let below = self.margin_mm(around) - p.z;
        // The free margin is round on top; the outer face leans out below it.
        let across = r - width - half;
        let outer = if below < half {
            (across * across + (half - below) * (half - below)).sqrt() - half
        } else {
            let flare = (self.pocket.wall_mm - self.pocket.crest_mm)
                * ramp(below - half, -FLARE, FLARE)
                - 0.5 * (self.pocket.wall_mm - self.pocket.crest_mm);
            across - half - flare
        };
        let attached = fmax(p.z - self.floor_mm(around), -OVERLAP - r);
        let inner = smooth_min(width - r, attached, FILLET);
        smooth_max(fmax(outer, inner), self.base - p.z, EDGE)
    }

    /// The closed surface, metres, in the tooth's frame.
    pub fn mesh(&self) -> TriMesh {
        let (low, high) = self.tooth.mesh().bounds();
        let out = self.pocket.width_mm + self.pocket.wall_mm + 0.5;
        let low = Vec3::new(low.x * 1e3 - out, low.y * 1e3 - out, self.base - 0.5);
        let top = fmax(self.pocket.papilla_mm, self.pocket.margin_mm) + 0.5;
        let high = Vec3::new(high.x * 1e3 + out, high.y * 1e3 + out, top);
        let drawn = |p: &Vec3| self.drawn(p);
        // The first grid that gives a manifold is taken, as for the molar.
        let on_grid = |k: u32| {
            let shift = Vec3::new(0.37, 0.61, 0.83) * (self.pocket.grid_mm * 0.25 * f64::from(k));
            polygonise(&drawn, low - shift, high, self.pocket.grid_mm).placed(1e-3, Vec3::zeros())
        };
        let mut mesh = on_grid(0);
        for k in 1..8 {
            if crate::mesh::check::check(&mesh, "gingiva").is_ok() {
                break;
            }
            mesh = on_grid(k);
        }
        mesh
    }

    /// Returns the weight of a point of the surface (metres) in the building of a tree.
    pub fn importance(&self, p: &Vec3) -> f64 {
        let around = libm::atan2(p.y, p.x);
        let r = self.tooth.signed(p) * 1e3;
        let above = p.z * 1e3 - self.floor_mm(around);
        // Walls, floor and the inner half of the margin. The weight fades: a sharp border through a sphere's patch
        // would leave half of that sphere poorly fitted.
        let near = self.pocket.width_mm + 0.5 * self.pocket.crest_mm;
        let pocket =
            ramp(-r, -near - 0.4, -near + 0.1) * ramp(above, -0.5, -0.1) * ramp(r, -0.4, -0.1);
        let seen = ramp(r, -0.4, -0.1) * ramp(p.z * 1e3 - self.base, 0.3, 1.0);
        let ground = HIDDEN_WEIGHT + (1.0 - HIDDEN_WEIGHT) * seen;
        ground + (POCKET_WEIGHT - ground) * pocket
    }

    /// Returns a name for all inputs of the weight that the mesh does not show. It is part of keys in `family.bin`.
    pub fn importance_key(&self) -> String {
        format!("gingiva 1 {POCKET_WEIGHT} {HIDDEN_WEIGHT}")
    }
}
