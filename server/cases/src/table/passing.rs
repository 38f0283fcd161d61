//! Hard cases of continuous collision: no object is passed through, at any thickness and any speed of the hand.

use sulcus_core::math::{exp_rotation, norm};
use sulcus_core::{Object, Pose, Quat, Scene, Vec3};
use sulcus_operator::Script;
use sulcus_operator::retraction::{Retraction, RetractionParams};
use sulcus_operator::script::{OneTool, TwoTools, smoothstep};

use super::margin::{POST, beside_post, lowest_sphere, tip_over_tissue, tools_over_tissue};
use super::rigid::{THIN_PLATE, stab};
use super::tissue::{TONGUE, mirror};
use super::{Bounds, Case, Driver};
use crate::mouth::mouth;
use crate::scenes::{self, TIP_BELOW_DEVICE, device_over};
use crate::tissue_scenes::{organ, tongue, twice};

/// Rate of the fast turns, rad/s. The tip, 90 mm from the device point, then moves at 1.8 m/s.
const SWING: f64 = 20.0;

const THINNER: Case = Case {
    name: "thin-plate-0.3mm-0.02",
    about: "a plate of 0.3 mm, pressed at 0.02 m/s: never through",
    scene: || scenes::scene("thinner plate", vec![scenes::plate(1.5e-4)]),
    driver: Driver::Kinematic(|_| stab(0.02)),
    ..THIN_PLATE
};

/// Height of the rod's park pose over the contact of two teeth, metres.
const OVER: f64 = 0.14;

/// Scene of two neighbouring teeth of the generated mouth, a premolar and a molar, without tissue, and a straight
/// probe.
fn two_teeth() -> Scene {
    let mut scene = mouth(1, true, 3);
    scene
        .objects
        .retain(|object| matches!(object.fdi, 35 | 36) && object.tissue.is_rigid());
    scene.tools = vec![scenes::rod()];
    let (at, _) = contact(&scene);
    scene.tools[0].park.position = at + Vec3::new(0.0, 0.0, OVER);
    scene
}

/// Point between the two teeth at their smallest distance, world, metres, and the horizontal unit vector from the
/// tongue to the cheek there.
fn contact(scene: &Scene) -> (Vec3, Vec3) {
    let leaves = |object: &Object| -> Vec<(Vec3, f64)> {
        let shape = object.tree.shape_at(object.level);
        shape
            .map(|(_, node)| (node.centre, node.contact_radius))
            .collect()
    };
    let (a, b) = (leaves(&scene.objects[0]), leaves(&scene.objects[1]));
    let pairs = a.iter().flat_map(|a| b.iter().map(move |b| (a, b)));
    let gap = |(a, b): &(&(Vec3, f64), &(Vec3, f64))| norm(&(a.0 - b.0)) - a.1 - b.1;
    let (a, b) = pairs
        .min_by(|one, other| gap(one).total_cmp(&gap(other)))
        .expect("two teeth with spheres");
    let across = b.0 - a.0;
    let to_side = Vec3::new(-across.y, across.x, 0.0).normalize();
    // The teeth are in the patient's left half, and y points to the left.
    let out = if to_side.y < 0.0 { -to_side } else { to_side };
    ((a.0 + b.0) * 0.5, out)
}

/// Script of an upright probe from the cheek through the contact of the two teeth at `speed` m/s.
fn through_contact(scene: &Scene, speed: f64) -> Box<dyn Script + Send> {
    let (at, out) = contact(scene);
    let pose = move |t: f64| {
        let off = 0.01 - (speed * (t - 0.1)).clamp(0.0, 0.02);
        Pose::new(device_over(at + out * off), Quat::identity())
    };
    Box::new(OneTool {
        pose,
        duration_s: 0.1 + 0.02 / speed + 0.2,
    })
}

const GAP: Case = Case {
    name: "teeth-gap-0.02",
    about: "pushed from the cheek between two neighbouring teeth, where they touch, at 0.02 m/s: never through",
    scene: two_teeth,
    driver: Driver::Kinematic(|scene| through_contact(scene, 0.02)),
    // The probe may slide over the ridges of the teeth, not between them. In the plane of the contact it must be above.
    margin: |moment| {
        let contact = moment.scene.tools[0].park.position - Vec3::new(0.0, 0.0, OVER);
        let tip = Vec3::new(0.0, 0.0, -TIP_BELOW_DEVICE);
        let [before, now] = moment
            .ticks
            .map(|output| output.tools[0].graphic.transform(&tip) - contact);
        if before.y * now.y < 0.0 {
            let share = before.y / (before.y - now.y);
            before.z + share * (now.z - before.z)
        } else if now.y.abs() < 3e-4 {
            now.z
        } else {
            f64::INFINITY
        }
    },
    bounds: Bounds {
        contact_ticks: 2,
        margin: Some(3e-4),
        exhausted_share: 0.01,
        flips: u64::MAX,
        ..THIN_PLATE.bounds
    },
    ..THIN_PLATE
};

