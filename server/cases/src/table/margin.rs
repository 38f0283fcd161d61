//! What a case measures by itself: how far something is from having been gone through.
//!
//! The residual looks at where a tick ends. What jumped past a thing, or is wholly beyond it, overlaps nothing there: it
//! is seen by the side that it is on.

use sulcus_core::{Scene, TickOutput, Vec3, Workspace};

use crate::scenes::TIP_BELOW_DEVICE;

/// What a margin looks at.
#[derive(Clone, Copy)]
pub struct Moment<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// What came out of the tick before (in the first the same) and of this one.
    pub ticks: [&'a TickOutput; 2],
    /// The workspace as this tick left it: where what yields is.
    pub workspace: &'a Workspace,
}

impl Moment<'_> {
    /// A point of tool `t` as it is on the screen, world, metres.
    fn on(&self, t: usize, point: &Vec3) -> Vec3 {
        self.ticks[1].tools[t].graphic.transform(point)
    }

    /// Leaves of all that yields, where the tick left them: centres and the radii that nothing may enter, metres.
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

/// Nothing to go through.
pub(super) fn none(_: &Moment<'_>) -> f64 {
    f64::INFINITY
}

/// Height of the graphic tip's centre above the plate's middle: positive while it is not through.
pub(super) fn above_plate(moment: &Moment<'_>) -> f64 {
    moment.on(0, &Vec3::new(0.0, 0.0, -TIP_BELOW_DEVICE)).z
}

/// Height of the lowest of the graphic tool's spheres above the plate's middle.
pub(super) fn lowest_sphere(moment: &Moment<'_>) -> f64 {
    let tool = &moment.scene.tools[0];
    tool.tree
        .shape_at(tool.level)
        .map(|(_, node)| moment.on(0, &node.centre).z)
        .fold(f64::INFINITY, f64::min)
}

/// Height of the centre of the rod's tip over the tissue as it is deformed.
pub(super) fn tip_over_tissue(moment: &Moment<'_>) -> f64 {
    let tip = moment.on(0, &Vec3::new(0.0, 0.0, -TIP_BELOW_DEVICE));
    above(&moment.leaves(), &tip)
}

/// Height of the lower of the tools' working points over the tissue as it is deformed.
pub(super) fn tools_over_tissue(moment: &Moment<'_>) -> f64 {
    let leaves = moment.leaves();
    let tools = moment.scene.tools.iter().enumerate();
    tools
        .map(|(t, tool)| above(&leaves, &moment.on(t, &tool.working_point)))
        .fold(f64::INFINITY, f64::min)
}

/// Height of `point` over the highest of what `leaves` (centres and radii) have straight above or below it, metres:
/// negative inside of them and anywhere under them; infinite where the vertical through it meets none.
fn above(leaves: &[(Vec3, f64)], point: &Vec3) -> f64 {
    let over = leaves.iter().filter_map(|(centre, radius)| {
        let (dx, dy) = (point.x - centre.x, point.y - centre.y);
        let square = radius * radius - dx * dx - dy * dy;
        (square > 0.0).then(|| point.z - centre.z - square.sqrt())
    });
    over.fold(f64::INFINITY, f64::min)
}

/// Where the axis of the upright post of [`half_turn`] is, and half its length without its ends: [`crate::scenes::post`].
pub(super) const POST: Vec3 = Vec3::new(6e-3, 0.0, 0.0);
const POST_HALF: f64 = 5e-3;
/// Radius of the post: so much higher it is over its middle.
const POST_RADIUS: f64 = 1e-3;

/// Distance of the graphic shaft's axis from the post's; where the shaft went past the post, what of it is beyond, negative.
pub(super) fn beside_post(moment: &Moment<'_>) -> f64 {
    // The shaft's two ends: its lowest sphere and its highest.
    let ends = [0.0, 15e-3].map(|up| Vec3::new(0.0, 0.0, up - TIP_BELOW_DEVICE));
    past(
        moment
            .ticks
            .map(|output| ends.map(|end| output.tools[0].graphic.transform(&end))),
    )
}

/// The same for a shaft with its ends `[tip, head]` in two ticks.
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
        // Past its end, or over the post's, there is nothing between the two.
        let free = left < 0.0 || height.abs() > POST_HALF + POST_RADIUS;
        return if free { f64::INFINITY } else { -left };
    }
    if now.left >= 0.0 && now.height.abs() <= POST_HALF {
        now.side.abs()
    } else {
        f64::INFINITY
    }
}

/// How the post is to the shaft, both seen from above. Metres.
struct Beside {
    /// Distance of its axis from the shaft's, signed: to the left of the way from head to tip.
    side: f64,
    /// Length of the shaft beyond it, to the nearer end; negative past an end.
    left: f64,
    /// Height of the shaft there over the post's middle.
    height: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A level shaft of 15 mm from the origin, turned so far (radians), at that height.
    fn level(turned: f64, height: f64) -> [Vec3; 2] {
        let head = Vec3::new(0.0, 0.0, height);
        let way = Vec3::new(libm::cos(turned), libm::sin(turned), 0.0);
        [head + way * 15e-3, head]
    }

    #[test]
    fn a_shaft_that_jumps_over_the_post_is_seen() {
        let turn = |from: f64, to: f64| past([level(from, 0.0), level(to, 0.0)]);
        // Up to it and along it: how far away it is.
        let beside = turn(-0.4, -0.3);
        assert!((beside - 6e-3 * libm::sin(0.3)).abs() < 1e-9, "{beside}");
        // From one side to the other, in a small step and in a large one: what is beyond the post.
        for (from, to) in [(-0.01, 0.01), (-0.5, 0.5), (0.3, -0.3)] {
            let jumped = turn(from, to);
            assert!(jumped < -5e-3, "{jumped}");
        }
        // Pointing away from it, or over it, the same turn goes past nothing.
        assert_eq!(turn(3.0, 3.3), f64::INFINITY);
        let over = past([level(-0.3, 7e-3), level(0.3, 7e-3)]);
        assert_eq!(over, f64::INFINITY);
        // Pulled out first, the post beyond its tip, it may turn.
        let pulled = [-0.1, 0.1].map(|turned| level(turned, 0.0).map(|p| p - Vec3::x() * 10e-3));
        assert_eq!(past(pulled), f64::INFINITY);
        // Still 1 mm of it beyond the post it may not.
        let short = [-0.1, 0.1].map(|turned| level(turned, 0.0).map(|p| p - Vec3::x() * 8e-3));
        assert!(past(short) < 0.0, "{}", past(short));
    }

    #[test]
    fn what_is_through_is_under_the_surface() {
        let balls = [0.0, 1e-3, 2e-3].map(|x| (Vec3::new(x, 0.0, 0.0), 1e-3));
        let at = |x: f64, z: f64| above(&balls, &Vec3::new(x, 0.0, z));
        assert!((at(1e-3, 1.25e-3) - 0.25e-3).abs() < 1e-12);
        // In it, under it, well under it without touching any: ever deeper.
        assert!(at(1e-3, 0.0) < -0.9e-3);
        assert!(at(1e-3, -1.25e-3) < -2.2e-3);
        assert!(at(1e-3, -9e-3) < -9e-3);
        assert_eq!(at(4e-3, -9e-3), f64::INFINITY);
    }
}
