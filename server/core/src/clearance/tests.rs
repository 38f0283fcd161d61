//! Tests of the clearance against all pairs of spheres, and of its independence from the tick.

use super::*;
use crate::math::{Quat, Vec3, exp_rotation, norm};
use crate::self_test::{input, scene};
use crate::{NoProbe, tick};

/// Returns the smallest gap of all pairs of contact spheres at the present shapes, metres.
fn smallest_gap(scene: &Scene, ws: &Workspace, pose: &Pose) -> f64 {
    let tool = &scene.tools[0];
    let mut least = f64::INFINITY;
    for (k, object) in scene.objects.iter().enumerate() {
        for (id, node) in object.tree.shape_at(object.level) {
            let mut centre = [node.centre];
            ws.centres_of(k, &[id], &mut centre);
            for (_, own) in tool.tree.shape_at(tool.level) {
                let between = norm(&(pose.transform(&own.centre) - centre[0]));
                let gap = between - own.contact_radius - node.contact_radius;
                if gap < least {
                    least = gap;
                }
            }
        }
    }
    least
}

/// Returns the scene of the self-test after `ticks` of its ticks.
fn pressed(ticks: u64) -> (Scene, State, Workspace) {
    let scene = scene();
    let (mut state, mut ws) = (State::new(&scene), Workspace::new(&scene));
    for k in 0..ticks {
        tick(&scene, &mut state, &mut ws, &input(k), &mut NoProbe);
    }
    (scene, state, ws)
}

#[test]
fn a_pose_is_free_exactly_beyond_the_distance() {
    let (scene, state, mut ws) = pressed(300);
    assert!(
        (0..scene.objects.len()).any(|k| ws.is_awake(k)),
        "a tissue is deformed"
    );
    let held = state.tools[0].haptic;
    let mut both = [0; 2];
    // Poses about the hand from a linear congruential generator (Knuth, MMIX).
    let mut seed = 1_u64;
    let mut random = |most: f64| {
        seed = seed
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        most * ((seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0)
    };
    for _ in 0..200 {
        let off = Vec3::new(random(1e-3), random(1e-3), random(1e-3));
        let turn = Vec3::new(random(0.01), random(0.01), random(0.5));
        let distance = random(5e-4) + 5.1e-4;
        let turned: Quat = exp_rotation(&turn) * held.orientation;
        let pose = Pose::new(held.position + off, turned);
        let gap = smallest_gap(&scene, &ws, &pose);
        // Rounding decides within a nanometre.
        if (gap - distance).abs() < 1e-9 {
            continue;
        }
        let free = is_free(&scene, &state, &mut ws, 0, &pose, distance);
        assert_eq!(
            free,
            gap > distance,
            "gap {gap:e} m, distance {distance:e} m"
        );
        both[usize::from(free)] += 1;
    }
    assert!(both.iter().all(|found| *found > 20), "{both:?}");
}

#[test]
fn it_changes_no_tick() {
    let scene = scene();
    let (mut one, mut other) = (State::new(&scene), State::new(&scene));
    let (mut ws, mut asked) = (Workspace::new(&scene), Workspace::new(&scene));
    let mut found = [0; 2];
    for k in 0..600 {
        let input = input(k);
        tick(&scene, &mut one, &mut ws, &input, &mut NoProbe);
        let out = tick(&scene, &mut other, &mut asked, &input, &mut NoProbe);
        // In every third tick a millimetre higher, where nothing is near.
        let mut pose = out.tools[0].haptic;
        pose.position.z += if k % 3 == 0 { 1e-3 } else { 0.0 };
        let before = other.clone();
        let free = is_free(&scene, &other, &mut asked, 0, &pose, FREE_DISTANCE);
        found[usize::from(free)] += 1;
        assert_eq!(other, before, "tick {k}");
        assert_eq!(one.hash, other.hash, "tick {k}");
    }
    assert!(found.iter().all(|ticks| *ticks > 20), "{found:?}");
}

#[test]
fn nothing_is_free_without_a_tool_or_at_a_pose_that_is_not_finite() {
    let (scene, state, mut ws) = pressed(1);
    let far = Pose::new(Vec3::new(1.0, 0.0, 0.0), Quat::identity());
    let nowhere = Pose::new(Vec3::new(f64::NAN, 0.0, 0.0), Quat::identity());
    let mut free = |tool, pose: &Pose| is_free(&scene, &state, &mut ws, tool, pose, FREE_DISTANCE);
    assert!(free(0, &far));
    assert!(!free(0, &nowhere));
    assert!(!free(1, &far));
}

#[test]
fn a_workspace_that_does_not_know_the_shape_calls_nothing_free() {
    let (scene, state, mut ws) = pressed(300);
    let far = Pose::new(Vec3::new(1.0, 0.0, 0.0), Quat::identity());
    assert!(is_free(&scene, &state, &mut ws, 0, &far, FREE_DISTANCE));
    let mut fresh = Workspace::new(&scene);
    assert!(!is_free(&scene, &state, &mut fresh, 0, &far, FREE_DISTANCE));
}
