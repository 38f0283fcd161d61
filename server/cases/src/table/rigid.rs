//! Hard cases of rigid objects.

use sulcus_core::math::exp_rotation;
use sulcus_core::{Pose, Quat, Scene, Vec3};
use sulcus_operator::script::{OneTool, smoothstep};
use sulcus_operator::{HandParams, Script};

use super::margin::{self, above_plate, lowest_sphere};
use super::{Bounds, Case, Driver, LINKED_ENERGY, SLOW_FORCE_STEP, undisturbed};
use crate::scenes::{self, TIP_BELOW_DEVICE, device_over};

/// Script of a stab: straight down at `speed` m/s from 10 mm above the plate to 10 mm below, then a rest.
pub(super) fn stab(speed: f64) -> Box<dyn Script + Send> {
    let enter = 0.1;
    let pose = move |t: f64| {
        let z = 0.01 - (speed * (t - enter)).clamp(0.0, 0.02);
        Pose::new(device_over(Vec3::new(1e-4, 0.5e-4, z)), Quat::identity())
    };
    Box::new(OneTool {
        pose,
        duration_s: enter + 0.02 / speed + 0.2,
    })
}

/// Device pose at `t` seconds of a hand that jumps to another target every 25 ms.
///
/// The targets are within 5 mm of the axis and from 8 mm below the plate to 20 mm above. The turns are about the tip,
/// so that the speed clamp at the device point does not act.
fn tumble(t: f64) -> Pose {
    let (k, share) = ((t / 0.025).floor(), t / 0.025 - (t / 0.025).floor());
    let target = |k: f64| {
        // A hash of the target's number is random without a state.
        let unit = |salt: f64| {
            let x = libm::sin(k * 12.9898 + salt * 78.233) * 43758.5453;
            x - x.floor()
        };
        let side = |salt: f64| 2.0 * unit(salt) - 1.0;
        let turn = Vec3::new(side(1.0), side(2.0), side(3.0)) * 1.2;
        (
            turn,
            Vec3::new(
                5e-3 * side(4.0),
                5e-3 * side(5.0),
                -8e-3 + 28e-3 * unit(6.0),
            ),
        )
    };
    let ((turn, tip), (next_turn, next_tip)) = (target(k), target(k + 1.0));
    let facing = exp_rotation(&(turn + (next_turn - turn) * share));
    let tip = tip + (next_tip - tip) * share;
    Pose::new(tip + facing * Vec3::new(0.0, 0.0, TIP_BELOW_DEVICE), facing)
}

/// Script of a tip 1 mm below the bottom of a groove, from wall to wall and along the groove.
fn along_groove(_: &Scene) -> Box<dyn Script + Send> {
    let pose = |t: f64| {
        let deep = smoothstep(t / 0.5);
        let tip = Vec3::new(
            1.5e-3 * libm::sin(2.5 * t),
            1e-3 * libm::sin(t),
            3e-3 - 4e-3 * deep,
        );
        Pose::new(device_over(tip), Quat::identity())
    };
    Box::new(OneTool {
        pose,
        duration_s: 5.0,
    })
}

pub(super) const THIN_PLATE: Case = Case {
    name: "thin-plate-0.5",
    about: "a plate of 0.5 mm, stabbed at 0.5 m/s: never through",
    scene: || scenes::scene("thin plate", vec![scenes::thin_plate()]),
    driver: Driver::Kinematic(|_| stab(0.5)),
    disturb: undisturbed,
    margin: above_plate,
    seed: 1,
    bounds: Bounds {
        residual: 1e-6,
        exhausted_residual: 2e-5,
        energy: 1e-3,
        linked_energy: LINKED_ENERGY,
        exhausted_share: 0.001,
        jump: 5e-4,
        force_step: 0.05,
        slow_force_step: SLOW_FORCE_STEP,
        // The bound is the slew limit, with rounding.
        sent_step: 0.5 + 1e-9,
        torque_step: f64::INFINITY,
        buzz: 0.05,
        imbalance: 1e-6,
        flips: 0,
        rebound: 0.0,
        unrest: 0.0,
        drift: 1e-6,
        coupling_error: 0.01,
        margin: Some(2e-4),
        contact_ticks: 150,
    },
};

