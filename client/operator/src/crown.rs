//! The `crown` exercise: the probe's tip slides round the crown of a tooth under a light load, with lifts, up and down.
//!
//! The path is computed on the spheres of the tooth, so it fits every tooth of a scene.

use sulcus_core::{MAX_TOOLS, Object, Pose, Scene, Vec3};

use crate::frame::ToolFrame;
use crate::script::{Script, smoothstep};
use crate::sounding::{bearing_vector, first_touch, tip_radius};

/// Parameters of the exercise: lengths in metres, times in seconds, speeds in m/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrownParams {
    /// Length of the exercise. Default 20.
    pub duration: f64,
    /// Depth of the target tip below the surface. Default 2 mm, which gives about 0.4 N through hand and coupling.
    pub press: f64,
    /// Speed along the surface. Default 8 mm/s.
    pub speed: f64,
    /// Smallest and largest depth of the path below the highest cusp. Default 2 to 5 mm.
    pub below_top: [f64; 2],
    /// Time between two lifts. Default 2.5 s.
    pub lift_every: f64,
    /// Height of a lift above the surface. Default 2.5 mm.
    pub lift: f64,
}

impl Default for CrownParams {
    fn default() -> Self {
        Self {
            duration: 20.0,
            press: 2e-3,
            speed: 8e-3,
            below_top: [2e-3, 5e-3],
            lift_every: 2.5,
            lift: 2.5e-3,
        }
    }
}

/// Error of a scene without a crown for the exercise; one sentence.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NoCrown(pub String);

impl std::fmt::Display for NoCrown {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}", self.0)
    }
}

impl std::error::Error for NoCrown {}

/// Number of bearings of the path's table.
const BEARINGS: usize = 360;
/// Number of heights of the path's table.
const HEIGHTS: usize = 16;
/// Time of the approach, and of the retreat, seconds.
const TRANSIT: f64 = 1.2;
/// Distance from the crown at which the approach begins, metres.
const STANDOFF: f64 = 0.012;

/// Script of the `crown` exercise.
#[derive(Clone, Debug)]
pub struct Crown {
    params: CrownParams,
    tool: ToolFrame,
    /// Vertical axis of the crown: x and y, world, metres.
    axis: Vec3,
    /// Height of the highest cusp, world, metres.
    top: f64,
    /// Distance from the axis at which the tip touches, metres, by height and bearing.
    radius: Vec<[f64; BEARINGS]>,
    mean_radius: f64,
}

impl Crown {
    /// Script for the tooth with FDI number `fdi`, or for the first tooth, with the first tool.
    ///
    /// # Errors
    /// The scene has no such tooth, or the tooth has no surface all round at the heights of the path.
    pub fn new(scene: &Scene, fdi: Option<u8>, params: CrownParams) -> Result<Self, NoCrown> {
        let wanted = |object: &&Object| fdi.map_or(object.fdi != 0, |fdi| object.fdi == fdi);
        let tooth = scene.objects.iter().find(wanted).ok_or_else(|| {
            NoCrown(format!(
                "scene `{}` has no tooth to probe, expected an object with an FDI number",
                scene.name
            ))
        })?;
        let tool = &scene.tools[0];
        let spheres: Vec<_> = tooth
            .tree
            .shape_at(tooth.level)
            .map(|(_, node)| node.sphere())
            .collect();
        let (top, [low, high]) = tooth.top(7e-3);
        let mut axis = (low + high) * 0.5;
        axis.z = 0.0;
        let tip_radius = tip_radius(tool);
        let mut radius = Vec::with_capacity(HEIGHTS);
        for k in 0..HEIGHTS {
            let share = k as f64 / (HEIGHTS - 1) as f64;
            let z = top - params.below_top[0] - share * (params.below_top[1] - params.below_top[0]);
            let sound = |bearing: usize| {
                let out = bearing_vector(bearing as f64);
                let centre = Vec3::new(axis.x, axis.y, z);
                spheres
                    .iter()
                    .filter_map(|s| first_touch(&centre, &out, &s.centre, s.radius + tip_radius))
                    .fold(0.0, f64::max)
            };
            let raw: [f64; BEARINGS] = std::array::from_fn(sound);
            // A hand does not follow every bump: the path is a mean over 11 degrees.
            radius.push(std::array::from_fn(|b| {
                (0..11)
                    .map(|j| raw[(b + BEARINGS + j - 5) % BEARINGS])
                    .sum::<f64>()
                    / 11.0
            }));
        }
        let mean_radius = radius.iter().flatten().sum::<f64>() / (HEIGHTS * BEARINGS) as f64;
        if radius.iter().flatten().any(|r| r.is_nan() || *r <= 0.0) {
            return Err(NoCrown(format!(
                "tooth `{}` has no surface all round between {:.1} and {:.1} mm below its top; expected a tooth whose crown points along z",
                tooth.name,
                params.below_top[0] * 1e3,
                params.below_top[1] * 1e3
            )));
        }
        Ok(Self {
            params,
            tool: ToolFrame::of(tool),
            axis,
            top,
            radius,
            mean_radius,
        })
    }

