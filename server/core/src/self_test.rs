//! Self-test of the tick: one number that two programs compare to learn whether their ticks give the same bits.

use crate::math::{Pose, Vec3, exp_rotation};
use crate::tissue::TissueModel;
use crate::tissue::gingiva::{Gingiva, GingivaParams, Place, Prescribed, ToothFrame};
use crate::tree::{Blending, Sphere, SphereTree};
use crate::{
    DisplayMesh, NoProbe, Object, Params, Scene, State, TickInput, Tool, ToolInput, Workspace, tick,
};

/// Number of ticks of the test.
const TICKS: u64 = 1000;
/// Distance of the tip's centre below the device point of the rod, metres.
const TIP_BELOW: f64 = 0.09;

/// Runs 1,000 ticks of a small scene and returns the chained hash of all inputs and states.
///
/// A rod presses and slides on a blended rigid plate and on a gingiva. Equal numbers of two programs mean that their
/// ticks give the same bits for this scene: on another processor, operating system or compiler. The test takes some ten
/// milliseconds in a release build, and allocates.
pub fn self_test() -> u64 {
    let scene = scene();
    let (mut state, mut ws) = (State::new(&scene), Workspace::new(&scene));
    for k in 0..TICKS {
        tick(&scene, &mut state, &mut ws, &input(k), &mut NoProbe);
    }
    state.hash
}

/// Returns the hand's input of tick `k`: from above down onto the border between plate and gingiva, round about on both
/// with a tilt, and up again. One pose of a hundred is late.
pub(crate) fn input(k: u64) -> TickInput {
    let t = k as f64 * 1e-3;
    let (slow, fast) = (6.0 * t, 17.0 * t);
    let tip = Vec3::new(
        1.5e-3 * libm::sin(slow),
        1e-3 * libm::cos(fast),
        1.5e-3 * libm::cos(slow) - 1e-3,
    );
    let tilt = Vec3::new(0.3 * libm::sin(fast), 0.2 * libm::cos(slow), 0.1);
    let orientation = exp_rotation(&tilt);
    let pose = Pose::new(
        tip + orientation * Vec3::new(0.0, 0.0, TIP_BELOW),
        orientation,
    );
    let mut input = TickInput::IDLE;
    input.tools[0] = ToolInput {
        age_ticks: u16::from(k % 100 == 99),
        ..ToolInput::at(&pose)
    };
    input
}

/// Returns the scene of the test: a rod over a rigid plate with blending (x < 0) and a gingiva (x > 0).
pub(crate) fn scene() -> Scene {
    let rod: Vec<Sphere> = (0..40)
        .map(|k| Sphere {
            centre: Vec3::new(0.0, 0.0, 2.5e-4 * f64::from(k) - TIP_BELOW),
            radius: 2.5e-4,
        })
        .collect();
    let tool = Tool {
        name: "rod".into(),
        tree: tree(&rod),
        level: crate::tree::MAX_LEVEL,
        working_point: Vec3::new(0.0, 0.0, 4e-3 - TIP_BELOW),
        tip: Vec3::new(0.0, 0.0, -2.5e-4 - TIP_BELOW),
        tip_axis: -Vec3::z(),
        stiffness_n_per_m: 500.0,
        stiffness_nm_per_rad: 0.5,
        park: Pose::new(
            Vec3::new(0.0, 0.0, TIP_BELOW + 0.01),
            crate::Quat::identity(),
        ),
        bands: Vec::new(),
        mesh: DisplayMesh::default(),
    };
    Scene {
        name: "self-test".into(),
        source_hash: String::new(),
        params: Params::default(),
        tools: vec![tool],
        objects: vec![blended(plate(-1.0)), gingiva(plate(1.0))],
    }
}

fn tree(spheres: &[Sphere]) -> SphereTree {
    SphereTree::over_leaves(spheres).unwrap_or_else(|_| unreachable!("spheres of constant size"))
}

/// Returns a bumpy plate of 3 by 6 mm at z = 0, on the side of x with the sign `side`.
fn plate(side: f64) -> Object {
    let spheres: Vec<Sphere> = (0..200)
        .map(|k| Sphere {
            centre: Vec3::new(
                side * (0.5 + f64::from(k % 10)) * 3e-4,
                f64::from(k / 10 - 10) * 3e-4,
                -4e-4,
            ),
            radius: 4e-4,
        })
        .collect();
    Object {
        name: "plate".into(),
        fdi: 0,
        tree: tree(&spheres),
        level: crate::tree::MAX_LEVEL,
        tissue: TissueModel::Rigid,
        mesh: DisplayMesh::default(),
        carriers: Vec::new(),
    }
}

/// Blends the spheres of a plate to one surface.
fn blended(mut plate: Object) -> Object {
    let blending = Blending {
        lengths: vec![3e-5; usize::from(plate.tree.depth()) + 1],
        insets: vec![6e-5; plate.tree.nodes().len()],
    };
    let sharp = plate.tree.clone();
    plate.tree = plate.tree.with_blending(blending).unwrap_or(sharp);
    plate
}

/// Makes a plate the gingiva of a tooth that stands along z beside it.
fn gingiva(mut plate: Object) -> Object {
    let place = |node: &crate::Node| Place {
        away: Vec3::x(),
        on_surface: node.centre,
        spread: 2e-4,
        height: node.centre.x,
        floor: node.centre.x < 1e-3,
    };
    plate.tissue = TissueModel::Gingiva(Box::new(Gingiva {
        params: GingivaParams::default(),
        tooth: ToothFrame {
            origin: Vec3::zeros(),
            axis: Vec3::z(),
            mesial: Vec3::x(),
            buccal: Vec3::y(),
        },
        margin: vec![1e-3; 16],
        proximal: std::f64::consts::FRAC_PI_4,
        sites: [Prescribed::default(); 6],
        places: plate.tree.nodes().iter().map(place).collect(),
        level: plate.level,
    }));
    plate
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::norm;

    /// Hash of a release build. Debug builds and other machines must find the same.
    const PINNED: u64 = 0xa733_ce3e_d502_9797;

    #[test]
    fn this_build_has_the_pinned_bits() {
        assert_eq!(self_test(), PINNED, "{:#018x}", self_test());
    }

    #[test]
    fn the_rod_presses_on_both_plates() {
        let scene = scene();
        scene.validate().expect("valid");
        assert!(scene.blend_of(0) > 0.0 && scene.yields());
        let (mut state, mut ws) = (State::new(&scene), Workspace::new(&scene));
        let mut touched = [0; 2];
        for k in 0..TICKS {
            tick(&scene, &mut state, &mut ws, &input(k), &mut NoProbe);
            for (touched, load) in touched.iter_mut().zip(&state.loads) {
                *touched += u32::from(norm(&load.force) > 0.05);
            }
        }
        assert!(touched.iter().all(|ticks| *ticks > 100), "{touched:?}");
    }
}
