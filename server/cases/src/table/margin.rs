//! Margins: measures of single cases for the distance to an object that must not be passed through.
//!
//! The residual is measured at the end of a tick. A tool that jumped past an object, or is wholly beyond it, has no
//! overlap there. Its margin is negative, because the tool is on the wrong side.

use sulcus_core::{Scene, TickOutput, Vec3, Workspace};

use crate::scenes::TIP_BELOW_DEVICE;

/// Tick, for a margin.
#[derive(Clone, Copy)]
pub struct Moment<'a> {
    /// Scene of the case.
    pub scene: &'a Scene,
    /// Outputs of the last tick and of this one; both are equal in the first tick.
    pub ticks: [&'a TickOutput; 2],
    /// Workspace after this tick, with the shapes of deformable objects.
    pub workspace: &'a Workspace,
}

impl Moment<'_> {
    /// Position of a point of tool `t` by its graphic pose, world, metres.
    fn on(&self, t: usize, point: &Vec3) -> Vec3 {
        self.ticks[1].tools[t].graphic.transform(point)
    }

    /// Leaves of all deformable objects after the tick: centres, world, and contact radii, metres.
    fn leaves(&self) -> Vec<(Vec3, f64)> {
        let mut leaves = Vec::new();
        for (k, object) in self.scene.objects.iter().enumerate() {
            if object.tissue.is_rigid() {
                continue;
            }
            let (ids, radii): (Vec<u32>, Vec<f64>) = object
                .tree
                .shape_at(object.level)
                .map(|(id, node)| (id, node.contact_radius))
                .unzip();
            let mut centres = vec![Vec3::zeros(); ids.len()];
            self.workspace.centres_of(k, &ids, &mut centres);
            leaves.extend(centres.into_iter().zip(radii));
        }
        leaves
    }
}

/// Margin of a case without an object to pass through: infinite.
pub(super) fn none(_: &Moment<'_>) -> f64 {
    f64::INFINITY
}

/// Height of the graphic tip's centre above the plate's middle, metres.
pub(super) fn above_plate(moment: &Moment<'_>) -> f64 {
    moment.on(0, &Vec3::new(0.0, 0.0, -TIP_BELOW_DEVICE)).z
}

/// Height of the centre of the graphic tool's lowest sphere above the plate's middle, metres.
pub(super) fn lowest_sphere(moment: &Moment<'_>) -> f64 {
    let tool = &moment.scene.tools[0];
    tool.tree
        .shape_at(tool.level)
        .map(|(_, node)| moment.on(0, &node.centre).z)
        .fold(f64::INFINITY, f64::min)
}

/// Height of the rod's tip centre over the deformed tissue, metres.
pub(super) fn tip_over_tissue(moment: &Moment<'_>) -> f64 {
    let tip = moment.on(0, &Vec3::new(0.0, 0.0, -TIP_BELOW_DEVICE));
    above(&moment.leaves(), &tip)
}

/// Smallest height of the tools' working points over the deformed tissue, metres.
pub(super) fn tools_over_tissue(moment: &Moment<'_>) -> f64 {
    let leaves = moment.leaves();
    let tools = moment.scene.tools.iter().enumerate();
    tools
        .map(|(t, tool)| above(&leaves, &moment.on(t, &tool.working_point)))
        .fold(f64::INFINITY, f64::min)
}

/// Height of `point` over the highest point of `leaves` on its vertical, metres: negative inside of them and under
/// them, infinite for a vertical that meets none.
fn above(leaves: &[(Vec3, f64)], point: &Vec3) -> f64 {
    let over = leaves.iter().filter_map(|(centre, radius)| {
        let (dx, dy) = (point.x - centre.x, point.y - centre.y);
        let square = radius * radius - dx * dx - dy * dy;
        (square > 0.0).then(|| point.z - centre.z - square.sqrt())
    });
    over.fold(f64::INFINITY, f64::min)
}

/// Centre of the upright post of the case `half-turn`, world, metres: [`crate::scenes::post`].
pub(super) const POST: Vec3 = Vec3::new(6e-3, 0.0, 0.0);
/// Half the length of the post's axis, metres.
const POST_HALF: f64 = 5e-3;
/// Radius of the post, metres, which adds to its height at both ends.
const POST_RADIUS: f64 = 1e-3;

