//! The way into a pocket: the tooth's wall, the gingival margin over it, and how a probe has to lean to
//! stay on the wall without the crown in its way. Laid on the spheres of a scene.

use sulcus_core::math::norm;
use sulcus_core::{Object, Pose, Scene, Tool, Vec3};

use crate::frame::ToolFrame;
use crate::sounding::{bearing_vector, first_touch, tip_radius};

/// Why there is no way into a pocket.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct NoPocket(pub String);

/// Bearings and heights at which the tooth is sounded.
const BEARINGS: usize = 72;
const BEARING_STEP: f64 = 360.0 / BEARINGS as f64;
const HEIGHT_STEP: f64 = 0.25e-3;

/// Ways into the pocket of one tooth for one tool. Bearings are degrees from x (anterior) over y (the patient's
/// left), world axes.
#[derive(Clone, Debug)]
pub struct PocketPath {
    /// Slot of the tool.
    pub slot: usize,
    /// How far inside the tooth's surface the tip is meant to be, so that its side stays on it, metres.
    pub hug: f64,
    tool: ToolFrame,
    tooth: Sounded,
    /// Radius of the shaft by distance from the tip.
    shaft: Vec<(f64, f64)>,
    left: bool,
}

/// The tooth's surface and the margin around it.
#[derive(Clone, Debug)]
struct Sounded {
    axis: Vec3,
    bottom: f64,
    /// Distance from the axis at which the tip's centre touches, by bearing and height above `bottom`.
    radius: Vec<Vec<f64>>,
    margin: [f64; BEARINGS],
}

impl PocketPath {
    /// Ways along the tooth with FDI number `fdi`, or the first tooth, for the first tool that has bands, or the
    /// first tool.
    ///
    /// # Errors
    /// When the scene has no tooth or nothing that yields around it.
    pub fn new(scene: &Scene, fdi: Option<u8>, hug: f64) -> Result<Self, NoPocket> {
        let wanted = |object: &&Object| fdi.map_or(object.fdi != 0, |fdi| object.fdi == fdi);
        let is_tooth = |object: &&Object| object.tissue.is_rigid() && wanted(object);
        let tooth = scene.objects.iter().find(is_tooth).ok_or_else(|| {
            NoPocket(format!(
                "scene `{}` has no tooth to probe (a rigid object with an FDI number)",
                scene.name
            ))
        })?;
        let slot = scene
            .tools
            .iter()
            .position(|tool| !tool.bands.is_empty())
            .unwrap_or(0);
        let tool = &scene.tools[slot];
        Ok(Self {
            slot,
            hug,
            tool: ToolFrame::of(tool),
            tooth: Sounded::of(scene, tooth, tool)?,
            shaft: shaft_of(tool),
            left: matches!(tooth.fdi / 10, 0 | 2 | 3 | 6 | 7),
        })
    }

    /// World bearing of a bearing from mesial over buccal. (Mesial of a posterior tooth is anterior; buccal is to
    /// the patient's left on the left side of the mouth.)
    pub fn bearing(&self, site: f64) -> f64 {
        if self.left { site } else { 360.0 - site }
    }

    /// Whether there is a margin at a bearing.
    pub fn is_open(&self, bearing: f64) -> bool {
        self.tooth.margin_at(bearing).is_finite()
    }

    /// Distance from the tooth's axis to the tip's centre where it touches the tooth at a depth below the margin.
    pub fn radius(&self, bearing: f64, depth: f64) -> f64 {
        let z = self.tooth.margin_at(bearing) - depth;
        self.tooth.radius_at(bearing, z)
    }

    /// Device pose at a bearing and a depth below the margin, tilted by `tilt` radians away from the tooth, and set
    /// off by `off`.
    pub fn pose(&self, bearing: f64, depth: f64, tilt: f64, off: Vec3) -> Pose {
        let (tip, pointing) = self.place(bearing, depth, tilt);
        self.tool
            .at(&(tip + off), &pointing, &bearing_vector(bearing))
    }

    /// Tip and the direction out of it for a bearing (degrees), a depth below the margin, and a tilt away from the tooth.
    pub fn place(&self, bearing: f64, depth: f64, tilt: f64) -> (Vec3, Vec3) {
        let out = bearing_vector(bearing);
        let z = self.tooth.margin_at(bearing) - depth;
        let r = self.tooth.radius_at(bearing, z) - self.hug;
        let lean = self.lean(bearing, r, z);
        // The tip stays where it is; the shaft tilts in the plane through the tooth's axis.
        let angle = lean + tilt;
        let up = Vec3::z() * libm::cos(angle) + out * libm::sin(angle);
        let tip = Vec3::new(self.tooth.axis.x, self.tooth.axis.y, z) + out * r;
        (tip, -up)
    }

    /// Smallest outward lean, radians, with which the shaft clears the crown above a tip at `r` and `z`.
    fn lean(&self, bearing: f64, r: f64, z: f64) -> f64 {
        let least = self.shaft[0].1;
        let mut lean: f64 = 0.0;
        for (along, radius) in &self.shaft[1..] {
            let above = z + along;
            if above > self.tooth.top() {
                break;
            }
            let needed = self.tooth.radius_at(bearing, above) + (radius - least) - r;
            lean = lean.max(libm::atan2(needed - self.hug, *along));
        }
        lean
    }
}

