//! The benchmark with one degree of freedom, and the core's printed skeleton against it.

use sulcus_cases::one_dof::{Contact, DEPTH, Method, OneDof, SPEEDS, Table};
use sulcus_core::tissue::TissueModel;
use sulcus_core::tissue::printed::PrintedSkeleton;
use sulcus_core::*;
use sulcus_operator::present;

/// Length of a tick, seconds.
const TICK_S: f64 = 1e-3;

#[test]
fn the_onset_of_instability_is_within_a_hundredth_of_eq_9() {
    let table = Table::run();
    println!("{table}");
    for row in &table.0 {
        let (predicted, measured) = row.limits;
        assert!((measured / predicted - 1.0).abs() < 0.01, "{row:?}");
    }
    for damping_ratio in [0.1, 0.9, 1.0, 1.5, 4.0] {
        let numbers = OneDof {
            damping_ratio,
            ..OneDof::with_spring(500.0)
        };
        let (predicted, measured) = (numbers.predicted_limit(), numbers.measured_limit());
        assert!(
            (measured / predicted - 1.0).abs() < 0.01,
            "damping ratio {damping_ratio}: {measured} s, predicted {predicted} s"
        );
    }
}

#[test]
fn pressed_and_held_it_is_where_statics_say() {
    for row in Table::run().0 {
        let n = &row.numbers;
        for (method, presses) in &row.presses {
            let (push, pull) = match method {
                Method::Coupled => (n.coupling, n.coupling),
                _ => (n.penalty, n.coupling),
            };
            let depth = push * DEPTH / (push + n.spring);
            for press in presses {
                assert!(
                    (press.depth - depth).abs() < 1e-6,
                    "{method}: {press:?}, {depth}"
                );
                let device = pull * (DEPTH - depth);
                assert!(
                    (press.device_force - device).abs() < 1e-3,
                    "{method}: {press:?}"
                );
                // What the tissue feels of what the hand feels: all, or k_p / k_c of it.
                let ratio = press.tissue_force / press.device_force;
                assert!((ratio - push / pull).abs() < 1e-3, "{method}: {ratio}");
            }
        }
    }
}

#[test]
fn coupled_stays_stable_where_explicit_euler_does_not() {
    // A twentieth over the printed method's limit at a millisecond, and a thousand times.
    for spring in [21_000.0, 2e7] {
        let numbers = OneDof::with_spring(spring);
        assert!(numbers.predicted_limit() < TICK_S);
        for speed in SPEEDS {
            let printed = numbers.press(Method::Printed, speed, DEPTH);
            let force = printed.largest_force;
            assert!(force.is_nan() || force >= 100.0, "{printed:?}");
            for method in [Method::Implicit, Method::Coupled] {
                let press = numbers.press(method, speed, DEPTH);
                assert!(
                    press.largest_force <= numbers.coupling * DEPTH * 1.001,
                    "{press:?}"
                );
                assert!(press.force_step < 1e-3, "{method}: {press:?}");
            }
        }
    }
}

/// Radius of all spheres: so large that the haptic one, deep inside, still overlaps what it presses.
const RADIUS: f64 = 1e-2;

/// Fig. 7 as a scene: a held sphere, one that moves along x, and a tool of one sphere.
fn figure_7(numbers: &OneDof) -> Scene {
    let ball = |x: f64| Sphere {
        centre: Vec3::new(x, 0.0, 0.0),
        radius: RADIUS,
    };
    let tree = SphereTree::over_leaves(&[ball(0.0), ball(0.05)]).expect("valid");
    let fixed = tree
        .shape_at(1)
        .find(|(_, node)| node.centre.x > 0.01)
        .map(|(id, _)| id)
        .expect("the held one");
    let mut model = PrintedSkeleton::new(1, vec![[1, 2]], vec![fixed]);
    model.spring_n_per_m = numbers.spring;
    model.damping_n_s_per_m = numbers.damping();
    model.mass_kg = numbers.mass;
    model.penalty_n_per_m = numbers.penalty;
    model.contact_distance_m = numbers.contact_distance;
    Scene {
        name: "one degree of freedom".into(),
        source_hash: String::new(),
        params: Params::default(),
        tools: vec![Tool {
            name: "ball".into(),
            tree: SphereTree::over_leaves(&[ball(0.0)]).expect("valid"),
            level: 7,
            working_point: Vec3::zeros(),
            tip: Vec3::x() * RADIUS,
            tip_axis: Vec3::x(),
            stiffness_n_per_m: numbers.coupling,
            stiffness_nm_per_rad: 0.5,
            park: Pose::new(Vec3::x() * (-2.0 * RADIUS - 5e-3), Quat::identity()),
            bands: vec![],
            mesh: DisplayMesh::default(),
        }],
        objects: vec![Object {
            name: "tissue".into(),
            fdi: 0,
            tree,
            level: 7,
            tissue: TissueModel::PrintedSkeleton(model),
            mesh: DisplayMesh::default(),
            carriers: Vec::new(),
        }],
    }
}

#[test]
fn the_core_as_printed_moves_as_the_benchmark_does() {
    for spring in [5.0, 500.0, 15_000.0] {
        let numbers = OneDof::with_spring(spring);
        let scene = figure_7(&numbers);
        scene.validate().expect("stable");
        let (mut state, mut ws) = (State::new(&scene), Workspace::new(&scene));
        let mut contact = Contact {
            place: 0.0,
            velocity: 0.0,
            tool: -5e-3,
        };
        let (mut deepest, mut worst) = (0.0_f64, 0.0_f64);
        for k in 0..1500 {
            let t = f64::from(k) * 1e-3;
            // In, a little to and fro, and out again; as the wire rounds it.
            let wanted = -5e-3 + 15e-3 * (2.4 * t).sin() + 1e-3 * (25.0 * t).sin();
            let x = f64::from((wanted - 2.0 * RADIUS) as f32);
            let mut input = TickInput::IDLE;
            input.tools[0] = present(&Pose::new(Vec3::new(x, 0.0, 0.0), Quat::identity()));
            let out = tick(&scene, &mut state, &mut ws, &input, &mut NoProbe);
            contact.step(&numbers, Method::Printed, x + 2.0 * RADIUS, TICK_S);
            let tool = out.tools[0].graphic.position.x + 2.0 * RADIUS;
            let mut centre = [Vec3::zeros()];
            assert!(ws.centres_of(0, &[1], &mut centre) && centre[0].x < 0.02);
            let away = (tool - contact.tool)
                .abs()
                .max((centre[0].x - contact.place).abs());
            worst = worst.max(away);
            deepest = deepest.max(contact.place);
        }
        println!(
            "k_s {spring} N/m: deepest {:.3} mm, core and benchmark differ by {:.2e} m",
            deepest * 1e3,
            worst
        );
        assert!(deepest > 1e-6, "{deepest}");
        assert!(
            worst < 1e-7 + 1e-3 * deepest.min(1e-4),
            "k_s {spring}: {worst} m"
        );
    }
}
