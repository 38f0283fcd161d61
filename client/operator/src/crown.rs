//! The `crown` exercise: the probe's tip is led round the crown of a tooth, pressed lightly
//! against it, lifted off now and then, and moved up and down.
//!
//! The path is laid on the tooth's own spheres, so it fits any tooth that a scene names.

use sulcus_core::math::{Mat3, Quat};
use sulcus_core::{MAX_TOOLS, Object, Pose, Scene, Tool, Vec3};

use crate::script::{Script, smoothstep};

/// How the crown is probed. Lengths in metres, times in seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrownParams {
    /// Length of the exercise. Default 20.
    pub duration: f64,
    /// Depth of the intended tip below the surface. Default 2 mm: about 0.4 N through hand and
    /// coupling.
    pub press: f64,
    /// Speed along the surface. Default 8 mm/s.
    pub speed: f64,
    /// Band of heights below the highest cusp. Default 2 to 5 mm.
    pub below_top: [f64; 2],
    /// Time between two lifts. Default 2.5 s.
    pub lift_every: f64,
    /// How far the tip lifts off the surface. Default 2.5 mm.
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

/// Why the exercise cannot be performed in a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NoCrown(pub String);

impl std::fmt::Display for NoCrown {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}", self.0)
    }
}

impl std::error::Error for NoCrown {}

/// Directions in which the tooth is sounded.
const BEARINGS: usize = 360;
/// Heights at which it is sounded.
const HEIGHTS: usize = 16;
/// Time to come in and to leave, seconds.
const TRANSIT: f64 = 1.2;
/// How far outside the crown the approach begins, metres.
const STANDOFF: f64 = 0.012;

/// The script.
#[derive(Clone, Debug)]
pub struct Crown {
    params: CrownParams,
    tool: ToolFrame,
    axis: Vec3,
    top: f64,
    /// Distance from the tooth's axis at which the tip touches, by height and bearing.
    radius: Vec<[f64; BEARINGS]>,
    mean_radius: f64,
}

/// What the script needs of the tool: its tip and two directions in its frame.
#[derive(Clone, Copy, Debug)]
struct ToolFrame {
    tip: Vec3,
    /// Columns: out of the tip, towards the handle across it, their cross product.
    basis: Mat3,
}

impl Crown {
    /// The exercise on the tooth with FDI number `fdi`, or the first tooth, with the first tool.
    ///
    /// # Errors
    /// When the scene has no tooth, or its tooth no crown to go round.
    pub fn new(scene: &Scene, fdi: Option<u8>, params: CrownParams) -> Result<Self, NoCrown> {
        let wanted = |object: &&Object| fdi.map_or(object.fdi != 0, |fdi| object.fdi == fdi);
        let tooth = scene.objects.iter().find(wanted).ok_or_else(|| {
            NoCrown(format!(
                "scene `{}` has no tooth to probe (an object with an FDI number)",
                scene.name
            ))
        })?;
        let tool = &scene.tools[0];
        let spheres: Vec<_> = tooth
            .tree
            .shape_at(tooth.level)
            .map(|(_, node)| node.sphere())
            .collect();
        let top = spheres
            .iter()
            .map(|s| s.centre.z + s.radius)
            .fold(f64::NEG_INFINITY, f64::max);
        // The middle of what the crown takes up: it must not depend on where the spheres are crowded.
        let crown = spheres.iter().filter(|s| s.centre.z > top - 7e-3);
        let (low, high) = crown.fold(
            (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY)),
            |(low, high), s| {
                (
                    low.zip_map(&s.centre, |a, x| f64::min(a, x - s.radius)),
                    high.zip_map(&s.centre, |a, x| f64::max(a, x + s.radius)),
                )
            },
        );
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
            // A hand does not follow every bump: mean over 11 degrees.
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
                "tooth `{}` has no surface all round between {:.1} and {:.1} mm below its top: is z up, and is it a tooth?",
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

    /// Radius of the surface (for the tip's centre) at a bearing in degrees and a height share 0..1.
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
        // Lifts: half a second, smoothly, at the end of each period.
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

impl ToolFrame {
    fn of(tool: &Tool) -> Self {
        let out = tool.tip_axis.normalize();
        let to_handle = -tool.tip;
        let across = to_handle - out * out.dot(&to_handle);
        // A straight tool has no side: any will do.
        let across = if across.norm() > 1e-6 {
            across.normalize()
        } else {
            // Not along the axis itself, whichever that is.
            let least = Vec3::ith(out.iamin(), 1.0);
            out.cross(&least).normalize()
        };
        Self {
            tip: tool.tip,
            basis: Mat3::from_columns(&[out, across, out.cross(&across)]),
        }
    }

