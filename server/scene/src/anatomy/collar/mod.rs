//! The gingiva of one tooth: a collar with a pocket between collar and tooth.
//!
//! Frame: the tooth's, in millimetres. x is mesial, y buccal, z occlusal; the origin lies on the axis at the buccal
//! CEJ.
//!
//! The shape is radial: surfaces are distances from the axis by angle and height.
//!
//! - The pocket's wall is the convex section of the tooth plus the pocket's width. The convex section bridges
//!   furcations.
//! - The outer face follows the tooth. Towards a neighbour it follows the common outline of both, up to a plane
//!   through their contact point.
//! - The papilla fills the room under the contact. It is lower in the middle than at both sides, which makes the col.
//! - Tissue below the floor is attached, and so is tissue between the roots ([`Entrance`]).

mod furcation;
mod packing;
mod profile;
mod skin;

pub use packing::pack;
pub use profile::{SulcusProfile, USUAL_MM};
pub use skin::skin;

use sulcus_core::{Sphere, Vec3};

use super::sections::Sections;
use super::tooth::{Furcation, Tooth};
use crate::mesh::implicit::ramp;

/// Sizes of a collar, mm.
#[derive(Clone, Debug, PartialEq)]
pub struct CollarSizes {
    /// Width between tooth and gingiva at rest. A real width is about 0.4; a probe's tip has 0.5.
    pub width: f64,
    /// Thickness of the free margin.
    pub crest: f64,
    /// Thickness of the wall further down.
    pub wall: f64,
    /// Height of the base, above the jaw.
    pub base: f64,
    /// Height of the floor at rest over the prescribed depth.
    pub sink: f64,
}

/// A neighbour's side of a collar.
#[derive(Clone, Debug)]
pub struct Neighbour {
    /// Contact point.
    pub contact: Vec3,
    /// Way across the axis for each mm of height, of the line through the contact point up the plane between both
    /// teeth.
    pub slope: [f64; 2],
    /// Unit normal of the plane's sections across the axis, towards the neighbour.
    pub normal: [f64; 2],
    /// Distance of the outer face from the contact point along the plane, buccally and lingually, by height.
    pub faces: [Face; 2],
    /// The neighbour's FDI number, and its end at this side (0 mesial, 1 distal).
    pub end: (u8, usize),
    /// Height at which the neighbour's floor is read where it is deepest beside the plane, buccally and lingually.
    /// Infinity has no effect.
    pub floors: [f64; 2],
}

impl Neighbour {
    /// Returns the place of the line through the contact point at a height, across the axis, mm.
    pub fn contact_at(&self, z: f64) -> [f64; 2] {
        let up = z - self.contact.z;
        [
            self.contact.x + self.slope[0] * up,
            self.contact.y + self.slope[1] * up,
        ]
    }

    /// Returns the corner of a side's outer face and the plane at a height, across the axis, mm.
    pub fn corner(&self, lingual: bool, z: f64) -> [f64; 2] {
        let [nx, ny] = self.normal;
        // Direction along the plane towards that side; buccal is y.
        let side = if (nx < 0.0) == lingual { 1.0 } else { -1.0 };
        let (ax, ay) = (-ny * side, nx * side);
        let face = self.faces[usize::from(lingual)].at(z);
        let [x, y] = self.contact_at(z);
        [x + ax * face, y + ay * face]
    }
}

/// Distance of the outer face by height: linear between heights at equal steps.
#[derive(Clone, Debug)]
pub struct Face {
    /// Lowest height, mm.
    pub low: f64,
    /// Distances at each [`Face::STEP`], mm.
    pub distance: Vec<f64>,
}

impl Face {
    /// Step between heights, mm.
    pub const STEP: f64 = 0.5;

    /// Distance at a height.
    pub fn at(&self, z: f64) -> f64 {
        let last = self.distance.len() - 1;
        let row = ((z - self.low) / Self::STEP).clamp(0.0, last as f64);
        let (k, f) = (row as usize, row - row.floor());
        self.distance[k] * (1.0 - f) + self.distance[(k + 1).min(last)] * f
    }
}

/// An entrance between two roots, with its charted degree.
#[derive(Clone, Debug, PartialEq)]
pub struct Entrance {
    /// Place of the entrance.
    pub furcation: Furcation,
    /// Degree, 0 to 3.
    pub degree: u8,
}

/// A sphere of the collar, with its place in the pocket.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Packed {
    /// The sphere, in the tooth's frame, metres.
    pub sphere: Sphere,
    /// Unit vector away from the tooth, across its axis.
    pub away: Vec3,
    /// The sphere's point on the pocket's surface, metres.
    pub on_surface: Vec3,
    /// Height of the centre over the floor at its angle, metres.
    pub height: f64,
    /// Whether the sphere belongs to the floor.
    pub floor: bool,
}

/// A pocket at its tooth.
#[derive(Clone, Debug)]
pub struct Collar {
    /// The tooth.
    pub tooth: Tooth,
    /// Distances of its surface from its axis.
    pub sections: Sections,
    /// Entrances between its roots.
    pub entrances: Vec<Entrance>,
    /// Depths and margins.
    pub sulcus: SulcusProfile,
    /// Sizes.
    pub sizes: CollarSizes,
    /// Mesial and distal neighbour.
    pub neighbours: [Option<Neighbour>; 2],
}