/// Script of a probe straight down over the edge of the tongue, 20 mm at `speed` m/s.
fn onto_edge(speed: f64) -> Box<dyn Script + Send> {
    let params = RetractionParams {
        flank: 0.46,
        ..RetractionParams::default()
    };
    let touch = Retraction::new(&tongue(0.5), params)
        .expect("a tongue and a mirror")
        .touch();
    let pose = move |t: f64| {
        let z = 0.01 - (speed * (t - 0.1)).clamp(0.0, 0.02);
        Pose::new(
            device_over(touch + Vec3::new(0.0, 0.0, z)),
            Quat::identity(),
        )
    };
    Box::new(OneTool {
        pose,
        duration_s: 0.1 + 0.02 / speed + 0.5,
    })
}

const EDGE: Case = Case {
    name: "tongue-edge-0.1",
    about: "a probe pushed down 10 mm onto the edge of the tongue at 0.1 m/s: never inside",
    scene: || {
        let mut scene = tongue(0.5);
        let park = scene.tools[0].park;
        scene.tools = vec![scenes::rod()];
        scene.tools[0].park = park;
        scene
    },
    driver: Driver::Kinematic(|_| onto_edge(0.1)),
    margin: tip_over_tissue,
    bounds: Bounds {
        unrest: f64::INFINITY,
        // The bound is the radius of the tip.
        margin: Some(2.4e-4),
        contact_ticks: 300,
        ..TONGUE.bounds
    },
    ..TONGUE
};

const COMES_BACK: Case = Case {
    name: "tissue-comes-back",
    about: "one mirror dents the tongue by 12 mm and leaves at once, the tissue swings back into another that rests there",
    scene: || twice(tongue(0.5)),
    driver: Driver::Kinematic(|scene| {
        let both = [mirror(scene, 0.0), mirror(scene, 0.46)];
        let poses = move |t: f64| {
            let presses =
                -5e-3 + 17e-3 * smoothstep(t / 1.0) - 20e-3 * smoothstep((t - 2.0) / 0.05);
            // The second mirror comes while the first presses, and stays 3 mm inside the tissue's rest shape.
            let rests = -8e-3 + 11e-3 * smoothstep((t - 1.0) / 0.5);
            [
                Some(both[0].pose(presses, 0.0, 0.0)),
                Some(both[1].pose(rests, 0.0, 0.0)),
            ]
        };
        Box::new(TwoTools {
            poses,
            duration_s: 4.0,
        })
    }),
    margin: tools_over_tissue,
    bounds: Bounds {
        unrest: 12e-3,
        // The working points are inside the discs, with spheres between them and the tissue.
        margin: Some(1e-3),
        contact_ticks: 1500,
        ..TONGUE.bounds
    },
    ..TONGUE
};

