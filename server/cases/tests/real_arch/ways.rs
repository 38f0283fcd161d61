//! Ways of the probe into the pocket of tooth 36, clear of the teeth by their meshes.

use sulcus_cases::inside::{deepest_inside, points_of};
use sulcus_cases::pocket::Way;
use sulcus_core::math::exp_rotation;
use sulcus_core::{Scene, Vec3};
use sulcus_scene::distance::MeshDistance;
use sulcus_scene::parametric::Probe;

use crate::scene::gingiva;

/// Radius of the tip, and how far the probe stays from teeth on its way, metres.
const TIP: f64 = 2.5e-4;
const SPARE: f64 = 2e-5;
/// Heights over the floor at which the whole probe is tried.
const TRIED: [f64; 5] = [0.0, 1e-3, 2.5e-3, 5e-3, 8e-3];

/// A way down to the floor (`floor` metres over the tooth's origin) at an angle, `teeth[0]` being the one that is probed: as upright
/// as the teeth allow.
pub fn way(scene: &Scene, teeth: &[&MeshDistance], degrees: f64, floor: f64) -> Way {
    let frame = gingiva(scene).tooth;
    let tool = &scene.tools[0];
    let points = points_of(&Probe::default().touching_mesh(), 3e-4);
    let (sine, cosine) = degrees.to_radians().sin_cos();
    let outward = frame.mesial * cosine + frame.buccal * sine;
    let tangent = frame.buccal * cosine - frame.mesial * sine;
    let tries = (0..=12).flat_map(|out| (-6..=6).map(move |side| (4 * out, 5 * side)));
    let mut tries: Vec<(i32, i32)> = tries.collect();
    tries.sort_by_key(|(out, side)| out * out + side * side);
    let at = |(out, side): (i32, i32)| {
        let lean = outward.cross(&-frame.axis) * f64::from(out) + outward * f64::from(side);
        let up = exp_rotation(&(lean * 1_f64.to_radians())) * frame.axis;
        // The tip's centre, from outside inwards.
        let mut along = 0.02;
        let height = frame.axis * (floor + TIP + SPARE);
        let centre = |along: f64| frame.origin + outward * along + height;
        for _ in 0..200 {
            along -= teeth[0].signed(&centre(along)) - TIP - SPARE;
        }
        let floor = centre(along) - up * TIP;
        Way {
            floor,
            up,
            outward,
            tangent,
        }
    };
    let found = tries.iter().map(|lean| at(*lean)).find(|way| {
        TRIED.iter().all(|above| {
            let pose = way.pose(tool, *above, 0.0, 0.0);
            teeth
                .iter()
                .all(|tooth| deepest_inside(tooth, &points, &pose) < 0.0)
        })
    });
    found.expect("a way that is clear of the teeth")
}

/// Between two ways.
pub fn between(a: &Way, b: &Way, share: f64) -> Way {
    let mix = |a: &Vec3, b: &Vec3| a + (b - a) * share;
    Way {
        floor: mix(&a.floor, &b.floor),
        up: mix(&a.up, &b.up).normalize(),
        outward: mix(&a.outward, &b.outward).normalize(),
        tangent: mix(&a.tangent, &b.tangent).normalize(),
    }
}
