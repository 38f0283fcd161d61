//! Sight of the target past the tongue. Rays go from points of the tooth's surface to the eye, past the present spheres
//! of the tongue and past the mirror.
//!
//! The points are on the tongue's side of the crown, 0.7 to 2.7 mm above the gingival margin. Points that face away
//! from the eye, or that other teeth hide, are left out, because no retraction shows them.

use sulcus_core::math::norm;
use sulcus_core::output::status;
use sulcus_core::tissue::TissueModel;
use sulcus_core::{Pose, Scene, Sphere, TickOutput, Vec3, Workspace};

use super::pocket::Pocket;
use super::rays::Ray;
use crate::exercise::Target;

/// Time between two evaluations, seconds.
pub const EVERY_S: f64 = 0.05;
/// Amount by which the free share must fall below the required share before the target counts as hidden.
const HYSTERESIS: f64 = 0.15;
/// Angles of the points from mesial over buccal, degrees; below, their heights over the margin, metres.
const AROUND_DEG: [f64; 4] = [-60.0, -80.0, -100.0, -120.0];
const ABOVE: [f64; 3] = [0.7e-3, 1.7e-3, 2.7e-3];
/// Distance of a point from the surface, metres.
const OFF: f64 = 0.2e-3;
/// Least sine of the angle between a ray and the surface's plane.
const FACING: f64 = 0.1;

/// Centres of the tongue's leaves, which an evaluation reads from a tick's shapes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Look {
    /// Objects with their nodes, in the order of all nodes.
    tongues: Vec<(usize, Vec<u32>)>,
    radii: Vec<f64>,
    rest: Vec<Vec3>,
    any: bool,
    /// Number of ticks between two evaluations.
    every: u64,
}

impl Look {
    /// Leaves of a scene's tongues.
    pub fn new(scene: &Scene) -> Self {
        let mut look = Self {
            any: true,
            every: scene.params.ticks_in(EVERY_S).max(1),
            ..Self::default()
        };
        for (k, object) in scene.objects.iter().enumerate() {
            if !is_tongue(&object.tissue) {
                continue;
            }
            let leaves = object.tree.shape_at(object.tree.depth());
            let (ids, spheres): (Vec<u32>, Vec<Sphere>) =
                leaves.map(|(id, node)| (id, node.sphere())).unzip();
            look.radii
                .extend(spheres.iter().map(|sphere| sphere.radius));
            look.rest.extend(spheres.iter().map(|sphere| sphere.centre));
            look.tongues.push((k, ids));
        }
        look
    }

    /// Number of centres.
    pub fn len(&self) -> usize {
        self.radii.len()
    }

    /// Whether the scene has no tongue.
    pub fn is_empty(&self) -> bool {
        self.radii.is_empty()
    }

    /// Number of ticks between two evaluations.
    pub fn every(&self) -> u64 {
        self.every
    }

    /// Whether an evaluation is due after this tick.
    pub fn is_due(&self, tick: u64) -> bool {
        self.any && tick.is_multiple_of(self.every)
    }

    /// Reads the centres into `out`, world axes, metres. No allocation. If the length of `out` is not [`Look::len`],
    /// nothing is read.
    pub fn read(&self, shapes: &Workspace, out: &mut [Vec3]) {
        if out.len() != self.len() {
            return;
        }
        let mut from = 0;
        for (object, ids) in &self.tongues {
            let to = from + ids.len();
            if !shapes.centres_of(*object, ids, &mut out[from..to]) {
                out[from..to].copy_from_slice(&self.rest[from..to]);
            }
            from = to;
        }
    }
}

/// Whether a tissue is a tongue, which yields as a whole.
pub fn is_tongue(tissue: &TissueModel) -> bool {
    matches!(
        tissue,
        TissueModel::Skeleton(_) | TissueModel::Surface(_) | TissueModel::PrintedSkeleton(_)
    )
}

/// Result of an evaluation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Share of the points that the tongue leaves free.
    pub free: f64,
    /// Share of the points that tongue and mirror leave free.
    pub free_past_mirror: f64,
    /// Number of points.
    pub of: usize,
    /// New visibility, if the evaluation has changed it.
    pub changed: Option<bool>,
}

/// Target and its visibility.
#[derive(Clone, Debug)]
pub struct Sight {
    tooth: u8,
    rays: Vec<Ray>,
    wanted: f64,
    visible: Option<bool>,
    /// Spheres of the tools that are no probes, in the tools' frames.
    mirrors: Vec<(usize, Vec<Sphere>)>,
    // Memory for the present spheres.
    tongue: Vec<Sphere>,
    mirror: Vec<Sphere>,
}

