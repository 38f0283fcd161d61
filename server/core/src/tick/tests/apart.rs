//! Tests of two tools with separate problems, and of scenes with many objects. Skipped work never affects a result.
//! Objects without a tool near are not evaluated.

use super::soft_bed::bed;
use super::*;
use crate::math::exp_rotation;

/// Returns a bed of springs centred at `x` (metres), y = 0.
fn bed_at(x: f64) -> Object {
    let mut object = bed(16);
    let spheres: Vec<Sphere> = object
        .tree
        .shape_at(object.level)
        .map(|(_, node)| Sphere {
            centre: node.centre + Vec3::x() * x,
            radius: node.contact_radius,
        })
        .collect();
    object.tree = SphereTree::over_leaves(&spheres).expect("valid");
    object
}

/// Returns a scene of two rods over two beds 20 mm apart, each with a rigid ball below. Another `far` soft and `far`
/// rigid beds lie out of reach of the rods.
fn two_beds(far: usize) -> Scene {
    let mut objects = vec![bed_at(-0.01), bed_at(0.01)];
    for x in [-0.01, 0.01] {
        let mut object = ball(0.01, TissueModel::Rigid);
        object.tree = SphereTree::over_leaves(&[Sphere {
            centre: Vec3::new(x, 0.0, -0.0112),
            radius: 0.01,
        }])
        .expect("valid");
        objects.push(object);
    }
    for k in 0..far {
        objects.push(bed_at(0.05 + 0.01 * k as f64));
        let mut stone = bed_at(-0.05 - 0.01 * k as f64);
        stone.tissue = TissueModel::Rigid;
        objects.push(stone);
    }
    let mut scene = scene(objects);
    scene.tools.push(scene.tools[0].clone());
    scene.validate().expect("valid");
    scene
}

/// Returns the input of both rods, `between` metres apart: pressed in, lifted, moved around and tilted.
fn both(k: u32, between: f64) -> TickInput {
    let mut input = TickInput::IDLE;
    for (t, slot) in input.tools.iter_mut().enumerate() {
        let phase = 1e-3 * f64::from(k) + 0.7 * t as f64;
        let speed = if k % 1000 < 500 { 1.0 } else { 8.0 };
        let tilt = exp_rotation(&Vec3::new(
            0.2 * libm::sin(1.7 * phase),
            0.15 * libm::sin(speed * phase),
            0.0,
        ));
        let tip = Vec3::new(
            between * (t as f64 - 0.5) + 1.2e-3 * libm::sin(2.3 * speed * phase),
            1.2e-3 * libm::sin(3.1 * phase),
            -5e-4 + 1.2e-3 * libm::sin(5.0 * phase),
        );
        *slot = ToolInput {
            pose: (&Pose::new(tip + tilt * Vec3::new(0.0, 0.0, 0.09025), tilt)).into(),
            present: true,
            ..ToolInput::ABSENT
        };
    }
    input
}

/// Returns the largest difference between two runs: poses (metres, radians), forces sent (newtons), tissues (metres).
fn differ(a: (&TickOutput, &State), b: (&TickOutput, &State)) -> f64 {
    let tools = a.0.tools.iter().zip(&b.0.tools).map(|(a, b)| {
        let turn = a.graphic.orientation * b.graphic.orientation.inverse();
        let moved = norm(&(a.graphic.position - b.graphic.position));
        let force = norm(&(a.wrench.force - b.wrench.force));
        [moved, norm(&log_rotation(&turn)), force]
    });
    let tissue = a.1.tissue.iter().zip(b.1.tissue.iter());
    let tissue = tissue.map(|(a, b)| (a - b).abs());
    tools
        .flatten()
        .chain(tissue)
        .fold(0.0, |most, x| if x > most { x } else { most })
}

#[test]
fn tools_that_touch_different_things_have_the_same_answer_apart_and_together() {
    let mut scene = two_beds(0);
    // From one state both runs have the same rows in the first substep. Later substeps start from different poses.
    scene.params.max_substeps = 1;
    let mut apart = (State::new(&scene), Workspace::new(&scene));
    let mut joint = (State::new(&scene), Workspace::together(&scene));
    let (mut touched, mut most) = (0, 0.0);
    for k in 0..3000 {
        let input = both(k, 0.02);
        // Same state in both runs: small differences must not add up.
        joint.0 = apart.0.clone();
        let a = tick(&scene, &mut apart.0, &mut apart.1, &input, &mut NoProbe);
        let b = tick(&scene, &mut joint.0, &mut joint.1, &input, &mut NoProbe);
        let (problems, together) = (
            apart.1.last_problems(&scene).count(),
            joint.1.last_problems(&scene).count(),
        );
        let well = |tool: &ToolOutput| tool.active > 0 && tool.converged;
        if a.tools.iter().all(well) && b.tools.iter().all(well) {
            assert_eq!((problems, together), (2, 1), "tick {k}");
            let found = differ((&a, &apart.0), (&b, &joint.0));
            most = if found > most { found } else { most };
            touched += 1;
        }
    }
    assert!(touched > 300, "both in contact in {touched} ticks");
    assert!(most < 1e-9, "{most:e}");
}

#[test]
fn both_tools_on_one_tissue_share_a_problem() {
    let scene = two_beds(0);
    let (mut state, mut ws) = (State::new(&scene), Workspace::new(&scene));
    let mut shared = 0;
    for k in 0..1500 {
        // Both rods on the first bed, 1.5 mm apart.
        let mut input = both(k, 1.5e-3);
        for slot in &mut input.tools {
            slot.pose.position[0] -= 0.01;
        }
        let out = tick(&scene, &mut state, &mut ws, &input, &mut NoProbe);
        if out.tools.iter().all(|tool| tool.active > 0) {
            assert_eq!(ws.last_problems(&scene).count(), 1, "tick {k}");
            shared += 1;
        }
    }
    assert!(shared > 100, "both in contact in {shared} ticks");
}

