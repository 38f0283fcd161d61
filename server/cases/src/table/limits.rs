//! Hard cases of limits: the stability limit of the explicit scheme, an hour at rest, random poses.

use sulcus_core::tissue::TissueModel;
use sulcus_core::tissue::printed::PrintedSkeleton;
use sulcus_core::{Pose, Quat, Scene, Vec3};
use sulcus_operator::script::{OneTool, smoothstep};

use super::rigid::THIN_PLATE;
use super::tissue::{TONGUE, TONGUE_STIFF};
use super::{Bounds, Case, Driver};
use crate::fuzz;
use crate::scenes::device_over;
use crate::tissue_scenes::tongue;

/// The tongue with springs of `share` times the largest stiffness at which the printed method is stable at the tick's
/// step, by Eq. 9 for all modes.
fn explicit(share: f64) -> Scene {
    let mut scene = tongue(0.5);
    let tick_s = scene.tick_s();
    for object in &mut scene.objects {
        let TissueModel::Skeleton(skeleton) = &mut object.tissue else {
            continue;
        };
        let printed = PrintedSkeleton::of(&skeleton.coarse, &object.tree);
        let spectrum = printed
            .spectrum(&object.tree)
            .expect("the shipped tongue's springs");
        let (damping, mass) = (printed.damping_n_s_per_m, printed.mass_kg);
        // Largest factor of all springs. The penalty's part of the stiffest mode is constant.
        let penalty = printed.penalty_n_per_m;
        let unit = sulcus_core::tissue::printed::stability::Spectrum {
            most: spectrum.most - penalty,
            ..spectrum
        };
        let (mut stable, mut not) = (1e-6, 1e6);
        while not > stable * (1.0 + 1e-9) {
            let middle: f64 = f64::sqrt(stable * not);
            let step = unit
                .scaled(middle, penalty)
                .largest_time_step(damping, mass);
            // Slow modes limit the step only at a much larger damping.
            if step >= tick_s {
                stable = middle;
            } else {
                not = middle;
            }
        }
        let by = share * stable;
        let levels = [Some(&mut skeleton.coarse), skeleton.fine.as_mut()];
        for level in levels.into_iter().flatten() {
            for spring in &mut level.springs {
                spring.stiffness = spring.stiffness.map(|k| k * by);
            }
        }
    }
    scene
}

const EXPLICIT: Case = Case {
    name: "explicit-0.9",
    about: "a tongue 0.9 times as stiff as the explicit scheme of the paper bears: nothing of that limit is felt",
    scene: || explicit(0.9),
    ..TONGUE_STIFF
};

/// Cases of limits.
pub(super) const CASES: &[Case] = &[
    EXPLICIT,
    Case {
        name: "explicit-0.99",
        about: "the same at 0.99 times that limit",
        scene: || explicit(0.99),
        ..EXPLICIT
    },
    Case {
        name: "explicit-1.01",
        about: "the same at 1.01 times that limit, where the paper's scheme is unstable and refused",
        scene: || explicit(1.01),
        ..EXPLICIT
    },
    // A short form: the tests of `passivity` run the hour, or prove its rest by a repetition.
    Case {
        name: "hour-rest",
        about: "the first minute of an hour at rest on a plate: nothing drifts",
        driver: Driver::Kinematic(|_| {
            let pose = |t: f64| {
                let tip = Vec3::new(1e-4, 0.5e-4, 2e-3 - 3e-3 * smoothstep(t));
                Pose::new(device_over(tip), Quat::identity())
            };
            Box::new(OneTool {
                pose,
                duration_s: 60.0,
            })
        }),
        bounds: Bounds {
            contact_ticks: 50_000,
            ..THIN_PLATE.bounds
        },
        ..THIN_PLATE
    },
    // A short form: the tests of `random_poses` run all scenes with invalid numbers, up to a million ticks.
    Case {
        name: "random-poses",
        about: "ten seconds of a random walk with leaps, turns and absences in the narrow pocket: safe, and finite",
        scene: || (fuzz::POCKET.scene)(),
        driver: Driver::Kinematic(|scene| fuzz::POCKET.script(scene, 4, 10_000)),
        bounds: Bounds {
            // Leaps of 9 mm and 0.7 rad in a tick, at over 1 m/s: only the bounds of safety apply, as for random poses.
            exhausted_residual: fuzz::POCKET.outrun.deepest,
            exhausted_share: fuzz::POCKET.outrun.share,
            energy: f64::INFINITY,
            // No controller can foresee the work of a leap in one period, 1.06 mJ over a link of 2 ms.
            linked_energy: 5e-3,
            jump: 5e-3,
            force_step: 10.0,
            torque_step: f64::INFINITY,
            buzz: 0.2,
            unrest: f64::INFINITY,
            contact_ticks: 2000,
            ..TONGUE.bounds
        },
        ..TONGUE
    },
];
