//! Motion of a tool for the measurement of a tick's cost: a probe in a pocket, any other tool on the nearest surface.
//!
//! The costly ticks of a lesson are those of a probe between tooth and gingiva. A measurement without them would admit
//! several times too many stations. Measured in November 2026 against sessions of 15 s, CPU time of a tick in
//! microseconds, in a debug build whose core is optimised:
//!
//! | scene | p50, p99, p99.9 here | in sessions |
//! |---|---|---|
//! | `pocket`, *probing* | 54, 142, 233 | 46, 139, 224 |
//! | `mouth`, *bimanual* | 32, 75, 161 | 52, 241, 324 |
//!
//! The cost depends on the tooth: at a first molar of the whole mouth, the same motion costs 84, 580 and 697. Running
//! sessions therefore correct the estimate.

use sulcus_core::tissue::TissueModel;
use sulcus_core::tissue::gingiva::Gingiva;
use sulcus_core::{Pose, Quat, Scene, Sphere, Tool, Vec3};

use super::cost::APPROACH;

/// Depth of the tip under a surface, metres.
const DEPTH_M: f64 = 1e-3;
/// Depth of the tip under the floor of a pocket, metres: 0.15 N by a coupling of 500 N/m.
const PRESS_M: f64 = 3e-4;
/// Radius of the circle of the tip on a surface, metres.
const CIRCLE_M: f64 = 3e-4;
/// Ticks of a circle: 4 mm/s at 1 kHz, the speed of a careful hand.
const CIRCLE_TICKS: f64 = 500.0;
/// Number of stops in a pocket.
const STOPS: usize = 8;
/// Ticks from one stop to the next: 0.4 s at 1 kHz.
const STOP_TICKS: u64 = 400;
/// Height of the tip over the floor between two stops, metres. Teachers ask for steps of 1 to 2 mm.
const STEP_M: f64 = 1e-3;
/// Angle of the stops to either side of the middle of the tooth's buccal side, radians: between the neighbours.
const REACH: f64 = 0.7;

/// Motion of one tool, tick by tick.
pub(super) enum Motion {
    /// Straight to a point under the nearest surface, then circles about it.
    Surface(Surface),
    /// Into a pocket, then from stop to stop on its floor.
    Pocket(Pocket),
}

impl Motion {
    /// Motion of a tool of the scene.
    pub fn of(scene: &Scene, tool: usize) -> Self {
        let tool = &scene.tools[tool];
        let tip = tool.park.transform(&tool.tip);
        let distance = |gingiva: &&Gingiva| (gingiva.tooth.origin - tip).norm();
        let pocket = scene
            .objects
            .iter()
            .filter_map(|object| match &object.tissue {
                TissueModel::Gingiva(gingiva) => Some(gingiva.as_ref()),
                _ => None,
            })
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))
            .filter(|_| !tool.bands.is_empty())
            .and_then(|gingiva| Pocket::of(tool, gingiva));
        match pocket {
            Some(pocket) => Self::Pocket(pocket),
            None => Self::Surface(Surface::of(scene, tool)),
        }
    }

    /// Pose in a tick, from 0.
    pub fn pose(&self, k: u64) -> Pose {
        match self {
            Self::Surface(surface) => surface.pose(k),
            Self::Pocket(pocket) => pocket.pose(k),
        }
    }
}

/// Motion on a surface.
pub(super) struct Surface {
    park: Pose,
    /// Vector from the tip at the parking place to the point.
    way: Vec3,
    /// Two axes across the way, of unit length.
    across: [Vec3; 2],
}

impl Surface {
    fn of(scene: &Scene, tool: &Tool) -> Self {
        let park = tool.park;
        let tip = park.transform(&tool.tip);
        let spheres = scene.objects.iter().flat_map(|object| {
            let shape = object.tree.shape_at(object.level);
            shape.map(|(_, node)| node.sphere())
        });
        let gap = |sphere: &Sphere| (sphere.centre - tip).norm() - sphere.radius;
        let nearest = spheres.min_by(|a, b| gap(a).total_cmp(&gap(b)));
        let towards = nearest.map_or(-Vec3::z(), |sphere| sphere.centre - tip);
        let length = towards.norm();
        let unit = if length > 0.0 {
            towards / length
        } else {
            -Vec3::z()
        };
        let depth = nearest.map_or(0.0, |sphere| gap(&sphere).max(0.0) + DEPTH_M);
        let side = if unit.x.abs() < 0.7 {
            Vec3::x()
        } else {
            Vec3::y()
        };
        let first = unit.cross(&side).normalize();
        Self {
            park,
            way: unit * depth,
            across: [first, unit.cross(&first)],
        }
    }

