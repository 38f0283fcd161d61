//! Two tools on one tissue, torque in a pocket, and that the residual looks at the deformed shape.

use sulcus_cases::tissue_scenes::{pocket, tongue, twice};
use sulcus_cases::{Observer, find, run};
use sulcus_core::math::norm;
use sulcus_core::{
    MAX_TOOLS, NoProbe, Pose, Scene, State, TickInput, TickOutput, Vec3, Workspace, tick,
};
use sulcus_operator::pocket_path::{Manner, PocketPath};
use sulcus_operator::present;
use sulcus_operator::retraction::{Retraction, RetractionParams};

/// Leads kinematic hands for `ticks` ticks; returns the last output and what the observer found.
fn lead(
    scene: &Scene,
    ticks: u64,
    poses: impl Fn(f64) -> [Option<Pose>; MAX_TOOLS],
) -> (TickOutput, Observer, State, Workspace) {
    let (mut state, mut ws) = (State::new(scene), Workspace::new(scene));
    let mut observer = Observer::new(scene);
    observer.residual_every = 10;
    let mut last = None;
    for k in 0..ticks {
        let mut input = TickInput::IDLE;
        let poses = poses(k as f64 * 1e-3);
        for (slot, pose) in input.tools.iter_mut().zip(poses) {
            if let Some(pose) = pose {
                *slot = present(&pose);
            }
        }
        let output = tick(scene, &mut state, &mut ws, &input, &mut NoProbe);
        observer.observe(scene, &input, &output, &ws);
        last = Some(output);
    }
    (last.expect("some ticks"), observer, state, ws)
}

fn mirror(scene: &Scene, flank: f64) -> Retraction {
    let params = RetractionParams {
        flank,
        ..RetractionParams::default()
    };
    Retraction::new(scene, params).expect("a tongue and a mirror")
}

/// 7 mm down within 0.8 s, then held.
fn press(t: f64) -> f64 {
    -4e-3 + 11e-3 * (t / 0.8).min(1.0)
}

fn force(output: &TickOutput, t: usize) -> Vec3 {
    output.tools[t].raw_wrench.force
}

/// Ticks with what is kept from tick to tick and without, which must not differ; returns how many were in contact.
fn kept_as_plain(scene: &Scene, ticks: u64, mut input: impl FnMut(u64) -> TickInput) -> u32 {
    let mut kept = (State::new(scene), Workspace::new(scene));
    let mut plain = (State::new(scene), Workspace::plain(scene));
    let mut touched = 0;
    for k in 0..ticks {
        let input = input(k);
        let a = tick(scene, &mut kept.0, &mut kept.1, &input, &mut NoProbe);
        let b = tick(scene, &mut plain.0, &mut plain.1, &input, &mut NoProbe);
        assert_eq!(a, b, "tick {k}");
        touched += u32::from(a.tools[0].active > 0);
    }
    assert!(kept.1.work().lists > 0 && plain.1.work().lists == 0);
    touched
}

#[test]
fn what_is_kept_of_tongue_and_gingiva_never_shows() {
    let mut input = TickInput::IDLE;
    let scene = tongue(2.0);
    let at = mirror(&scene, 0.0);
    let touched = kept_as_plain(&scene, 2500, |k| {
        // Down, to and fro at up to 40 mm/s, levels of detail in turn, out and asleep, and down again.
        let t = k as f64 * 1e-3;
        let deep = if (1.6..1.9).contains(&t) {
            -8e-3
        } else {
            press(t)
        };
        input.tools[0] = present(&at.pose(deep, 0.0, 4e-3 * libm::sin(10.0 * t)));
        TickInput {
            detail: u8::from(k / 300 % 2 == 1),
            ..input
        }
    });
    assert!(touched > 1000, "{touched}");
    let scene = pocket("0.4");
    let path = PocketPath::new(&scene, None, 1e-4, Manner::Taught).expect("a pocket");
    let touched = kept_as_plain(&scene, 2500, |k| {
        let t = k as f64 * 1e-3;
        let depth = if (1.5..1.8).contains(&t) {
            -6e-3
        } else {
            -4e-3 + 6e-3 * (t / 0.7).min(1.0)
        };
        let bearing = f64::to_radians(90.0 + 15.0 * libm::sin(6.0 * t));
        input.tools[0] =
            present(&path.pose(bearing, depth, 0.1 * libm::sin(9.0 * t), Vec3::zeros()));
        input
    });
    assert!(touched > 1000, "{touched}");
}

