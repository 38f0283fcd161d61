//! The crown exercise in closed loop: what must hold of every tick, each checked from a computation
//! that shares nothing with the tick's own.

use sulcus_cases::{Measures, Observer};
use sulcus_core::math::norm;
use sulcus_core::optimise::SolverKind;
use sulcus_core::output::status;
use sulcus_core::{NoProbe, Scene, State, TickInput, Vec3, Workspace, tick};
use sulcus_operator::crown::{Crown, CrownParams};
use sulcus_operator::{HandParams, Operator, Shown};
use sulcus_scene::mesh::TriMesh;
use sulcus_scene::mesh::distance::MeshDistance;
use sulcus_scene::tree::blend::{BlendOptions, calibrate};
use sulcus_scene::{BuildOptions, compile_default, default_cache_dir};

pub fn options() -> BuildOptions {
    BuildOptions {
        cache: default_cache_dir(),
        ..BuildOptions::default()
    }
}

fn molar() -> Scene {
    compile_default(&options(), &|_, _| {})
        .expect("the built-in scene")
        .scene
}

/// The scene with its object touched as one smooth surface at `level`.
fn blended(mut scene: Scene, level: u8) -> Scene {
    let object = &mut scene.objects[0];
    let mesh = TriMesh {
        vertices: object
            .mesh
            .vertices
            .iter()
            .map(|v| Vec3::new(v[0].into(), v[1].into(), v[2].into()))
            .collect(),
        triangles: object.mesh.triangles.clone(),
    };
    let options = BlendOptions {
        coarsest: level,
        finest: level,
        ..BlendOptions::default()
    };
    object.tree =
        calibrate(&object.tree, &MeshDistance::new(mesh), &options).expect("a tree stays a tree");
    object.level = level;
    scene.tools[0].level = level;
    scene
}

/// Performs the exercise and checks each tick's own books on the way.
pub fn perform(scene: &Scene, seconds: f64, seed: u64) -> Measures {
    let crown = Crown::new(
        scene,
        None,
        CrownParams {
            duration: seconds,
            ..CrownParams::default()
        },
    );
    let mut operator = Operator::new(
        Box::new(crown.expect("a tooth")),
        HandParams::default(),
        seed,
    );
    let (mut state, mut ws) = (State::new(scene), Workspace::new(scene));
    let mut observer = Observer::new(scene);
    let mut shown = Shown::NOTHING;
    for k in 0..operator.ticks() {
        let mut input = TickInput::IDLE;
        input.tools = operator.step(&shown);
        let out = tick(scene, &mut state, &mut ws, &input, &mut NoProbe);
        observer.observe(scene, &input, &out, &ws);
        check_books(scene, &state, &ws, &out, k);
        shown = Shown::from(&out);
    }
    observer.measures()
}

/// Multipliers, complementarity and the sum of loads.
fn check_books(
    scene: &Scene,
    state: &State,
    ws: &Workspace,
    out: &sulcus_core::TickOutput,
    k: u64,
) {
    let tool = &out.tools[0];
    if tool.status & (status::SOLVER_FAILED | status::ABSENT) != 0 || !tool.converged {
        return;
    }
    let mut push = Vec3::zeros();
    let smooth = scene.blend_of(0) > 0.0;
    // (The judge, an interior point method, leaves a trace of load on rows that do not bear.)
    if smooth && norm(&tool.raw_wrench.force) > 0.01 {
        // Complementarity on the surface: what bears load touches it, but for how much the surface
        // bends over the last step.
        assert!(
            (-1e-6..=5e-6).contains(&tool.min_gap),
            "tick {k}: {:e} m",
            tool.min_gap
        );
    }
    for (contact, lambda) in ws.contacts() {
        assert!(lambda >= 0.0, "tick {k}: multiplier {lambda:e}");
        push += contact.normal * lambda;
        if smooth {
            continue;
        }
        // Complementarity on the true geometry: a sphere pair that bears load touches.
        let nodes = (
            &scene.tools[0].tree.nodes()[contact.tool_sphere as usize],
            &scene.objects[usize::from(contact.object)].tree.nodes()
                [contact.object_sphere as usize],
        );
        let gap = norm(&(tool.graphic.transform(&nodes.0.centre) - nodes.1.centre))
            - nodes.0.contact_radius
            - nodes.1.contact_radius;
        assert!(gap >= -1e-6, "tick {k}: gap {gap:e} m");
        if lambda > 1e-6 {
            assert!(
                gap <= 1e-6,
                "tick {k}: {lambda:e} N across a gap of {gap:e} m"
            );
        }
    }
    let loads = state
        .loads
        .iter()
        .fold(Vec3::zeros(), |sum, load| sum + load.force);
    assert!(
        norm(&(loads + push)) < 1e-9,
        "tick {k}: loads {loads:?}, multipliers {push:?}"
    );
    assert!(
        norm(&(loads + tool.raw_wrench.force)) < 1e-12,
        "tick {k}: wrench {:?}",
        tool.raw_wrench
    );
}

pub fn assert_good(what: &str, m: &Measures) {
    println!(
        "{what}: contact {} of {}, residual {:.4} um, jump {:.3} mm, force step {:.3} N, buzz {:.5} N, coupling {:.3} %, exhausted {}, raw {:.2} N",
        m.contact_ticks,
        m.ticks,
        m.residual * 1e6,
        m.jump * 1e3,
        m.force_step,
        m.buzz,
        m.coupling_error * 100.0,
        m.exhausted,
        m.max_raw_force
    );
    assert!(m.contact_ticks * 2 > m.ticks, "{what}: hardly touched");
    assert!(m.residual <= 1e-6, "{what}: residual {:e} m", m.residual);
    assert!(
        m.coupling_error <= 0.01,
        "{what}: coupling {:e}",
        m.coupling_error
    );
    assert!(
        m.exhausted * 1000 <= m.ticks,
        "{what}: {} exhausted of {}",
        m.exhausted,
        m.ticks
    );
    assert_eq!(m.solver_failed, 0, "{what}");
    assert!(m.jump <= 2e-3, "{what}: jump {:e} m", m.jump);
    assert!(m.buzz <= 0.01, "{what}: buzz {:e} N", m.buzz);
}

#[test]
fn on_the_parametric_molar_at_levels_2_to_4() {
    for level in 2..=4 {
        let mut scene = molar();
        scene.tools[0].level = level;
        scene.objects[0].level = level;
        assert_good(
            &format!("molar level {level}"),
            &perform(&scene, 8.0, u64::from(level)),
        );
    }
}

#[test]
fn on_the_blended_molar_at_levels_2_to_4() {
    for level in 2..=4 {
        let scene = blended(molar(), level);
        assert!(scene.blend_of(0) > 0.0);
        let smooth = perform(&scene, 8.0, u64::from(level));
        assert_good(&format!("blended molar level {level}"), &smooth);
        let mut hard = scene.clone();
        hard.params.blend = false;
        let mut plain = molar();
        (plain.tools[0].level, plain.objects[0].level) = (level, level);
        // Without blending a calibrated tree is what it was before.
        assert_eq!(
            perform(&hard, 2.0, u64::from(level)),
            perform(&plain, 2.0, u64::from(level))
        );
    }
}

#[test]
fn with_the_judge_in_the_tick() {
    let mut scene = molar();
    scene.params.solver = SolverKind::Clarabel;
    assert_good("molar, Clarabel", &perform(&scene, 5.0, 5));
}
