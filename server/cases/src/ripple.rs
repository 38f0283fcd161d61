//! *Ripple*: what a hand feels of the spheres when a tool slides over a smooth shape whose answer is
//! known.
//!
//! The haptic tool is led along a path at a constant depth below an analytic surface, its axis along
//! the surface's normal. The ideal rigid contact then has the tool's tip on the surface, straight
//! above where the hand holds it, so that the force is `k_t` times the depth along the normal:
//! size and direction are exact, whatever the tip's radius, as long as the surface's radius of curvature
//! exceeds the depth. The real tick runs on the real tree; the orientation is forced by a
//! rotational stiffness so high that the tip's give is under 1e-5 of that of the coupling.

use sulcus_core::math::norm;
use sulcus_core::{
    MAX_TOOLS, Pose, Quat, Scene, StageProbe, State, TickInput, Tool, Vec3, Workspace, tick,
};
use sulcus_operator::present;

use crate::statistics::percentile;

/// Speed along x, m/s.
pub const SPEED: f64 = 8e-3;
/// Stiffness in rotation that forces the orientation, N m/rad: the most that a scene may have.
pub const FORCED_NM_PER_RAD: f64 = 1e3;
/// Ticks of approach and rest before the measure begins.
const SETTLE: u32 = 400;

/// A smooth shape about the origin, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// With these semi-axes; slid over at y = 3 mm.
    Ellipsoid(Vec3),
    /// A box with these half edges; slid over its upper face at y = 3 mm.
    Slab(Vec3),
    /// About the x axis; slid over at 20 degrees from the vertical.
    Cylinder {
        /// Radius, metres.
        radius: f64,
        /// Half its length, metres.
        half_length: f64,
    },
}

impl Shape {
    /// The ellipsoid of the design's section 9.
    pub const ELLIPSOID: Shape = Shape::Ellipsoid(Vec3::new(0.04, 0.025, 0.015));

    /// Point of the surface above `x`, and the outward unit normal there.
    pub fn at(&self, x: f64) -> (Vec3, Vec3) {
        let y = 3e-3;
        match *self {
            Shape::Ellipsoid(s) => {
                let z = s.z * (1.0 - (x / s.x) * (x / s.x) - (y / s.y) * (y / s.y)).sqrt();
                let slope = Vec3::new(x / (s.x * s.x), y / (s.y * s.y), z / (s.z * s.z));
                (Vec3::new(x, y, z), slope.normalize())
            }
            Shape::Slab(half) => (Vec3::new(x, y, half.z), Vec3::z()),
            Shape::Cylinder { radius, .. } => {
                let angle = 20.0_f64.to_radians();
                let normal = Vec3::new(0.0, libm::sin(angle), libm::cos(angle));
                (normal * radius + Vec3::x() * x, normal)
            }
        }
    }

    /// How far to each side of x = 0 the path leads, metres.
    pub fn reach(&self) -> f64 {
        12e-3
    }
}

/// What a slide amounts to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ripple {
    /// Root mean square of `|F|/|F_analytic| - 1`, without detrending, per cent.
    pub rms_percent: f64,
    /// Largest minus smallest `|F|/|F_analytic|`, per cent.
    pub peak_to_peak_percent: f64,
    /// Mean of `|F|/|F_analytic| - 1`, per cent.
    pub bias_percent: f64,
    /// Median angle between force and analytic force, degrees.
    pub direction_p50_deg: f64,
    /// Its 95th percentile.
    pub direction_p95_deg: f64,
    /// Mean length of the second difference of force per tick, newtons.
    pub buzz: f64,
    /// Mean number of rows in the last problem of a tick.
    pub rows: f64,
    /// Mean number of passes in a tick.
    pub substeps: f64,
    /// Ticks that did not converge.
    pub unconverged: u32,
    /// Ticks measured.
    pub ticks: u32,
}

/// `tool` with its orientation forced, for [`slide`].
pub fn forced(mut tool: Tool) -> Tool {
    tool.stiffness_nm_per_rad = FORCED_NM_PER_RAD;
    tool
}

/// Pose that puts the tool's tip at `tip` with its axis against `normal`.
fn pose(tool: &Tool, tip: Vec3, normal: Vec3) -> Pose {
    let turn = Quat::rotation_between(&-tool.tip_axis, &normal).unwrap_or_else(Quat::identity);
    Pose::new(tip - turn * tool.tip, turn)
}

/// Slides the scene's first tool over its only object, which stands for `shape`, `depth` metres deep.
pub fn slide<P: StageProbe>(scene: &Scene, shape: &Shape, depth: f64, probe: &mut P) -> Ripple {
    let tool = &scene.tools[0];
    let (mut state, mut ws) = (State::new(scene), Workspace::new(scene));
    let reach = shape.reach();
    let ticks = (2.0 * reach / (SPEED * scene.tick_s())).round() as u32;
    let mut ripple = Ripple {
        ticks,
        ..Ripple::default()
    };
    let mut ratios = Vec::with_capacity(ticks as usize);
    let mut angles = Vec::with_capacity(ticks as usize);
    let mut forces: Vec<Vec3> = Vec::with_capacity(ticks as usize);
    for k in 0..SETTLE + ticks {
        let x = -reach + SPEED * scene.tick_s() * f64::from(k.saturating_sub(SETTLE));
        // From 10 mm above down to the depth in the first half of the settling time.
        let above = 1.0 - (f64::from(k) / f64::from(SETTLE / 2)).min(1.0);
        let (point, normal) = shape.at(x);
        let mut input = TickInput::IDLE;
        input.tools = [sulcus_core::ToolInput::ABSENT; MAX_TOOLS];
        input.tools[0] = present(&pose(
            tool,
            point + normal * (10e-3 * above - depth),
            normal,
        ));
        let out = tick(scene, &mut state, &mut ws, &input, probe);
        if k < SETTLE {
            continue;
        }
        let force = out.tools[0].raw_wrench.force;
        let ideal = normal * (tool.stiffness_n_per_m * depth);
        ratios.push(norm(&force) / norm(&ideal) - 1.0);
        angles.push(force.angle(&ideal).to_degrees());
        forces.push(force);
        ripple.rows += f64::from(out.tools[0].rows) / f64::from(ticks);
        ripple.substeps += f64::from(out.tools[0].substeps) / f64::from(ticks);
        ripple.unconverged += u32::from(!out.tools[0].converged);
    }
    let n = ratios.len() as f64;
    ripple.rms_percent = 100.0 * (ratios.iter().map(|r| r * r).sum::<f64>() / n).sqrt();
    ripple.bias_percent = 100.0 * ratios.iter().sum::<f64>() / n;
    let least = ratios.iter().copied().fold(f64::INFINITY, f64::min);
    let most = ratios.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    ripple.peak_to_peak_percent = 100.0 * (most - least);
    angles.sort_by(f64::total_cmp);
    ripple.direction_p50_deg = percentile(&angles, 0.5).unwrap_or(0.0);
    ripple.direction_p95_deg = percentile(&angles, 0.95).unwrap_or(0.0);
    let second = forces.windows(3).map(|f| norm(&(f[2] - f[1] * 2.0 + f[0])));
    ripple.buzz = second.sum::<f64>() / (n - 2.0);
    ripple
}