impl Sounded {
    fn of(scene: &Scene, tooth: &Object, tool: &Tool) -> Result<Self, NoPocket> {
        let spheres: Vec<_> = tooth
            .tree
            .shape_at(tooth.level)
            .map(|(_, node)| node.sphere())
            .collect();
        let huge = Vec3::repeat(f64::INFINITY);
        let (low, high) = spheres.iter().fold((huge, -huge), |(low, high), s| {
            let r = Vec3::repeat(s.radius);
            (low.inf(&(s.centre - r)), high.sup(&(s.centre + r)))
        });
        let mut axis = (low + high) * 0.5;
        axis.z = 0.0;
        let gingiva = gingiva_around(scene, &axis).ok_or_else(|| {
            NoPocket(format!(
                "scene `{}` has no gingiva around tooth `{}` (an object that yields)",
                scene.name, tooth.name
            ))
        })?;
        let tip_radius = tip_radius(tool);
        let heights = ((high.z - low.z) / HEIGHT_STEP).ceil() as usize + 1;
        let mut radius = Vec::with_capacity(BEARINGS);
        for b in 0..BEARINGS {
            let out = bearing_vector(b as f64 * BEARING_STEP);
            let at = |k: usize| {
                let centre = Vec3::new(axis.x, axis.y, low.z + k as f64 * HEIGHT_STEP);
                spheres
                    .iter()
                    .filter_map(|s| first_touch(&centre, &out, &s.centre, s.radius + tip_radius))
                    .fold(0.0, f64::max)
            };
            radius.push((0..heights).map(at).collect());
        }
        let mut sounded = Self {
            axis,
            bottom: low.z,
            radius,
            margin: [f64::NEG_INFINITY; BEARINGS],
        };
        // The margin is the highest gingiva close to the tooth.
        for (_, node) in gingiva.tree.shape_at(gingiva.level) {
            let from = node.centre - axis;
            let bearing = libm::atan2(from.y, from.x).to_degrees().rem_euclid(360.0);
            let distance = libm::hypot(from.x, from.y) - node.contact_radius;
            if distance > sounded.radius_at(bearing, node.centre.z) + 1.5e-3 {
                continue;
            }
            let b = (bearing / BEARING_STEP).round() as usize;
            for near in [b + BEARINGS - 1, b, b + 1] {
                let margin = &mut sounded.margin[near % BEARINGS];
                *margin = margin.max(node.centre.z + node.contact_radius);
            }
        }
        Ok(sounded)
    }

    fn top(&self) -> f64 {
        self.bottom + (self.radius[0].len() - 1) as f64 * HEIGHT_STEP
    }

    /// Distance from the axis at which the tip's centre touches.
    fn radius_at(&self, bearing: f64, z: f64) -> f64 {
        let rows = self.radius[0].len();
        let row = ((z - self.bottom) / HEIGHT_STEP).clamp(0.0, (rows - 1) as f64);
        let (k, f) = (row.floor() as usize, row - row.floor());
        around(bearing, |b| {
            self.radius[b][k] * (1.0 - f) + self.radius[b][(k + 1).min(rows - 1)] * f
        })
    }

    fn margin_at(&self, bearing: f64) -> f64 {
        around(bearing, |b| self.margin[b])
    }
}

/// Linear between the bearings that were sounded.
fn around(bearing: f64, value: impl Fn(usize) -> f64) -> f64 {
    let at = bearing.rem_euclid(360.0) / BEARING_STEP;
    let (b, f) = (at.floor() as usize % BEARINGS, at - at.floor());
    value(b) * (1.0 - f) + value((b + 1) % BEARINGS) * f
}

/// The yielding object whose middle is nearest to a tooth's axis.
fn gingiva_around<'a>(scene: &'a Scene, axis: &Vec3) -> Option<&'a Object> {
    let middle = |object: &Object| {
        let root = &object.tree.nodes()[0].centre;
        let from = root - axis;
        norm(&Vec3::new(from.x, from.y, 0.0))
    };
    scene
        .objects
        .iter()
        .filter(|object| !object.tissue.is_rigid())
        .min_by(|a, b| middle(a).total_cmp(&middle(b)))
}

/// Largest radius of the working end by distance from the tip, every half millimetre: how far its surface is
/// from the straight line out of the tip.
fn shaft_of(tool: &Tool) -> Vec<(f64, f64)> {
    const STEP: f64 = 0.5e-3;
    let back = -tool.tip_axis;
    let mut shaft: Vec<(f64, f64)> = (0..32).map(|k| (f64::from(k) * STEP, 0.0)).collect();
    for (_, node) in tool.tree.shape_at(tool.level) {
        let from = node.centre - tool.tip;
        let along = from.dot(&back);
        let k = (along / STEP).round();
        if k >= 0.0 && k < shaft.len() as f64 {
            let off = norm(&(from - back * along)) + node.contact_radius;
            let radius = &mut shaft[k as usize].1;
            *radius = radius.max(off);
        }
    }
    // No sphere at a distance means no more than beside it.
    for k in 1..shaft.len() {
        shaft[k].1 = shaft[k].1.max(shaft[k - 1].1);
    }
    shaft
}