    /// Distance of the tip's centre from the axis on the surface, metres, at a bearing in degrees and a share of the
    /// heights, 0 to 1.
    fn surface(&self, bearing: f64, share: f64) -> f64 {
        let row = share.clamp(0.0, 1.0) * (HEIGHTS - 1) as f64;
        let (r0, b0) = (row.floor() as usize, bearing.floor() as usize % BEARINGS);
        let (r1, b1) = ((r0 + 1).min(HEIGHTS - 1), (b0 + 1) % BEARINGS);
        let (fr, fb) = (row - row.floor(), bearing - bearing.floor());
        let mix = |row: usize| self.radius[row][b0] * (1.0 - fb) + self.radius[row][b1] * fb;
        mix(r0) * (1.0 - fr) + mix(r1) * fr
    }

    fn pose(&self, t: f64) -> Pose {
        let p = &self.params;
        let work = (p.duration - 2.0 * TRANSIT).max(0.0);
        let s = (t - TRANSIT).clamp(0.0, work);
        let degrees_per_second = p.speed / self.mean_radius * (180.0 / std::f64::consts::PI);
        let bearing = (s * degrees_per_second).rem_euclid(360.0);
        let share = 0.5 - 0.5 * libm::cos(std::f64::consts::TAU * s / 9.0);
        // A lift takes the last half second of each period.
        let phase = s.rem_euclid(p.lift_every) - (p.lift_every - 0.5);
        let lifted = if phase > 0.0 {
            smoothstep(phase / 0.2) * (1.0 - smoothstep((phase - 0.3) / 0.2))
        } else {
            0.0
        };
        let away = 1.0 - smoothstep(t / TRANSIT) + smoothstep((t - p.duration + TRANSIT) / TRANSIT);
        let depth = p.press * (1.0 - lifted) - p.lift * lifted;
        let depth = depth * (1.0 - away) - STANDOFF * away;
        let out = bearing_vector(bearing);
        let z = self.top - p.below_top[0] - share * (p.below_top[1] - p.below_top[0]);
        let tip =
            Vec3::new(self.axis.x, self.axis.y, z) + out * (self.surface(bearing, share) - depth);
        // The working end points down and inwards; the handle leans outwards.
        let down = (-Vec3::z() * 0.8 - out * 0.6).normalize();
        self.tool.at(&tip, &down, &out)
    }
}

impl Script for Crown {
    fn targets(&self, t: f64) -> [Option<Pose>; MAX_TOOLS] {
        let mut targets = [None; MAX_TOOLS];
        targets[0] = Some(self.pose(t));
        targets
    }
    fn duration_s(&self) -> f64 {
        self.params.duration
    }
}