    /// Device pose that puts the tip at `tip`, pointing along `pointing`, the handle leaning
    /// towards `side`.
    fn at(&self, tip: &Vec3, pointing: &Vec3, side: &Vec3) -> Pose {
        let across = (side - pointing * pointing.dot(side)).normalize();
        let world = Mat3::from_columns(&[*pointing, across, pointing.cross(&across)]);
        let rotation = nalgebra_rotation(&(world * self.basis.transpose()));
        Pose::new(tip - rotation * self.tip, rotation)
    }
}

fn nalgebra_rotation(m: &Mat3) -> Quat {
    // Shepperd's method on the largest diagonal: no branch near a singularity.
    let trace = m[(0, 0)] + m[(1, 1)] + m[(2, 2)];
    let squares = [trace, m[(0, 0)], m[(1, 1)], m[(2, 2)]];
    let largest = (0..4).fold(
        0,
        |best, k| if squares[k] > squares[best] { k } else { best },
    );
    let (w, x, y, z) = match largest {
        0 => (
            1.0 + trace,
            m[(2, 1)] - m[(1, 2)],
            m[(0, 2)] - m[(2, 0)],
            m[(1, 0)] - m[(0, 1)],
        ),
        1 => (
            m[(2, 1)] - m[(1, 2)],
            1.0 + 2.0 * m[(0, 0)] - trace,
            m[(0, 1)] + m[(1, 0)],
            m[(0, 2)] + m[(2, 0)],
        ),
        2 => (
            m[(0, 2)] - m[(2, 0)],
            m[(0, 1)] + m[(1, 0)],
            1.0 + 2.0 * m[(1, 1)] - trace,
            m[(1, 2)] + m[(2, 1)],
        ),
        _ => (
            m[(1, 0)] - m[(0, 1)],
            m[(0, 2)] + m[(2, 0)],
            m[(1, 2)] + m[(2, 1)],
            1.0 + 2.0 * m[(2, 2)] - trace,
        ),
    };
    sulcus_core::math::normalised(w, x, y, z)
}

fn bearing_vector(degrees: f64) -> Vec3 {
    let angle = degrees.to_radians();
    Vec3::new(libm::cos(angle), libm::sin(angle), 0.0)
}

/// Where a ray from outside along `-out` first meets a sphere: distance from `centre` along `out`.
fn first_touch(centre: &Vec3, out: &Vec3, sphere: &Vec3, radius: f64) -> Option<f64> {
    let to = sphere - centre;
    let along = to.dot(out);
    let off = to.norm_squared() - along * along;
    let reach = radius * radius - off;
    (reach > 0.0).then(|| along + reach.sqrt())
}

/// Radius of the sphere nearest to the tip.
fn tip_radius(tool: &Tool) -> f64 {
    let nearest = tool.tree.shape_at(tool.level).min_by(|a, b| {
        let d = |node: &sulcus_core::Node| (node.centre - tool.tip).norm();
        d(a.1).total_cmp(&d(b.1))
    });
    nearest.map_or(0.0, |(_, node)| node.contact_radius)
}

#[cfg(test)]
mod tests {
    use super::*;
    use sulcus_core::math::exp_rotation;

    #[test]
    fn any_rotation_matrix_becomes_its_quaternion() {
        for k in 0..200 {
            let w = Vec3::new(
                libm::sin(f64::from(k)),
                libm::cos(2.3 * f64::from(k)),
                libm::sin(0.7 * f64::from(k)),
            ) * 3.0;
            let q = exp_rotation(&w);
            let back = nalgebra_rotation(&q.to_rotation_matrix().into_inner());
            assert!(q.angle_to(&back) < 1e-7, "{w:?}");
        }
    }

    #[test]
    fn a_straight_tool_along_any_axis_gets_a_rotation() {
        for axis in [Vec3::x(), Vec3::y(), -Vec3::z()] {
            let tool = sulcus_core::Tool {
                name: "straight".into(),
                tree: sulcus_core::SphereTree::over_leaves(&[sulcus_core::Sphere {
                    centre: axis,
                    radius: 1.0,
                }])
                .expect("valid"),
                level: 0,
                working_point: axis,
                tip: axis,
                tip_axis: axis,
                stiffness_n_per_m: 500.0,
                stiffness_nm_per_rad: 0.5,
                park: Pose::identity(),
                bands: Vec::new(),
                mesh: sulcus_core::DisplayMesh::default(),
            };
            let pose = ToolFrame::of(&tool).at(&Vec3::zeros(), &-Vec3::z(), &Vec3::x());
            assert!(
                (pose.orientation * axis + Vec3::z()).norm() < 1e-12,
                "{axis:?}: {pose:?}"
            );
            assert!(
                pose.transform(&tool.tip).norm() < 1e-12,
                "{axis:?}: {pose:?}"
            );
        }
    }

    #[test]
    fn a_ray_meets_a_ball_at_its_near_side() {
        let hit = first_touch(&Vec3::zeros(), &Vec3::x(), &Vec3::new(2.0, 0.0, 0.0), 1.0);
        assert_eq!(hit, Some(3.0));
        assert_eq!(
            first_touch(&Vec3::zeros(), &Vec3::x(), &Vec3::new(2.0, 1.5, 0.0), 1.0),
            None
        );
    }
}
