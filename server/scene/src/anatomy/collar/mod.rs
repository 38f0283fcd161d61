//! The gingiva of one tooth: a collar with a pocket between itself and the tooth.
//!
//! Frame: the tooth's (x mesial, y buccal, z occlusal, origin on its axis at the buccal CEJ), millimetres. All of the shape
//! is radial: at an angle and a height the pocket's wall stands at the tooth's surface (its convex section, so that tissue
//! bridges furcations) plus the pocket's width; the outer face follows the tooth, and, towards a neighbour, the common
//! outline of both, up to a plane through their contact point. Between them the papilla fills what room there is under
//! the contact: less in the middle than at both sides, which makes the col. Below the floor tissue is attached, and so is what
//! fills the space between roots ([`Entrance`]).

mod furcation;
mod packing;
mod skin;
mod sulcus;

pub use furcation::Entrance;
pub use packing::{Packed, pack};
pub use skin::skin;
pub use sulcus::Sulcus;

use super::sections::Sections;
use super::tooth::Tooth;
use crate::mesh::implicit::ramp;

/// Sizes of a collar, mm.
#[derive(Clone, Debug, PartialEq)]
pub struct CollarSizes {
    /// Width between tooth and gingiva at rest. A real one is about 0.4, and a probe's tip 0.5.
    pub width: f64,
    /// Thickness of the free margin.
    pub crest: f64,
    /// Thickness of the wall farther down.
    pub wall: f64,
    /// Height of the base, where what lies below begins.
    pub base: f64,
    /// How much higher than the prescribed depth the floor lies at rest.
    pub sink: f64,
}

/// A neighbour's side of a collar.
#[derive(Clone, Debug)]
pub struct Neighbour {
    /// Contact point, across the axis.
    pub contact: [f64; 2],
    /// Unit normal of the plane between both teeth, towards the neighbour.
    pub normal: [f64; 2],
    /// How far the outer face lies from the contact point along the plane, buccally and lingually, by height.
    pub faces: [Face; 2],
    /// The neighbour's FDI number, and which of its ends stands here (0 mesial, 1 distal).
    pub end: (u8, usize),
    /// Height that the neighbour's floor is read at where it is deepest beside the plane, buccally and lingually; of no concern
    /// when left at infinity.
    pub floors: [f64; 2],
}

impl Neighbour {
    /// Where the outer face of a side meets the plane at a height, across the axis, mm.
    pub fn corner(&self, lingual: bool, z: f64) -> [f64; 2] {
        let [nx, ny] = self.normal;
        // Along the plane, towards that side: buccal is y.
        let side = if (nx < 0.0) == lingual { 1.0 } else { -1.0 };
        let (ax, ay) = (-ny * side, nx * side);
        let face = self.faces[usize::from(lingual)].at(z);
        [self.contact[0] + ax * face, self.contact[1] + ay * face]
    }
}

/// The outer face's distance by height: linear between heights at equal steps.
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

/// A pocket at its tooth.
#[derive(Clone, Debug)]
pub struct Collar {
    /// The tooth.
    pub tooth: Tooth,
    /// How far it reaches from its axis.
    pub sections: Sections,
    /// Entrances between its roots.
    pub entrances: Vec<Entrance>,
    /// Depths and margins.
    pub sulcus: Sulcus,
    /// Sizes.
    pub sizes: CollarSizes,
    /// Mesial and distal neighbour.
    pub neighbours: [Option<Neighbour>; 2],
}

/// Room between the pocket's wall and the plane to a neighbour that tissue needs, mm.
const LEAST_TISSUE: f64 = 0.22;
/// How far tissue reaches under the crest before it has its whole thickness, mm of thickness for each mm of height.
const SLOPE: f64 = 0.8;
/// Height below which the outer face goes straight down, whatever the root does, mm.
const STRAIGHT: f64 = -5.0;
/// How much thicker the wall is for each mm farther down.
const THICKENING: f64 = 0.1;
/// Farthest from the axis that an outer face is looked for, mm.
const FAR: f64 = 16.0;

