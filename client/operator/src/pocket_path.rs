//! Poses of a probe in a pocket: places of the tip on a tooth's surface below the gingival margin, and the probe's tilt
//! there. With that tilt the shaft clears the tooth's crown and its neighbours.
//!
//! A place is an angle about the tooth's axis, radians from mesial over buccal, and a depth below the margin at that
//! angle, metres along the axis. `ToothFrame::cylindrical` and the readings of a pocket use the same coordinates.

use sulcus_core::math::exp_rotation;
use sulcus_core::tissue::TissueModel;
use sulcus_core::tissue::gingiva::{Gingiva, Prescribed, ToothFrame};
use sulcus_core::{Object, Pose, Scene, Vec3};

use crate::frame::ToolFrame;
pub use crate::lean::Manner;
use crate::lean::{Leans, up};
use crate::shaft::{Obstacles, Shaft};
use crate::sounding::tip_radius;
use crate::wall::Wall;

/// Error of a scene without the tooth or its gingiva; one sentence.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct NoPocket(pub String);

/// Ratio of the handle's direction towards the cheek to its direction out of the mouth.
const TO_CHEEK: f64 = 0.4;

/// Poses of one tool in the pocket of one tooth.
#[derive(Clone, Debug)]
pub struct PocketPath {
    /// FDI number of the tooth.
    pub fdi: u8,
    /// Slot of the tool.
    pub slot: usize,
    /// Depth of the target tip inside the tooth's surface, metres, so that its side stays on the tooth.
    pub hug: f64,
    /// Visible part of the gingiva: margin, zones and bleeding. Its depths are zero.
    gingiva: Gingiva,
    tool: ToolFrame,
    tip: f64,
    wall: Wall,
    /// Tilts of the buccal and the lingual side.
    leans: [Leans; 2],
    /// Direction of the handle, world: out of the mouth and towards the cheek.
    side: Vec3,
}

/// Tip and directions of the probe at a place of the pocket, world axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Extreme point of the tip, metres.
    pub tip: Vec3,
    /// Unit vector up along the working end.
    pub up: Vec3,
    /// Unit vector away from the tooth's axis.
    pub outward: Vec3,
}

impl PocketPath {
    /// Poses at the tooth with FDI number `fdi`, or at the first tooth, for the first tool with bands, or the first
    /// tool.
    ///
    /// # Errors
    /// The scene has no such tooth, or no gingiva around it.
    pub fn new(scene: &Scene, fdi: Option<u8>, hug: f64, manner: Manner) -> Result<Self, NoPocket> {
        let wanted = |object: &&Object| fdi.map_or(object.fdi != 0, |fdi| object.fdi == fdi);
        let is_tooth = |object: &&Object| object.tissue.is_rigid() && wanted(object);
        let tooth = scene.objects.iter().find(is_tooth).ok_or_else(|| {
            let which = fdi.map_or(String::new(), |fdi| format!(" {fdi}"));
            NoPocket(format!(
                "scene `{}` has no tooth{which} to probe, expected a rigid object with an FDI number",
                scene.name
            ))
        })?;
        let gingiva = gingiva_of(scene, tooth).ok_or_else(|| {
            NoPocket(format!(
                "scene `{}` has no gingiva around tooth `{}`",
                scene.name, tooth.name
            ))
        })?;
        let slot = scene
            .tools
            .iter()
            .position(|tool| !tool.bands.is_empty())
            .unwrap_or(0);
        let tool = &scene.tools[slot];
        let frame = ToolFrame::of(tool);
        let gingiva = Gingiva {
            params: gingiva.params,
            tooth: gingiva.tooth,
            margin: gingiva.margin.clone(),
            proximal: gingiva.proximal,
            sites: gingiva.sites.map(|site| Prescribed { depth: 0.0, ..site }),
            places: Vec::new(),
            level: gingiva.level,
        };
        let tip = tip_radius(tool);
        let wall = Wall::of(tooth, &gingiva.tooth, tip);
        let side = Vec3::x() + gingiva.tooth.buccal * TO_CHEEK;
        let mut path = Self {
            fdi: tooth.fdi,
            slot,
            hug,
            tool: frame,
            tip,
            wall,
            leans: [Leans::none(), Leans::none()],
            side,
            gingiva,
        };
        let shaft = Shaft::of(tool, &frame);
        let all = Obstacles::near(scene, &path.gingiva.tooth.origin, 15e-3);
        path.leans = [1.0, -1.0].map(|sign| {
            Leans::search(sign, manner, |around, depth, tilts, less| {
                let ball = path.ball(around, depth, 0.0);
                let mut near = all.above(&ball, &path.gingiva.tooth.axis);
                tilts.iter().copied().find(|tilt| {
                    let up = path.up(*tilt);
                    let axes = frame.axes(&-up, &path.side);
                    near.passes(&shaft, &(ball - up * tip), &axes, less)
                })
            })
        });
        Ok(path)
    }