#[test]
fn two_mirrors_at_one_place_share_the_tongue_equally() {
    let (one, two) = (tongue(0.5), twice(tongue(0.5)));
    let at = mirror(&one, 0.0);
    let alone = lead(&one, 1500, |t| [Some(at.pose(press(t), 0.0, 0.0)), None]).0;
    let both = lead(&two, 1500, |t| [Some(at.pose(press(t), 0.0, 0.0)); 2]);
    let (a, b, lone) = (force(&both.0, 0), force(&both.0, 1), force(&alone, 0));
    println!("alone {lone:?}, together {a:?} and {b:?}");
    assert!(norm(&(a - b)) <= 1e-6 * norm(&a), "{a:?} against {b:?}");
    // Two springs on one: each bears less than alone, both together more.
    assert!(norm(&a) < norm(&lone) && 2.0 * norm(&a) > norm(&lone));
    let m = both.1.measures();
    assert!(m.residual <= 1e-6, "{:e} m", m.residual);
    assert!(m.imbalance <= 1e-6, "{:e}", m.imbalance);
}

#[test]
fn two_mirrors_on_opposite_flanks_are_pushed_apart_alike() {
    let two = twice(tongue(0.5));
    let at = [mirror(&two, 0.46), mirror(&two, -0.46)];
    let both = lead(&two, 1500, |t| {
        [0, 1].map(|k| Some(at[k].pose(press(t), 0.0, 0.0)))
    });
    let (a, b) = (force(&both.0, 0), force(&both.0, 1));
    println!("left {a:?}, right {b:?}");
    // The tongue is symmetric, its spheres are so only as far as they fit it.
    let mirrored = Vec3::new(b.x, -b.y, b.z);
    assert!(norm(&(a - mirrored)) <= 0.1 * norm(&a), "{a:?} and {b:?}");
    assert!(a.y > 0.1 * norm(&a), "the left one is pushed left: {a:?}");
    // What both tools load the tongue with is what the hands feel.
    let objects = two.objects.len();
    for t in 0..2 {
        let loads = &both.2.loads[t * objects..(t + 1) * objects];
        let sum = loads
            .iter()
            .fold(Vec3::zeros(), |sum, load| sum + load.force);
        assert!(norm(&(sum + force(&both.0, t))) <= 1e-9);
    }
    assert!(both.1.measures().residual <= 1e-6);
}

#[test]
fn probes_on_opposite_sides_of_a_tooth_feel_as_if_alone() {
    let (one, two) = (pocket("0.4"), twice(pocket("0.4")));
    let path = PocketPath::new(&one, None, 1e-4, Manner::Taught).expect("a pocket");
    let sides = [90.0, -90.0].map(f64::to_radians);
    let pose = |side: f64, t: f64| {
        let depth = -2e-3 + 6.3e-3 * (t / 1.2).min(1.0);
        Some(path.pose(side, depth, 0.0, Vec3::zeros()))
    };
    let both = lead(&two, 1500, |t| sides.map(|side| pose(side, t)));
    for (t, side) in sides.into_iter().enumerate() {
        let alone = lead(&one, 1500, |time| [pose(side, time), None]).0;
        let (a, b) = (force(&alone, 0), force(&both.0, t));
        println!("alone {a:?}, with the other {b:?}");
        assert!(norm(&a) > 0.02, "it touches: {a:?}");
        assert!(norm(&(a - b)) <= 1e-3 * norm(&a), "{a:?} and {b:?}");
    }
    assert!(both.1.measures().residual <= 1e-6);
}