impl Sight {
    /// Target in a scene.
    ///
    /// # Errors
    /// The scene lacks a part of the target: the missing part as text.
    pub fn new(scene: &Scene, pockets: &[Pocket], target: &Target) -> Result<Self, String> {
        let pocket = pockets
            .iter()
            .find(|pocket| pocket.fdi == target.tooth && !pocket.spheres().is_empty())
            .ok_or_else(|| format!("a tooth {} with its gingiva as the target", target.tooth))?;
        let eye = Vec3::from(target.eye_mm) * 1e-3;
        let rays: Vec<Ray> = points(scene, pocket)
            .into_iter()
            .map(|(point, outward)| (Ray::new(point, eye), outward))
            .filter(|(ray, outward)| ray.way().dot(outward) >= FACING)
            .map(|(ray, _)| ray)
            .filter(|ray| {
                let others = scene
                    .objects
                    .iter()
                    .filter(|object| object.tissue.is_rigid() && object.fdi != pocket.fdi);
                let mut spheres = others.flat_map(|object| object.tree.shape_at(object.level));
                !spheres.any(|(_, node)| ray.meets(&node.sphere()))
            })
            .collect();
        if rays.is_empty() {
            return Err(format!(
                "a place of tooth {} that can be seen from the eye",
                target.tooth
            ));
        }
        let mirrors: Vec<(usize, Vec<Sphere>)> = scene
            .tools
            .iter()
            .enumerate()
            .filter(|(_, tool)| tool.bands.is_empty())
            .map(|(t, tool)| {
                let leaves = tool.tree.shape_at(tool.level);
                (t, leaves.map(|(_, node)| node.sphere()).collect())
            })
            .collect();
        Ok(Self {
            tooth: target.tooth,
            rays,
            wanted: target.visible,
            visible: None,
            mirrors,
            tongue: Vec::new(),
            mirror: Vec::new(),
        })
    }

    /// FDI number of the tooth.
    pub fn tooth(&self) -> u8 {
        self.tooth
    }

    /// Whether the target was visible at the last evaluation.
    pub fn is_visible(&self) -> bool {
        self.visible == Some(true)
    }

    /// Evaluates sight with the tongue's spheres at `centres`.
    pub fn evaluate(
        &mut self,
        scene: &Scene,
        output: &TickOutput,
        centres: &[Vec3],
        look: &Look,
    ) -> View {
        let spheres = centres.iter().zip(&look.radii);
        self.tongue.clear();
        self.tongue.extend(spheres.map(|(centre, radius)| Sphere {
            centre: *centre,
            radius: *radius,
        }));
        self.mirror.clear();
        for (t, spheres) in &self.mirrors {
            let out = &output.tools[*t];
            if *t < scene.tools.len() && out.status & status::ABSENT == 0 {
                let pose: &Pose = &out.graphic;
                self.mirror.extend(spheres.iter().map(|sphere| Sphere {
                    centre: pose.transform(&sphere.centre),
                    radius: sphere.radius,
                }));
            }
        }
        let (mut free, mut past) = (0, 0);
        for ray in &self.rays {
            if ray.is_free(&self.tongue) {
                free += 1;
                past += usize::from(ray.is_free(&self.mirror));
            }
        }
        let of = self.rays.len();
        let free = free as f64 / of as f64;
        let changed = self.judge(free);
        View {
            free,
            free_past_mirror: past as f64 / of as f64,
            of,
            changed,
        }
    }

    /// New visibility by a free share; `None` without a change.
    fn judge(&mut self, free: f64) -> Option<bool> {
        let now = match self.visible {
            Some(true) => free >= self.wanted - HYSTERESIS,
            _ => free >= self.wanted,
        };
        let changed = self.visible != Some(now);
        self.visible = Some(now);
        changed.then_some(now)
    }
}

/// Points of the tooth's surface on the tongue's side, with their outward directions.
fn points(scene: &Scene, pocket: &Pocket) -> Vec<(Vec3, Vec3)> {
    let Some(gingiva) = pocket.gingiva(scene) else {
        return Vec::new();
    };
    let frame = &gingiva.tooth;
    let mut points = Vec::new();
    for around in AROUND_DEG.map(f64::to_radians) {
        let outward = frame.mesial * libm::cos(around) + frame.buccal * libm::sin(around);
        for above in ABOVE {
            let on_axis = frame.origin + frame.axis * (gingiva.margin_at(around) + above);
            // Distances at which the outward line leaves the spheres.
            let leaves = pocket.spheres().iter().filter_map(|sphere| {
                let to = sphere.centre - on_axis;
                let along = to.dot(&outward);
                let beside = norm(&(to - outward * along));
                let half = sphere.radius * sphere.radius - beside * beside;
                (half > 0.0).then(|| along + half.sqrt())
            });
            if let Some(at) = leaves.reduce(|a, b| if b > a { b } else { a }) {
                points.push((on_axis + outward * (at + OFF), outward));
            }
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn visible_and_hidden_have_a_gap_between_them() {
        let mut sight = Sight {
            tooth: 36,
            rays: Vec::new(),
            wanted: 0.7,
            visible: None,
            mirrors: Vec::new(),
            tongue: Vec::new(),
            mirror: Vec::new(),
        };
        // The first evaluation always reports a change.
        let told = [0.6, 0.69, 0.7, 0.6, 0.56, 0.54, 0.6, 0.71, 0.0].map(|free| sight.judge(free));
        let said = |visible| Some(visible);
        assert_eq!(
            told,
            [
                said(false),
                None,
                said(true),
                None,
                None,
                said(false),
                None,
                said(true),
                said(false)
            ]
        );
    }
}