    /// Frame of the tooth: origin, axis, mesial and buccal direction.
    pub fn tooth(&self) -> &ToothFrame {
        &self.gingiva.tooth
    }

    /// Visible part of the gingiva: margin, zones and bleeding. All depths are zero.
    pub fn gingiva(&self) -> &Gingiva {
        &self.gingiva
    }

    /// Shallowest depth with room for the tip at an angle, metres; `None` if the shaft cannot clear its surroundings.
    pub fn ceiling(&self, around: f64) -> Option<f64> {
        self.leans_of(around).ceiling_at(around.abs())
    }

    /// Angle of a point of the world, radians, and its depth below the margin at that angle, metres.
    pub fn seen(&self, point: &Vec3) -> (f64, f64) {
        let (around, height) = self.gingiva.tooth.cylindrical(point);
        (around, self.gingiva.margin_at(around) - height)
    }

    /// Distance from the tooth's axis to the centre of the tip's ball on the tooth's surface, metres.
    pub fn radius(&self, around: f64, depth: f64) -> f64 {
        let height = self.gingiva.margin_at(around) - depth + self.tip;
        self.wall.radius_at(around, height)
    }

    /// Depth, negative, at which the centre of the tip's ball is above the tooth by the ball's radius, metres.
    pub fn over(&self, around: f64) -> f64 {
        self.gingiva.margin_at(around) - self.wall.top()
    }

    /// Place at an angle and a depth below the margin, with a further tilt of `tilt` radians away from the tooth.
    pub fn place(&self, around: f64, depth: f64, tilt: f64) -> Place {
        let outward = self.wall.outward(around);
        let ball = self.ball(around, depth, self.hug);
        let straight = self.up(self.leans_of(around).at(around.abs(), depth));
        let about = self.gingiva.tooth.axis.cross(&outward);
        let up = exp_rotation(&(about * tilt)) * straight;
        Place {
            tip: ball - up * self.tip,
            up,
            outward,
        }
    }

    /// Device pose (`world_from_tool`) at a place, with a further tilt of `tilt` radians away from the tooth, and with
    /// its tip moved by `off`, world, metres.
    pub fn pose(&self, around: f64, depth: f64, tilt: f64, off: Vec3) -> Pose {
        let place = self.place(around, depth, tilt);
        self.tool.at(&(place.tip + off), &-place.up, &self.side)
    }

    /// Centre of the tip's ball at a place, `hug` metres inside the position of first touch.
    fn ball(&self, around: f64, depth: f64, hug: f64) -> Vec3 {
        let frame = &self.gingiva.tooth;
        let height = self.gingiva.margin_at(around) - depth + self.tip;
        let radius = self.wall.radius_at(around, height) - hug;
        frame.origin + frame.axis * height + self.wall.outward(around) * radius
    }

    fn up(&self, tilt: [f64; 2]) -> Vec3 {
        let frame = &self.gingiva.tooth;
        up(&frame.axis, &frame.mesial, &frame.buccal, tilt)
    }

    fn leans_of(&self, around: f64) -> &Leans {
        &self.leans[usize::from(around < 0.0)]
    }
}

/// Gingiva of a tooth: the one with its FDI number, else the nearest one without a number.
fn gingiva_of<'a>(scene: &'a Scene, tooth: &Object) -> Option<&'a Gingiva> {
    let all = scene.objects.iter().filter_map(|object| {
        let TissueModel::Gingiva(model) = &object.tissue else {
            return None;
        };
        Some((object.fdi, &**model))
    });
    let middle = tooth.tree.nodes()[0].centre;
    let rank = |(fdi, model): &(u8, &Gingiva)| {
        let others = *fdi != tooth.fdi;
        (others, (model.tooth.origin - middle).norm())
    };
    let nearest = all.min_by(|a, b| {
        let (a, b) = (rank(a), rank(b));
        a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
    })?;
    // A gingiva with another number belongs to another tooth.
    (nearest.0 == tooth.fdi || nearest.0 == 0).then_some(nearest.1)
}
