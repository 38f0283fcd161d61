//! Hard cases of the optimisation problem: parallel, equal, opposed or impossible rows, and a hand wholly inside an
//! object.

use sulcus_core::math::exp_rotation;
use sulcus_core::{Pose, Quat, Vec3};
use sulcus_operator::HandParams;
use sulcus_operator::script::{OneTool, smoothstep};

use super::margin::{self, lowest_sphere};
use super::rigid::THIN_PLATE;
use super::{Bounds, Case, Driver};
use crate::scenes::{self, TIP_BELOW_DEVICE, TIP_RADIUS, device_over};

const OPPOSED: Case = Case {
    name: "opposed-0.02",
    about: "the probe down a slot 0.02 mm wider than it and turned in it: rows against each other on both sides",
    scene: || scenes::scene("slot", vec![scenes::slot(TIP_RADIUS + 1e-5)]),
    driver: Driver::Closed(
        |_| {
            let pose = |t: f64| {
                let deep = smoothstep((t - 0.3) / 0.7) - smoothstep((t - 3.5) / 0.4);
                let tip = Vec3::new(
                    2e-4 * libm::sin(9.0 * t) * deep,
                    1e-3 * libm::sin(3.0 * t) * deep,
                    2e-3 - 6e-3 * deep,
                );
                let turn = 0.1 * libm::sin(5.0 * t) * deep;
                let facing = exp_rotation(&Vec3::new(0.0, turn, turn));
                Pose::new(tip + facing * Vec3::new(0.0, 0.0, TIP_BELOW_DEVICE), facing)
            };
            Box::new(OneTool {
                pose,
                duration_s: 4.0,
            })
        },
        HandParams::default,
    ),
    margin: margin::none,
    bounds: Bounds {
        margin: None,
        contact_ticks: 1500,
        ..THIN_PLATE.bounds
    },
    ..THIN_PLATE
};

/// Cases of the optimisation problem.
pub(super) const CASES: &[Case] = &[
    Case {
        name: "peg-in-hole",
        about: "the probe down a round hole 0.05 mm wider than it, 4 mm deep, turned about all axes, and out again",
        scene: || scenes::scene("hole", vec![scenes::hole(TIP_RADIUS + 5e-5)]),
        ..OPPOSED
    },
    OPPOSED,
    Case {
        name: "opposed-0",
        about: "the same in a slot as wide as the probe, to a micrometre",
        scene: || scenes::scene("slot", vec![scenes::slot(TIP_RADIUS + 1e-6)]),
        ..OPPOSED
    },
    Case {
        name: "infeasible",
        about: "a probe that stands in a slot 0.1 mm too narrow from the beginning, where no answer is right: it is pressed out, without a wild number",
        scene: || {
            let mut scene = scenes::scene("slot", vec![scenes::slot(TIP_RADIUS - 5e-5)]);
            scene.tools[0].park =
                Pose::new(device_over(Vec3::new(0.0, 0.0, -2e-3)), Quat::identity());
            scene
        },
        driver: Driver::Kinematic(|_| {
            let pose = |t: f64| {
                let tip = Vec3::new(
                    3e-4 * libm::sin(5.0 * t),
                    5e-4 * libm::sin(3.0 * t),
                    -2e-3 - 5e-4 * smoothstep(t),
                );
                Pose::new(device_over(tip), Quat::identity())
            };
            Box::new(OneTool {
                pose,
                duration_s: 3.0,
            })
        }),
        margin: margin::none,
        bounds: Bounds {
            margin: None,
            // The probe is pressed out of the slot in the first ticks and then rests on the rims.
            exhausted_residual: 5.1e-5,
            contact_ticks: 1000,
            ..THIN_PLATE.bounds
        },
        ..THIN_PLATE
    },
    Case {
        name: "duplicate-rows",
        about: "a plate whose every sphere is there twice, pressed and slid over: each row has a twin",
        scene: || {
            scenes::scene(
                "plate twice",
                vec![scenes::thin_plate(), scenes::thin_plate()],
            )
        },
        driver: Driver::Kinematic(|_| pressed_and_slid()),
        bounds: Bounds {
            contact_ticks: 1500,
            ..THIN_PLATE.bounds
        },
        ..THIN_PLATE
    },
    Case {
        name: "parallel-rows",
        about: "a probe laid flat on a plate and pressed, slid along itself: sixty parallel rows",
        scene: || scenes::scene("wide plate", vec![scenes::wide_plate()]),
        driver: Driver::Kinematic(|_| {
            let pose = |t: f64| {
                // The probe lies along x.
                let facing = exp_rotation(&Vec3::new(0.0, -std::f64::consts::FRAC_PI_2, 0.0));
                let tip = Vec3::new(
                    5e-3 + 2e-3 * libm::sin(2.0 * t),
                    1e-3 * libm::sin(3.0 * t),
                    2e-3 - 3e-3 * smoothstep(t / 0.5),
                );
                Pose::new(tip + facing * Vec3::new(0.0, 0.0, TIP_BELOW_DEVICE), facing)
            };
            Box::new(OneTool {
                pose,
                duration_s: 3.0,
            })
        }),
        margin: lowest_sphere,
        bounds: Bounds {
            contact_ticks: 1500,
            ..THIN_PLATE.bounds
        },
        ..THIN_PLATE
    },
    Case {
        name: "immersed",
        about: "the hand 10 mm beyond a wide plate, the whole of its tool inside, moving about there and turning: the tool stays outside",
        scene: || scenes::scene("wide plate", vec![scenes::wide_plate()]),
        driver: Driver::Kinematic(|_| {
            let pose = |t: f64| {
                let deep = smoothstep(t / 1.0) - smoothstep((t - 4.0) / 1.0);
                let tip = Vec3::new(
                    4e-3 * libm::sin(1.5 * t) * deep,
                    4e-3 * libm::sin(2.0 * t) * deep,
                    5e-3 - 31e-3 * deep,
                );
                let facing = exp_rotation(&Vec3::new(
                    0.4 * libm::sin(2.5 * t) * deep,
                    0.4 * libm::sin(1.7 * t) * deep,
                    0.0,
                ));
                Pose::new(tip + facing * Vec3::new(0.0, 0.0, TIP_BELOW_DEVICE), facing)
            };
            Box::new(OneTool {
                pose,
                duration_s: 5.5,
            })
        }),
        margin: lowest_sphere,
        bounds: Bounds {
            // The wrench is clamped to a third of its size, force and torque separately, and is no longer that of a
            // spring.
            energy: f64::INFINITY,
            contact_ticks: 3000,
            ..THIN_PLATE.bounds
        },
        ..THIN_PLATE
    },
];

fn pressed_and_slid() -> Box<dyn sulcus_operator::Script + Send> {
    let pose = |t: f64| {
        let tip = Vec3::new(
            1.5e-3 * libm::sin(2.5 * t),
            1e-3 * libm::sin(t),
            2e-3 - 3e-3 * smoothstep(t / 0.5),
        );
        Pose::new(device_over(tip), Quat::identity())
    };
    Box::new(OneTool {
        pose,
        duration_s: 3.0,
    })
}