/// Cases of rigid objects.
pub(super) const CASES: &[Case] = &[
    Case {
        name: "thin-plate-0.02",
        about: "a plate of 0.5 mm, pressed at 0.02 m/s: never through",
        driver: Driver::Kinematic(|_| stab(0.02)),
        ..THIN_PLATE
    },
    Case {
        name: "thin-plate-0.1",
        about: "a plate of 0.5 mm, stabbed at 0.1 m/s: never through",
        driver: Driver::Kinematic(|_| stab(0.1)),
        ..THIN_PLATE
    },
    THIN_PLATE,
    Case {
        name: "thin-plate-1",
        about: "a plate of 0.5 mm, stabbed at 1 m/s: never through",
        driver: Driver::Kinematic(|_| stab(1.0)),
        ..THIN_PLATE
    },
    Case {
        name: "thin-plate-2",
        about: "a plate of 0.5 mm, stabbed at 2 m/s: never through",
        driver: Driver::Kinematic(|_| stab(2.0)),
        ..THIN_PLATE
    },
    Case {
        name: "teleport",
        about: "20 mm in one tick through the plate, as after lost packets: stops at the surface",
        driver: Driver::Kinematic(|_| {
            let pose = |t: f64| {
                let z = if t < 0.2 { 0.01 } else { -0.01 };
                Pose::new(device_over(Vec3::new(1e-4, 0.5e-4, z)), Quat::identity())
            };
            Box::new(OneTool {
                pose,
                duration_s: 0.5,
            })
        }),
        // The hand arrives in one tick. The tool follows by at most 8 substeps of 0.5 mm in each tick, and the whole
        // raw force comes at its arrival.
        bounds: Bounds {
            exhausted_share: 0.006,
            jump: 3.8e-3,
            force_step: 5.5,
            ..THIN_PLATE.bounds
        },
        ..THIN_PLATE
    },
    Case {
        name: "wedge",
        about: "the tip pushed 4 mm past where a V is as narrow as it, and turned",
        scene: || scenes::scene("wedge", vec![scenes::wedge()]),
        driver: Driver::Closed(
            |_| {
                let pose = |t: f64| {
                    let deep = smoothstep((t - 0.3) / 0.7);
                    let turn = 0.15 * libm::sin(4.0 * t) * deep;
                    let tip = Vec3::new(
                        0.3e-3 * libm::sin(7.0 * t),
                        1e-3 * libm::sin(3.0 * t),
                        6e-3 - 9e-3 * deep,
                    );
                    let facing = exp_rotation(&Vec3::new(0.0, turn, 0.5 * turn));
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
            contact_ticks: 2500,
            ..THIN_PLATE.bounds
        },
        ..THIN_PLATE
    },
    Case {
        name: "sharp-edge",
        about: "the tip slides over an edge of 0.1 mm radius, 1 mm deep, to and fro",
        scene: || scenes::scene("sharp edge", vec![scenes::sharp_edge()]),
        driver: Driver::Kinematic(|_| {
            let pose = |t: f64| {
                let tip = Vec3::new(
                    4e-3 * libm::sin(2.5 * t - 1.5),
                    1e-3 * libm::sin(t),
                    -0.65e-3,
                );
                Pose::new(device_over(tip), Quat::identity())
            };
            Box::new(OneTool {
                pose,
                duration_s: 5.0,
            })
        }),
        margin: margin::none,
        bounds: Bounds {
            margin: None,
            contact_ticks: 1000,
            ..THIN_PLATE.bounds
        },
        ..THIN_PLATE
    },
    Case {
        name: "groove-steep",
        about: "the tip 1 mm below the bottom of a blended groove of 45 degrees, from wall to wall: no buzz",
        scene: || scenes::scene("groove", vec![scenes::groove(0.785)]),
        driver: Driver::Kinematic(along_groove),
        margin: margin::none,
        bounds: Bounds {
            margin: None,
            buzz: 2e-3,
            contact_ticks: 4000,
            ..THIN_PLATE.bounds
        },
        ..THIN_PLATE
    },
    Case {
        name: "groove-medium",
        about: "the same with walls of 20 degrees",
        scene: || scenes::scene("groove", vec![scenes::groove(0.35)]),
        driver: Driver::Kinematic(along_groove),
        margin: margin::none,
        bounds: Bounds {
            margin: None,
            buzz: 2e-3,
            contact_ticks: 4000,
            ..THIN_PLATE.bounds
        },
        ..THIN_PLATE
    },
    Case {
        name: "groove-shallow",
        about: "the same with walls of 10 degrees",
        scene: || scenes::scene("groove", vec![scenes::groove(0.175)]),
        driver: Driver::Kinematic(along_groove),
        margin: margin::none,
        bounds: Bounds {
            margin: None,
            buzz: 2e-3,
            contact_ticks: 4000,
            ..THIN_PLATE.bounds
        },
        ..THIN_PLATE
    },
    Case {
        name: "flat-on-flat",
        about: "a face of 144 spheres pressed on another and lifted off: hundreds of rows, and the tool follows",
        scene: scenes::flat_on_flat,
        driver: Driver::Kinematic(|_| {
            let pose = |t: f64| {
                let z = 2e-3 - 4e-3 * smoothstep(t / 0.8) + 12e-3 * smoothstep((t - 1.2) / 0.8);
                Pose::new(
                    device_over(Vec3::new(3e-4 * libm::sin(3.0 * t), 0.0, z)),
                    Quat::identity(),
                )
            };
            Box::new(OneTool {
                pose,
                duration_s: 2.5,
            })
        }),
        // Away from the face, the graphic tool must be at the hand.
        margin: |moment| {
            let output = moment.ticks[1];
            let tool = &output.tools[0];
            let at = |pose: &Pose| pose.transform(&Vec3::new(0.0, 0.0, -TIP_BELOW_DEVICE));
            let clear = at(&tool.haptic).z > 3e-3 && output.tick > 1300;
            if clear {
                1e-3 - (at(&tool.haptic) - at(&tool.graphic)).norm()
            } else {
                f64::INFINITY
            }
        },
        bounds: Bounds {
            margin: Some(5e-4),
            contact_ticks: 500,
            force_step: 0.2,
            ..THIN_PLATE.bounds
        },
        ..THIN_PLATE
    },
    Case {
        name: "tumble",
        about: "targets on both sides of a wide plate, another every 25 ms, turned by up to 1.2 rad about each axis: no sphere is ever through",
        scene: || scenes::scene("wide plate", vec![scenes::wide_plate()]),
        driver: Driver::Kinematic(|_| {
            Box::new(OneTool {
                pose: tumble,
                duration_s: 6.0,
            })
        }),
        margin: lowest_sphere,
        // The hand moves at over 1 m/s and 80 rad/s. The bounds of safety are those of all cases; the others are
        // measured.
        bounds: Bounds {
            // At 60 rad/s and 3 m/s a late wrench does a work of 2 mJ in one period.
            linked_energy: 5e-3,
            exhausted_share: 0.02,
            jump: 3.8e-3,
            force_step: 2.0,
            buzz: 0.2,
            contact_ticks: 1000,
            ..THIN_PLATE.bounds
        },
        ..THIN_PLATE
    },
    Case {
        name: "nan-poses",
        about: "NaN, infinite, denormal and zero-rotation poses while the tip rests on the plate",
        driver: Driver::Closed(
            |_| {
                let pose = |t: f64| {
                    let tip = Vec3::new(
                        1e-3 * libm::sin(2.0 * t),
                        0.0,
                        2e-3 - 3e-3 * smoothstep(t / 0.5),
                    );
                    Pose::new(device_over(tip), Quat::identity())
                };
                Box::new(OneTool {
                    pose,
                    duration_s: 3.0,
                })
            },
            HandParams::default,
        ),
        disturb: |k, input| {
            let pose = &mut input.tools[0].pose;
            match k % 97 {
                3 => pose.position[k as usize % 3] = f32::NAN,
                17 => pose.orientation[k as usize % 4] = f32::INFINITY,
                41 => pose.position[0] = f32::from_bits(1),
                59 => pose.orientation = [0.0; 4],
                83 => pose.position[2] = f32::MAX,
                _ => {}
            }
        },
        // The denormal pose is valid: the hand is there for a tick.
        bounds: Bounds {
            force_step: 0.1,
            contact_ticks: 2000,
            ..THIN_PLATE.bounds
        },
        ..THIN_PLATE
    },
];