#[test]
fn torque_in_a_pocket_changes_sign_with_the_turning_direction() {
    for width in ["0.4", "0.5", "0.65", "0.8"] {
        let scene = pocket(width);
        let path = PocketPath::new(&scene, None, 1e-4, Manner::Taught).expect("a pocket");
        let bearing = 90f64.to_radians();
        let torque = |turn: f64| {
            let out = lead(&scene, 2000, |t| {
                let depth = -2e-3 + 6e-3 * (t / 1.2).min(1.0);
                let tilt = turn * ((t - 1.2) / 0.5).clamp(0.0, 1.0);
                [Some(path.pose(bearing, depth, tilt, Vec3::zeros())), None]
            });
            let tool = &out.0.tools[0];
            let lever = tool.haptic.orientation * scene.tools[0].working_point;
            // A tilt away from the tooth, which is at y, turns about minus x.
            -tool.raw_wrench.moved(&-lever).torque.x
        };
        let (inwards, outwards) = (torque(-0.1745), torque(0.1745));
        println!(
            "{width} mm: {:.2} N mm turned in, {:.2} turned out",
            inwards * 1e3,
            outwards * 1e3
        );
        // Against the turn, both ways.
        assert!(inwards > 1e-4, "{width}: {inwards:e} N m");
        assert!(outwards < -1e-4, "{width}: {outwards:e} N m");
    }
}

#[test]
fn the_residual_is_that_of_the_deformed_shape() {
    let scene = tongue(0.5);
    let at = mirror(&scene, 0.0);
    let (output, observer, _, ws) = lead(&scene, 1500, |t| {
        [Some(at.pose(press(t) + 4e-3, 0.0, 0.0)), None]
    });
    let m = observer.measures();
    assert!(m.residual <= 1e-6, "{:e} m", m.residual);
    assert!(m.indentation > 5e-3, "{:e} m", m.indentation);
    // The same tool among the spheres as they are at rest would be millimetres deep.
    let object = &scene.objects[0];
    let (ids, rest): (Vec<u32>, Vec<(Vec3, f64)>) = object
        .tree
        .shape_at(object.level)
        .map(|(id, node)| (id, (node.centre, node.contact_radius)))
        .unzip();
    let mut now = vec![Vec3::zeros(); ids.len()];
    assert!(ws.centres_of(0, &ids, &mut now));
    let tool = &scene.tools[0];
    let overlap = |centre: &Vec3, radius: f64| {
        tool.tree
            .shape_at(tool.level)
            .map(|(_, node)| {
                let at = output.tools[0].graphic.transform(&node.centre);
                radius + node.contact_radius - norm(&(at - centre))
            })
            .fold(f64::NEG_INFINITY, f64::max)
    };
    let deepest = |centres: &[Vec3]| {
        let pairs = centres.iter().zip(&rest);
        pairs
            .map(|(centre, (_, radius))| overlap(centre, *radius))
            .fold(f64::NEG_INFINITY, f64::max)
    };
    let at_rest: Vec<Vec3> = rest.iter().map(|(centre, _)| *centre).collect();
    assert!(deepest(&at_rest) > 4e-3);
    assert!(deepest(&now) <= 1e-6);
}

#[test]
fn what_a_hand_lets_go_comes_back_and_gives_nothing_extra() {
    // 15 mm in, let go at 80 mm/s: the numbers of the table, looked at as energy.
    let report = run(find("tongue-15-k0.5").expect("in the table"), |_| {});
    let m = &report.measures;
    assert!(m.work_in > 5e-3, "{:e} J put in", m.work_in);
    assert!(m.energy <= 0.01 * m.work_in, "{:e} J out", m.energy);
    assert!(m.rebound <= 0.01, "{:e}", m.rebound);
    assert!(m.unrest <= 1e-6, "{:e} m", m.unrest);
}