    fn pose(&self, k: u64) -> Pose {
        let share = (k as f64 / APPROACH as f64).min(1.0);
        let turns = k.saturating_sub(APPROACH) as f64 / CIRCLE_TICKS;
        let angle = turns * std::f64::consts::TAU;
        let [first, second] = self.across;
        let circle = first * (angle.cos() - 1.0) + second * angle.sin();
        let moved = self.way * share + circle * CIRCLE_M;
        Pose::new(self.park.position + moved, self.park.orientation)
    }
}

/// Motion in a pocket.
pub(super) struct Pocket {
    park: Pose,
    orientation: Quat,
    /// Vector from the device point to the tip in the pocket, world axes.
    tip: Vec3,
    /// Unit vector out of the pocket.
    up: Vec3,
    /// Points of the pocket's floor.
    stops: Vec<Vec3>,
    /// Height over the first stop at which the tip enters, metres.
    above: f64,
}

impl Pocket {
    /// Motion along the buccal side of a tooth; `None` if the pocket has no floor there.
    fn of(tool: &Tool, gingiva: &Gingiva) -> Option<Self> {
        let up = gingiva.tooth.axis;
        let along = tool.park.orientation * tool.tip_axis;
        let turn = Quat::rotation_between(&along, &-up)?;
        let orientation = turn * tool.park.orientation;
        let floor: Vec<(f64, Vec3)> = gingiva
            .places
            .iter()
            .filter(|place| place.floor)
            .map(|place| {
                let (around, _) = gingiva.tooth.cylindrical(&place.on_surface);
                (around, place.on_surface)
            })
            .collect();
        let stops: Option<Vec<Vec3>> = (0..STOPS)
            .map(|stop| {
                let share = stop as f64 / (STOPS - 1) as f64;
                let wanted = std::f64::consts::FRAC_PI_2 + REACH * (2.0 * share - 1.0);
                let off = |around: f64| (around - wanted).abs();
                let nearest = floor.iter().min_by(|a, b| off(a.0).total_cmp(&off(b.0)))?;
                Some(nearest.1)
            })
            .collect();
        let stops = stops?;
        let (around, height) = gingiva.tooth.cylindrical(stops.first()?);
        Some(Self {
            park: tool.park,
            orientation,
            tip: orientation * tool.tip,
            up,
            above: gingiva.margin_at(around) - height + 2.0 * STEP_M,
            stops,
        })
    }

    fn pose(&self, k: u64) -> Pose {
        let at = |point: Vec3| Pose::new(point - self.tip, self.orientation);
        let first = self.stops[0];
        let half = APPROACH / 2;
        if k < half {
            // From the parking place to a point over the first stop.
            let share = k as f64 / half as f64;
            let over = at(first + self.up * self.above);
            let position = self.park.position.lerp(&over.position, share);
            let orientation = self.park.orientation.nlerp(&self.orientation, share);
            return Pose::new(position, orientation);
        }
        if k < APPROACH {
            let share = (k - half) as f64 / (APPROACH - half) as f64;
            let height = self.above * (1.0 - share) - PRESS_M * share;
            return at(first + self.up * height);
        }
        let (stop, within) = ((k - APPROACH) / STOP_TICKS, (k - APPROACH) % STOP_TICKS);
        let here = self.stops[stop as usize % self.stops.len()];
        let next = self.stops[(stop as usize + 1) % self.stops.len()];
        // Half of the time on the floor, half for the step to the next stop.
        let rest = STOP_TICKS / 2;
        let share = within.saturating_sub(rest) as f64 / (STOP_TICKS - rest) as f64;
        let lift = (share * std::f64::consts::PI).sin() * (STEP_M + PRESS_M) - PRESS_M;
        at(here.lerp(&next, share) + self.up * lift)
    }
}