/// Least room for tissue between the pocket's wall and the plane to a neighbour, mm.
const LEAST_TISSUE: f64 = 0.22;
/// Growth of the thickness under the crest, mm for each mm of height, up to the whole thickness.
const SLOPE: f64 = 0.8;
/// Height below which the outer face is vertical whatever the shape of the root, mm.
const STRAIGHT: f64 = -5.0;
/// Growth of the wall's thickness for each mm downwards.
const THICKENING: f64 = 0.1;
/// Largest distance of an outer face from the axis, mm.
const FAR: f64 = 16.0;

/// Returns the distance of the outer face from the axis away from neighbours.
///
/// The distance is the tooth's own radius plus the wall, which thickens downwards from the cemento-enamel junction.
pub fn outer_face(sections: &Sections, wall: f64, around: f64, z: f64) -> f64 {
    sections.radius(around, z.max(STRAIGHT)) + wall + THICKENING * (-z).max(0.0)
}

impl Collar {
    /// Height of the floor at rest.
    pub fn floor(&self, around: f64) -> f64 {
        self.sulcus.margin(around) - self.sulcus.depth(around) + self.sizes.sink
    }

    /// Distance of the pocket's wall from the axis.
    pub fn inner(&self, around: f64, z: f64) -> f64 {
        self.sections.radius(around, z) + self.sizes.width
    }

    /// Returns the places at which the floor is read where it is deepest at an end (0 mesial, 1 distal), buccally and
    /// lingually.
    pub fn floors_at(&self, end: usize) -> [Vec3; 2] {
        let sites = self.sulcus.sites();
        let sites = [[sites[0], sites[5]], [sites[2], sites[3]]][end];
        sites.map(|around| {
            let z = self.floor(around) - self.sizes.sink;
            let r = self.inner(around, z);
            Vec3::new(r * libm::cos(around), r * libm::sin(around), z)
        })
    }

    /// Returns the height at which the neighbour's floor is read beyond the plane at an angle.
    ///
    /// `None` if a sphere of the given radius, at distance `r` from the axis and at height `z`, does not reach over the
    /// plane.
    fn beyond(&self, around: f64, (r, z): (f64, f64), radius: f64) -> Option<f64> {
        let most = self.plane(around, z, radius)?;
        let neighbour = self.neighbours[usize::from(libm::cos(around) < 0.0)].as_ref()?;
        (r > most).then_some(neighbour.floors[usize::from(libm::sin(around) < 0.0)])
    }

    /// Returns the height of the tissue's crest: the margin, or under a contact the highest place with room for
    /// tissue.
    pub fn crest(&self, around: f64) -> f64 {
        let margin = self.sulcus.margin(around);
        let floor = self.floor(around);
        let mut z = margin;
        while z > floor + 0.2 {
            let room = self.plane(around, z, 0.0).unwrap_or(FAR) - self.inner(around, z);
            if room >= LEAST_TISSUE {
                break;
            }
            z -= 0.1;
        }
        z
    }

    /// Returns the largest distance from the axis of a sphere's centre at an angle and a height: the sphere does not
    /// reach over the plane to a neighbour.
    ///
    /// `None` if there is no neighbour in that direction.
    fn plane(&self, around: f64, z: f64, radius: f64) -> Option<f64> {
        let (sine, cosine) = (libm::sin(around), libm::cos(around));
        let distances = self.neighbours.iter().flatten().filter_map(|neighbour| {
            let [nx, ny] = neighbour.normal;
            let towards = cosine * nx + sine * ny;
            let [x, y] = neighbour.contact_at(z);
            let away = x * nx + y * ny;
            (towards > 1e-3).then(|| (away - radius) / towards)
        });
        distances.min_by(f64::total_cmp)
    }

    /// Returns the distance of the outer face from the axis. `crest` is the height of the crest at this angle.
    pub fn outer(&self, around: f64, z: f64, crest: f64) -> f64 {
        let inner = self.inner(around, z);
        let below = crest - z;
        let half = 0.5 * self.sizes.crest;
        let free = if below < half {
            // The crest is round.
            let up = (half - below.max(0.0)) / half;
            half + half * (1.0 - up * up).max(0.0).sqrt()
        } else {
            self.sizes.crest + SLOPE * (below - half)
        };
        let whole = self.envelope(around, z).max(inner + 0.05);
        (inner + free).min(whole)
    }

    /// Returns the outer face without the end at the crest.
    fn envelope(&self, around: f64, z: f64) -> f64 {
        let (sine, cosine) = (libm::sin(around), libm::cos(around));
        let Some(neighbour) = &self.neighbours[usize::from(cosine < 0.0)] else {
            return outer_face(&self.sections, self.sizes.wall, around, z);
        };
        let side = if sine < 0.0 { -1.0 } else { 1.0 };
        // The common outline runs from the middle of this side to the plane.
        let middle = std::f64::consts::FRAC_PI_2 * side;
        let most = outer_face(&self.sections, self.sizes.wall, middle, z);
        let end = neighbour.corner(side < 0.0, z);
        let plane = self.plane(around, z, 0.0).unwrap_or(FAR);
        let outline = |x: f64| {
            let share = ramp(x / end[0], 0.15, 1.0);
            most + (end[1] * side - most) * share
        };
        // Bisection outwards until the outline is crossed.
        let (mut inside, mut outside) = (0.0, FAR);
        for _ in 0..30 {
            let r = 0.5 * (inside + outside);
            if r * sine * side < outline(r * cosine) {
                inside = r;
            } else {
                outside = r;
            }
        }
        inside.min(plane)
    }
}
