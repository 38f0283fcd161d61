//! Path of a probe into a pocket: along the tooth, past its bulge, down to the floor.

use sulcus_core::math::{exp_rotation, log_rotation, norm, normalised};
use sulcus_core::tissue::TissueModel;
use sulcus_core::tissue::gingiva::{Gingiva, ToothFrame};
use sulcus_core::{Object, Pose, Quat, Scene, Tool, Vec3};

/// Radius of the probe's tip with the required room, metres.
const ROOM: f64 = 2.7e-4;
/// Growth of the probe's radius by distance from the tip.
const TAPER: f64 = 0.015;
/// Length of the working end that must clear the tooth, metres.
const LENGTH: f64 = 0.014;

/// First gingiva of a scene: index of the object, the object, and its model.
pub fn gingiva_of(scene: &Scene) -> Option<(usize, &Object, &Gingiva)> {
    scene
        .objects
        .iter()
        .enumerate()
        .find_map(|(k, object)| match &object.tissue {
            TissueModel::Gingiva(model) => Some((k, object, &**model)),
            _ => None,
        })
}

/// A straight path of the tip down into a pocket.
#[derive(Clone, Copy, Debug)]
pub struct Way {
    /// Extreme point of the tip on the floor at rest, world, metres.
    pub floor: Vec3,
    /// Unit vector up along the working end.
    pub up: Vec3,
    /// Unit vector away from the tooth, perpendicular to its axis.
    pub outward: Vec3,
    /// Unit vector around the tooth, perpendicular to the other two of its frame.
    pub tangent: Vec3,
}

impl Way {
    /// Path to the floor at the angle `around`, radians from mesial over buccal. The path is at the tooth's surface and
    /// as upright as the bulge allows.
    ///
    /// `height` is the height of the floor at rest, metres along the axis. `tooth` is the index of the tooth's object.
    pub fn new(scene: &Scene, tooth: usize, frame: &ToothFrame, around: f64, height: f64) -> Self {
        let tooth = &scene.objects[tooth];
        let balls: Vec<(Vec3, f64)> = tooth
            .tree
            .shape_at(tooth.level)
            .map(|(_, node)| (node.centre, node.contact_radius))
            .collect();
        let clear = |p: &Vec3| {
            let gaps = balls.iter().map(|(c, r)| norm(&(p - c)) - r);
            gaps.fold(f64::INFINITY, f64::min)
        };
        let (cosine, sine) = (libm::cos(around), libm::sin(around));
        let outward = frame.mesial * cosine + frame.buccal * sine;
        let tangent = frame.buccal * cosine - frame.mesial * sine;
        let at = |radius: f64, height: f64| frame.origin + outward * radius + frame.axis * height;
        // Centre of the tip, one radius above the floor and `spare` metres from the tooth.
        let start = |spare: f64| {
            let (mut low, mut high) = (1e-3, 1e-2);
            for _ in 0..50 {
                let middle = 0.5 * (low + high);
                if clear(&at(middle, height + ROOM)) < ROOM + spare {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            at(high, height + ROOM)
        };
        let leaning = |degrees: u32| {
            let lean = f64::from(degrees).to_radians();
            frame.axis * libm::cos(lean) + outward * libm::sin(lean)
        };
        let passes = |centre: &Vec3, up: &Vec3| {
            (1..=56).all(|k| {
                let s = LENGTH * f64::from(k) / 56.0;
                clear(&(centre + up * s)) >= ROOM + TAPER * s
            })
        };
        // The path is as upright as the bulge allows, then as near to the tooth as possible.
        let starts = [0.0, 5e-5, 1e-4, 1.5e-4].map(start);
        let ways = (0..60).flat_map(|degrees| starts.map(|centre| (centre, leaning(degrees))));
        let mut ways = ways.filter(|(centre, up)| passes(centre, up));
        let (centre, up) = ways.next().unwrap_or((starts[0], leaning(30)));
        Self {
            floor: centre - up * ROOM,
            up,
            outward,
            tangent,
        }
    }

    /// Device pose (`world_from_tool`) of `tool` with its tip `above` metres over the floor on the path; negative:
    /// pressed into the floor.
    ///
    /// The tool is turned by `turn` radians about the tangent through a point `pivot` metres up the working end. A
    /// positive turn moves the handle outward.
    pub fn pose(&self, tool: &Tool, above: f64, turn: f64, pivot: f64) -> Pose {
        let tip = self.floor + self.up * above;
        let straight = facing(tool, &self.up, &self.outward);
        // The rotation is about the tangent, from the axis outward.
        let side = self.up.cross(&self.outward).normalize();
        let turned = exp_rotation(&(side * turn));
        let about = tip + self.up * pivot;
        let orientation = turned * straight;
        let tip = about + turned * (tip - about);
        Pose::new(tip - orientation * tool.tip, orientation)
    }
}

/// Orientation of a tool whose working end points along `-up`, with its handle towards `outward`.
fn facing(tool: &Tool, up: &Vec3, outward: &Vec3) -> Quat {
    let axes = |along: &Vec3, towards: &Vec3| {
        let side = along.cross(towards).normalize();
        let front = side.cross(along);
        let m = quaternion(&front, &side, along);
        normalised(m[0], m[1], m[2], m[3])
    };
    // The handle is along z in the tool's frame.
    let own = axes(&-tool.tip_axis, &handle(tool));
    let wanted = axes(up, outward);
    let turn = wanted * own.inverse();
    // The detour through the rotation vector gives a unit quaternion up to rounding.
    exp_rotation(&log_rotation(&turn))
}

/// Direction of the handle across the tip's axis, tool frame; any such direction for a straight tool.
fn handle(tool: &Tool) -> Vec3 {
    let across = Vec3::z() - tool.tip_axis * tool.tip_axis.dot(&Vec3::z());
    if norm(&across) > 1e-3 {
        across
    } else {
        Vec3::x()
    }
}

/// Quaternion `w, x, y, z` of the rotation whose columns are `x`, `y`, `z`.
fn quaternion(x: &Vec3, y: &Vec3, z: &Vec3) -> [f64; 4] {
    let four = [
        1.0 + x.x + y.y + z.z,
        1.0 + x.x - y.y - z.z,
        1.0 - x.x + y.y - z.z,
        1.0 - x.x - y.y + z.z,
    ];
    // The largest component keeps its digits.
    let k = (0..4).fold(0, |best, k| if four[k] > four[best] { k } else { best });
    let s = 2.0 * four[k].sqrt();
    match k {
        0 => [0.25 * s, (y.z - z.y) / s, (z.x - x.z) / s, (x.y - y.x) / s],
        1 => [(y.z - z.y) / s, 0.25 * s, (y.x + x.y) / s, (z.x + x.z) / s],
        2 => [(z.x - x.z) / s, (y.x + x.y) / s, 0.25 * s, (z.y + y.z) / s],
        _ => [(x.y - y.x) / s, (z.x + x.z) / s, (z.y + y.z) / s, 0.25 * s],
    }
}