/// Distance of the graphic shaft's axis from the axis of the post, metres. After a passage through the post, the length
/// of the shaft beyond the post, negative.
pub(super) fn beside_post(moment: &Moment<'_>) -> f64 {
    // Ends of the shaft: its lowest and its highest sphere.
    let ends = [0.0, 15e-3].map(|up| Vec3::new(0.0, 0.0, up - TIP_BELOW_DEVICE));
    past(
        moment
            .ticks
            .map(|output| ends.map(|end| output.tools[0].graphic.transform(&end))),
    )
}

/// Margin of [`beside_post`] for a shaft with the ends `[tip, head]` in two ticks; infinite for a shaft that is not
/// beside the post.
fn past(shaft: [[Vec3; 2]; 2]) -> f64 {
    let [before, now] = shaft.map(|[tip, head]| {
        let along = Vec3::new(tip.x - head.x, tip.y - head.y, 0.0);
        let length = along.norm().max(f64::MIN_POSITIVE);
        let (unit, to) = (along / length, POST - head);
        let at = (unit.x * to.x + unit.y * to.y) / length;
        Beside {
            side: unit.x * to.y - unit.y * to.x,
            left: at.min(1.0 - at) * length,
            height: head.z + at * (tip.z - head.z),
        }
    });
    let crossed = before.side * now.side < 0.0;
    let share = before.side / (before.side - now.side);
    let between = |of: fn(&Beside) -> f64| of(&before) + share * (of(&now) - of(&before));
    if crossed {
        let (left, height) = (between(|b| b.left), between(|b| b.height));
        // Past the end of the shaft, or over the end of the post, the passage is free.
        let free = left < 0.0 || height.abs() > POST_HALF + POST_RADIUS;
        return if free { f64::INFINITY } else { -left };
    }
    if now.left >= 0.0 && now.height.abs() <= POST_HALF {
        now.side.abs()
    } else {
        f64::INFINITY
    }
}

/// Position of the post relative to the shaft, from above, metres.
struct Beside {
    /// Distance of the post's axis from that of the shaft; positive on the left, seen from head to tip.
    side: f64,
    /// Length of the shaft from the post to its nearer end; negative past an end.
    left: f64,
    /// Height of the shaft over the post's middle at the post.
    height: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ends of a level shaft of 15 mm from the vertical axis, at an angle in radians and a height in metres.
    fn level(turned: f64, height: f64) -> [Vec3; 2] {
        let head = Vec3::new(0.0, 0.0, height);
        let way = Vec3::new(libm::cos(turned), libm::sin(turned), 0.0);
        [head + way * 15e-3, head]
    }

    #[test]
    fn a_shaft_that_jumps_over_the_post_is_seen() {
        let turn = |from: f64, to: f64| past([level(from, 0.0), level(to, 0.0)]);
        // Towards the post: the distance.
        let beside = turn(-0.4, -0.3);
        assert!((beside - 6e-3 * libm::sin(0.3)).abs() < 1e-9, "{beside}");
        // From one side to the other, in a small and in a large step: the length beyond the post.
        for (from, to) in [(-0.01, 0.01), (-0.5, 0.5), (0.3, -0.3)] {
            let jumped = turn(from, to);
            assert!(jumped < -5e-3, "{jumped}");
        }
        // A turn that points away from the post, or above it, passes nothing.
        assert_eq!(turn(3.0, 3.3), f64::INFINITY);
        let over = past([level(-0.3, 7e-3), level(0.3, 7e-3)]);
        assert_eq!(over, f64::INFINITY);
        // A shaft that was pulled out, with the post beyond its tip, may turn.
        let pulled = [-0.1, 0.1].map(|turned| level(turned, 0.0).map(|p| p - Vec3::x() * 10e-3));
        assert_eq!(past(pulled), f64::INFINITY);
        // A shaft with 1 mm beyond the post may not turn.
        let short = [-0.1, 0.1].map(|turned| level(turned, 0.0).map(|p| p - Vec3::x() * 8e-3));
        assert!(past(short) < 0.0, "{}", past(short));
    }

    #[test]
    fn what_is_through_is_under_the_surface() {
        let balls = [0.0, 1e-3, 2e-3].map(|x| (Vec3::new(x, 0.0, 0.0), 1e-3));
        let at = |x: f64, z: f64| above(&balls, &Vec3::new(x, 0.0, z));
        assert!((at(1e-3, 1.25e-3) - 0.25e-3).abs() < 1e-12);
        // Inside the balls, under them, and far under them: the depth grows.
        assert!(at(1e-3, 0.0) < -0.9e-3);
        assert!(at(1e-3, -1.25e-3) < -2.2e-3);
        assert!(at(1e-3, -9e-3) < -9e-3);
        assert_eq!(at(4e-3, -9e-3), f64::INFINITY);
    }
}
