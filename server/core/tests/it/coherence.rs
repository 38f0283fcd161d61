//! Contact prediction with caches: same results with less work.
//!
//! Whole sessions must have the same hashes with caches, without caches, and with a new workspace in every tick. The
//! work, as a count, must grow far slower than the number of spheres.

use sulcus_core::tissue::TissueModel;
use sulcus_core::*;
use sulcus_operator::crown::{Crown, CrownParams};
use sulcus_operator::{HandParams, Operator, Shown};
use sulcus_scene::{BuildOptions, compile_default};

#[test]
fn a_crown_session_has_the_same_hashes_with_and_without_memory() {
    let options = BuildOptions {
        deepest: Some(3),
        ..BuildOptions::default()
    };
    let scene = compile_default(&options, &|_, _| {})
        .expect("built in")
        .scene;
    let params = CrownParams {
        duration: 3.0,
        ..CrownParams::default()
    };
    let crown = Crown::new(&scene, None, params).expect("a tooth");
    let mut operator = Operator::new(Box::new(crown), HandParams::default(), 7);
    let mut shown = Shown::NOTHING;
    let mut states = [(); 3].map(|()| State::new(&scene));
    let (mut kept, mut plain) = (Workspace::new(&scene), Workspace::plain(&scene));
    let (mut contact, ticks) = (0, operator.ticks());
    for k in 0..ticks {
        let mut input = TickInput::IDLE;
        input.tools = operator.step(&shown);
        let [first, second, third] = &mut states;
        let out = tick(&scene, first, &mut kept, &input, &mut NoProbe);
        let traversed = tick(&scene, second, &mut plain, &input, &mut NoProbe);
        assert_eq!(out, traversed, "tick {k}");
        let mut fresh = Workspace::new(&scene);
        let forgetful = tick(&scene, third, &mut fresh, &input, &mut NoProbe);
        assert_eq!(out, forgetful, "tick {k}");
        contact += u64::from(out.tools[0].active > 0);
        shown = Shown::from(&out);
    }
    assert!(contact > 800, "in contact in {contact} of {ticks} ticks");
    let work = kept.work();
    // Without caches every pass queries every object: the number of occasions for a list.
    let occasions = plain.work().queries;
    assert_eq!(work.unlisted, 0);
    assert!(work.queries < occasions, "{work:?} of {occasions}");
    assert!(work.lists * 3 < occasions, "{work:?} of {occasions}");
    assert!(
        work.tested * 2 < plain.work().tested,
        "{work:?} against {:?}",
        plain.work()
    );
}

/// Returns a scene with an ellipsoid of inscribed balls, the size of a molar, and a probe's end as a row of beads.
fn molar_like(balls: u32) -> Scene {
    let semi_axes = Vec3::new(5e-3, 5.5e-3, 6e-3);
    let inscribed = (0..balls).map(|k| {
        // Fibonacci lattice on the sphere.
        let z = 1.0 - (2.0 * f64::from(k) + 1.0) / f64::from(balls);
        let (turn, ring) = (2.399_963_229_728_653 * f64::from(k), (1.0 - z * z).sqrt());
        let on = Vec3::new(ring * libm::cos(turn), ring * libm::sin(turn), z);
        let normal = on.component_div(&semi_axes);
        Sphere {
            centre: semi_axes.component_mul(&on) - normal * (1.5e-3 / math::norm(&normal)),
            radius: 1.5e-3,
        }
    });
    let tree = SphereTree::over_leaves(&inscribed.collect::<Vec<_>>()).expect("valid");
    let beads = (0..200).map(|k| Sphere {
        centre: Vec3::new(0.0, 0.0, -0.09 + 6e-5 * f64::from(k)),
        radius: 2.5e-4 + 1e-6 * f64::from(k),
    });
    Scene {
        name: "ellipsoid".into(),
        source_hash: String::new(),
        params: Params::default(),
        tools: vec![Tool {
            name: "beads".into(),
            tree: SphereTree::over_leaves(&beads.collect::<Vec<_>>()).expect("valid"),
            level: 7,
            working_point: Vec3::new(0.0, 0.0, -0.088),
            tip: Vec3::new(0.0, 0.0, -0.09025),
            tip_axis: -Vec3::z(),
            stiffness_n_per_m: 500.0,
            stiffness_nm_per_rad: 0.5,
            park: Pose::new(Vec3::new(0.0, 0.0, 0.115), Quat::identity()),
            bands: vec![],
            mesh: DisplayMesh::default(),
        }],
        objects: vec![Object {
            name: "ellipsoid".into(),
            fdi: 0,
            tree,
            level: 7,
            tissue: TissueModel::Rigid,
            mesh: DisplayMesh::default(),
            carriers: Vec::new(),
        }],
    }
}

/// Returns the number of spheres tested per tick. The tip moves round the top at 12 mm/s, half a millimetre deep, and
/// the tool turns at 1 rad/s.
fn tested_per_tick(scene: &Scene, ws: &mut Workspace) -> f64 {
    let mut state = State::new(scene);
    let (mut contact, mut before) = (0, 0);
    for k in 0..2300 {
        if k == 300 {
            before = ws.work().tested;
        }
        let angle = 4e-3 * f64::from(k);
        let tilt = math::exp_rotation(&Vec3::new(
            0.25 * libm::sin(angle),
            0.25 * libm::cos(angle),
            0.0,
        ));
        let tip = Vec3::new(3e-3 * libm::cos(angle), 3e-3 * libm::sin(angle), 4.1e-3);
        let pose = Pose::new(tip + tilt * Vec3::new(0.0, 0.0, 0.09025), tilt);
        let mut input = TickInput::IDLE;
        input.tools[0] = ToolInput {
            pose: RawPose::from(&pose),
            present: true,
            ..ToolInput::ABSENT
        };
        let out = tick(scene, &mut state, ws, &input, &mut NoProbe);
        contact += u32::from(k >= 300 && out.tools[0].active > 0);
    }
    assert!(contact > 1900, "in contact in {contact} of 2000 ticks");
    (ws.work().tested - before) as f64 / 2000.0
}

#[test]
fn sixty_four_times_the_spheres_are_nowhere_near_sixty_four_times_the_work() {
    let (coarse, fine) = (molar_like(512), molar_like(32_768));
    let few = tested_per_tick(&coarse, &mut Workspace::new(&coarse));
    let many = tested_per_tick(&fine, &mut Workspace::new(&fine));
    let traversed = tested_per_tick(&fine, &mut Workspace::plain(&fine));
    assert!(
        many < 20.0 * few,
        "{many} tested at 32,768 spheres, {few} at 512"
    );
    assert!(
        many * 1.4 < traversed,
        "{many} tested, {traversed} without lists"
    );
}