/// Cases of continuous collision.
pub(super) const CASES: &[Case] = &[
    THINNER,
    Case {
        name: "thin-plate-0.3mm-0.1",
        about: "a plate of 0.3 mm, stabbed at 0.1 m/s: never through",
        driver: Driver::Kinematic(|_| stab(0.1)),
        ..THINNER
    },
    Case {
        name: "thin-plate-0.3mm-0.5",
        about: "a plate of 0.3 mm, stabbed at 0.5 m/s: never through",
        driver: Driver::Kinematic(|_| stab(0.5)),
        ..THINNER
    },
    Case {
        name: "thin-plate-0.3mm-1",
        about: "a plate of 0.3 mm, stabbed at 1 m/s: never through",
        driver: Driver::Kinematic(|_| stab(1.0)),
        ..THINNER
    },
    Case {
        name: "thin-plate-0.3mm-2",
        about: "a plate of 0.3 mm, stabbed at 2 m/s: never through",
        driver: Driver::Kinematic(|_| stab(2.0)),
        ..THINNER
    },
    GAP,
    Case {
        name: "teeth-gap-0.5",
        about: "the same at 0.5 m/s",
        driver: Driver::Kinematic(|scene| through_contact(scene, 0.5)),
        bounds: Bounds {
            buzz: 0.3,
            ..GAP.bounds
        },
        ..GAP
    },
    Case {
        name: "teeth-gap-2",
        about: "the same at 2 m/s",
        driver: Driver::Kinematic(|scene| through_contact(scene, 2.0)),
        bounds: Bounds {
            buzz: 1.0,
            jump: 1e-3,
            ..GAP.bounds
        },
        ..GAP
    },
    Case {
        name: "tongue-edge-0.02",
        about: "the same at 0.02 m/s",
        driver: Driver::Kinematic(|_| onto_edge(0.02)),
        ..EDGE
    },
    EDGE,
    Case {
        name: "tongue-edge-0.5",
        about: "the same at 0.5 m/s",
        driver: Driver::Kinematic(|_| onto_edge(0.5)),
        ..EDGE
    },
    Case {
        name: "tongue-edge-2",
        about: "the same at 2 m/s",
        driver: Driver::Kinematic(|_| onto_edge(2.0)),
        bounds: Bounds {
            buzz: 6e-3,
            ..EDGE.bounds
        },
        ..EDGE
    },
    Case {
        name: "long-lever",
        about: "the probe swung through a wide plate about its far end at 20 rad/s, to and fro: no sphere is ever through",
        scene: || scenes::scene("wide plate", vec![scenes::wide_plate()]),
        driver: Driver::Kinematic(|_| {
            let pose = |t: f64| {
                // The probe turns from upright over level to 0.3 rad below, with rests at both ends.
                let period = 0.5;
                let phase = t - (t / period).floor() * period;
                let swung = (SWING * (phase - 0.1)).clamp(0.0, 0.6)
                    - (SWING * (phase - 0.35)).clamp(0.0, 0.6);
                // At rest the probe points 0.3 rad above the plate's plane, its tip over the middle.
                let facing = exp_rotation(&Vec3::new(
                    swung - 0.3 - std::f64::consts::FRAC_PI_2,
                    0.0,
                    0.0,
                ));
                Pose::new(Vec3::new(0.0, TIP_BELOW_DEVICE, 5e-3), facing)
            };
            Box::new(OneTool {
                pose,
                duration_s: 4.0,
            })
        }),
        margin: lowest_sphere,
        bounds: Bounds {
            // At 20 rad/s the slew limit delays the rise and the fall of the torque, which does work on the moved hand.
            energy: f64::INFINITY,
            exhausted_share: 0.02,
            jump: 3.8e-3,
            force_step: 2.0,
            buzz: 0.2,
            contact_ticks: 500,
            ..THIN_PLATE.bounds
        },
        ..THIN_PLATE
    },
    Case {
        name: "half-turn",
        about: "the probe turned by 180 degrees in 0.2 s against a post that is in its way, held there, and back: it never jumps past",
        scene: || {
            let post = scenes::post(POST);
            scenes::scene("post", vec![post])
        },
        driver: Driver::Kinematic(|_| {
            let pose = |t: f64| {
                let turned = smoothstep((t - 0.3) / 0.2) - smoothstep((t - 1.5) / 0.2);
                // The probe lies along x with its tip outward, and turns about the vertical through its upper end.
                let lying = exp_rotation(&Vec3::new(0.0, -std::f64::consts::FRAC_PI_2, 0.0));
                let about =
                    exp_rotation(&Vec3::new(0.0, 0.0, -1.2 + std::f64::consts::PI * turned));
                let facing = about * lying;
                // The upper end of the spheres is at the origin.
                Pose::new(
                    facing * Vec3::new(0.0, 0.0, TIP_BELOW_DEVICE - 15e-3),
                    facing,
                )
            };
            Box::new(OneTool {
                pose,
                duration_s: 2.5,
            })
        }),
        // Held at the post, the probe is pulled along the post and past its own end, which is a free path.
        margin: beside_post,
        bounds: Bounds {
            exhausted_share: 0.01,
            energy: f64::INFINITY,
            force_step: 0.2,
            // Smallest distance between the axes of two rows of spheres of 1 and 0.25 mm radius.
            margin: Some(1.2e-3),
            contact_ticks: 500,
            ..THIN_PLATE.bounds
        },
        ..THIN_PLATE
    },
    COMES_BACK,
    Case {
        name: "organ-comes-back",
        about: "the same with a tongue of finite elements",
        scene: || twice(organ(0.5)),
        ..COMES_BACK
    },
];