#[test]
fn a_tissue_that_both_reach_late_in_a_tick_begins_it_anew_and_nothing_shows() {
    // The second rod moves to the first rod's bed and back, fast: a substep covers only a part of the way.
    let scene = two_beds(2);
    let mut kept = (State::new(&scene), Workspace::new(&scene));
    let mut plain = (State::new(&scene), Workspace::plain(&scene));
    let (mut touched, mut joint) = (0, 0);
    for k in 0..2500 {
        let mut input = both(k, 0.02);
        let over = 0.0095 * (1.0 - libm::cos(0.02 * f64::from(k)));
        input.tools[1].pose.position[0] -= over as f32;
        for slot in &mut input.tools {
            slot.present = k % 700 > 15;
        }
        let a = tick(&scene, &mut kept.0, &mut kept.1, &input, &mut NoProbe);
        let b = tick(&scene, &mut plain.0, &mut plain.1, &input, &mut NoProbe);
        assert_eq!(a, b, "tick {k}");
        assert!(a.tools[0].status & (status::SOLVER_FAILED | status::FAULT) == 0);
        let both = a.tools.iter().all(|tool| tool.rows > 0);
        touched += u32::from(both);
        joint += u32::from(both && kept.1.last_problems(&scene).count() == 1);
        if k % 97 == 0 {
            // Restored from a snapshot, with a fresh workspace.
            let bytes = kept.0.to_bytes();
            let back = State::from_bytes(&scene, &bytes).expect("its own bytes");
            assert_eq!(back, kept.0);
            kept = (back, Workspace::new(&scene));
        }
    }
    assert!(
        joint > 50 && touched > joint + 50,
        "{joint} of {touched} ticks in one problem"
    );
}

#[test]
fn what_is_not_near_costs_no_query_no_list_and_a_byte() {
    let run = |far: usize| {
        let scene = two_beds(far);
        let (mut state, mut ws) = (State::new(&scene), Workspace::new(&scene));
        let mut begun = ws.work();
        let mut longest = 0;
        for k in 0..1500 {
            if k == 100 {
                // The tools have entered.
                begun = ws.work();
            }
            tick(&scene, &mut state, &mut ws, &both(k, 0.02), &mut NoProbe);
            longest = longest.max(state.to_bytes().len());
        }
        let work = ws.work();
        let done = [
            work.queries - begun.queries,
            work.lists - begun.lists,
            work.unlisted - begun.unlisted,
        ];
        (done, work.bounds - begun.bounds, longest)
    };
    let (few, many) = (run(0), run(10));
    assert_eq!(few.0, many.0, "queries, lists, unlisted");
    assert!(few.0[0] > 1000);
    // Twenty more objects and two tools: less than one more bound per tick.
    assert!(many.1 - few.1 < 1400, "{} and {} bounds", few.1, many.1);
    // A byte for the load by each tool on each object, and a byte for each soft bed's tissue.
    assert_eq!(many.2 - few.2, 2 * 20 + 10);
}

#[test]
fn a_tissue_at_rest_has_no_numbers_in_the_bytes_and_none_may_be_put_there() {
    let scene = two_beds(0);
    let (mut state, mut ws) = (State::new(&scene), Workspace::new(&scene));
    let rest = state.to_bytes().len();
    for k in 0..300 {
        let mut input = both(k, 0.02);
        input.tools[1].present = false;
        tick(&scene, &mut state, &mut ws, &input, &mut NoProbe);
        assert!(state.tissue.at_rest(1), "nobody touches the second bed");
        assert_eq!(
            state.tissue.at_rest(0),
            state.tissue.of(0).iter().all(|x| *x == 0.0)
        );
        let back = State::from_bytes(&scene, &state.to_bytes()).expect("its own bytes");
        assert_eq!(back, state);
        if !state.tissue.at_rest(0) {
            break;
        }
    }
    let bytes = state.to_bytes();
    let numbers = state.tissue.of(0).len();
    let loads = state
        .loads
        .iter()
        .filter(|load| **load != Wrench::ZERO)
        .count();
    assert!(loads > 0);
    assert_eq!(bytes.len(), rest + 8 * numbers + 48 * loads);
    // The same bytes with zeros as the first bed's numbers: a tissue at rest must take no room.
    let tail = 3 * MAX_TOOLS;
    let end = bytes.len() - tail - 1;
    let mut zeros = bytes.clone();
    zeros[end - 8 * numbers..end].fill(0);
    assert_eq!(zeros[end - 8 * numbers - 1], 1);
    assert!(matches!(
        State::from_bytes(&scene, &zeros),
        Err(state::StateError::Value { .. })
    ));
    // Truncated, extended, or of another version.
    for cut in [0, 1, 17, bytes.len() / 2, bytes.len() - 1] {
        assert!(State::from_bytes(&scene, &bytes[..cut]).is_err(), "{cut}");
    }
    let mut longer = bytes.clone();
    longer.push(0);
    assert!(State::from_bytes(&scene, &longer).is_err());
    let mut other = bytes.clone();
    other[0] ^= 1;
    assert!(matches!(
        State::from_bytes(&scene, &other),
        Err(state::StateError::Version { .. })
    ));
}