/// Distance of the outer face from the axis beside no neighbour: the tooth's own radius and the wall, which thickens
/// downwards from the cemento-enamel junction.
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

    /// Height that the floor is read at where it is deepest at an end (0 mesial, 1 distal), buccally and lingually.
    pub fn floors_at(&self, end: usize) -> [f64; 2] {
        let sites = self.sulcus.sites();
        let sites = [[sites[0], sites[5]], [sites[2], sites[3]]][end];
        sites.map(|around| self.floor(around) - self.sizes.sink)
    }

    /// Height that the neighbour's floor is read at beyond the plane at an angle, if a sphere of that radius at a distance from the axis reaches
    /// over.
    fn beyond(&self, around: f64, r: f64, radius: f64) -> Option<f64> {
        let most = self.plane(around, radius)?;
        let neighbour = self.neighbours[usize::from(libm::cos(around) < 0.0)].as_ref()?;
        (r > most).then_some(neighbour.floors[usize::from(libm::sin(around) < 0.0)])
    }

    /// Height of the tissue's crest: the margin, or, under a contact, as high as there is room for tissue.
    pub fn crest(&self, around: f64) -> f64 {
        let margin = self.sulcus.margin(around);
        let floor = self.floor(around);
        let mut z = margin;
        while z > floor + 0.2 {
            let room = self.plane(around, 0.0).unwrap_or(FAR) - self.inner(around, z);
            if room >= LEAST_TISSUE {
                break;
            }
            z -= 0.1;
        }
        z
    }

    /// Farthest from the axis that the middle of a sphere of that radius can be at an angle without reaching over the plane to a
    /// neighbour, if there is one that way.
    fn plane(&self, around: f64, radius: f64) -> Option<f64> {
        let (sine, cosine) = (libm::sin(around), libm::cos(around));
        let distances = self.neighbours.iter().flatten().filter_map(|neighbour| {
            let [nx, ny] = neighbour.normal;
            let towards = cosine * nx + sine * ny;
            let away = neighbour.contact[0] * nx + neighbour.contact[1] * ny;
            (towards > 1e-3).then(|| (away - radius) / towards)
        });
        distances.min_by(f64::total_cmp)
    }

    /// Distance of the outer face from the axis, `crest` being the tissue's crest at this angle.
    pub fn outer(&self, around: f64, z: f64, crest: f64) -> f64 {
        let inner = self.inner(around, z);
        let below = crest - z;
        let half = 0.5 * self.sizes.crest;
        let free = if below < half {
            // Round on top.
            let up = (half - below.max(0.0)) / half;
            half + half * (1.0 - up * up).max(0.0).sqrt()
        } else {
            self.sizes.crest + SLOPE * (below - half)
        };
        let whole = self.envelope(around, z).max(inner + 0.05);
        (inner + free).min(whole)
    }

    /// The outer face where nothing comes to an end above it.
    fn envelope(&self, around: f64, z: f64) -> f64 {
        let (sine, cosine) = (libm::sin(around), libm::cos(around));
        let Some(neighbour) = &self.neighbours[usize::from(cosine < 0.0)] else {
            return outer_face(&self.sections, self.sizes.wall, around, z);
        };
        let side = if sine < 0.0 { -1.0 } else { 1.0 };
        // The common outline: from the middle of this side to the plane.
        let middle = std::f64::consts::FRAC_PI_2 * side;
        let most = outer_face(&self.sections, self.sizes.wall, middle, z);
        let end = neighbour.corner(side < 0.0, z);
        let plane = self.plane(around, 0.0).unwrap_or(FAR);
        let outline = |x: f64| {
            let share = ramp(x / end[0], 0.15, 1.0);
            most + (end[1] * side - most) * share
        };
        // Outwards until the outline is crossed.
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
