//! The real lower left arch, the parametric probe and mirror: what the meshes alone say of the pocket, and a probe in it.

mod scene;
mod stroll;
mod ways;

use sulcus_cases::inside::{Points, allowed_inside};
use sulcus_cases::{Observer, find};
use sulcus_core::tissue::gingiva::Site;
use sulcus_core::{NoProbe, Pose, State, TickInput, ToolInput, Vec3, Workspace, Wrench, tick};
use sulcus_operator::script::smoothstep;
use sulcus_operator::{Hand, HandParams, present};
use sulcus_scene::instruments::Probe;
use sulcus_scene::mesh::distance::MeshDistance;
use sulcus_support::long;

use stroll::Stroll;

/// Height of the pocket's floor in the data, metres: a plane.
const FLOOR: f64 = 1e-3;

#[test]
fn the_pocket_of_tooth_36_is_found_by_sounding_the_meshes() {
    if !long::selected("real-arch-sounded") {
        return;
    }
    let Some(scene) = scene::scene() else { return };
    let gingiva = scene::gingiva(scene);
    let sink = gingiva.params.sink();
    let mut least = f64::INFINITY;
    let mut deepest: (f64, Option<Site>) = (0.0, None);
    for site in Site::ALL {
        let prescribed = gingiva.prescribed(site);
        let bare = prescribed.depth - sink;
        println!("{}: {:.2} mm from margin to floor", site.name(), bare * 1e3);
        least = least.min(bare);
        if bare > deepest.0 {
            deepest = (bare, Some(site));
        }
    }
    // By the data's own account 3.2 mm (mesial, lingual) to 6.0 mm (distobuccal).
    assert_eq!(deepest.1, Some(Site::DistoBuccal));
    assert!((deepest.0 - 6.0e-3).abs() < 0.3e-3, "{deepest:?}");
    assert!(least > 2e-3, "{least:e}");
    // Its floor is a plane, and so it was found: nothing but the meshes was given.
    let off = gingiva.places.iter().filter(|place| place.floor).count();
    assert!(off > 10, "{off}");
}

#[test]
fn a_probe_opens_the_pocket_reads_walks_and_is_never_inside_a_tooth() {
    if !long::selected("real-arch-probed") {
        return;
    }
    let Some(scene) = scene::scene() else { return };
    let teeth = [36, 35, 37].map(|fdi| (fdi, scene::mesh(scene::file_of(fdi)).expect("a tooth")));
    let meshes: Vec<&MeshDistance> = teeth.iter().map(|(_, mesh)| mesh).collect();
    let gingiva = scene::gingiva(scene);
    let floor = FLOOR - gingiva.tooth.origin.z;
    // Distobuccal, then buccally in steps of about a millimetre.
    let tissue = scene::mesh("gingiva_patch_36_pocket").expect("a gingiva");
    let site = ways::Site::new(scene, meshes.clone(), &tissue, floor);
    let ways = [138.0, 131.0, 124.0, 117.0].map(|degrees| site.descent(degrees));
    let probe = Probe::default().touching_mesh();
    let tool = &scene.tools[0];
    // What can come near a tooth.
    let points = Points::of(&probe, 2e-4, |point| (point - tool.tip).norm() < 14e-3);

    let mut stroll = Stroll::new(ways.to_vec());
    let (mut state, mut ws) = (State::new(scene), Workspace::new(scene));
    let mut observer = Observer::new(scene);
    observer.residual_every = 10;
    let mut out = tick(scene, &mut state, &mut ws, &TickInput::IDLE, &mut NoProbe);
    let mut hand: Option<Hand> = None;
    let mut deepest = [f64::NEG_INFINITY; 3];
    let (mut on_wall, mut ticks) = (0.0_f64, 0);
    let tooth = scene::object(scene, "tooth 36");
    while !stroll.done() {
        let felt = out.tools[0].wrench;
        let target = stroll.step(tool, &felt, &out.tools[0]);
        let hand = hand.get_or_insert_with(|| Hand::new(HandParams::default(), target, 11));
        let mut input = TickInput::IDLE;
        input.tools = [present(&hand.step(&target, &felt)), ToolInput::ABSENT];
        out = tick(scene, &mut state, &mut ws, &input, &mut NoProbe);
        observer.observe(scene, &input, &out, &ws);
        if stroll.pressing {
            on_wall = on_wall.max(state.loads[tooth].force.norm());
        }
        ticks += 1;
        if ticks % 10 == 0 {
            for (deepest, (_, mesh)) in deepest.iter_mut().zip(&teeth) {
                *deepest = points.deepest_inside(mesh, &out.tools[0].graphic, *deepest);
            }
        }
        assert!(ticks < 40_000);
    }
    let m = observer.measures();
    println!("{ticks} ticks, {m:#?}");
    for reading in &stroll.readings {
        let bare = gingiva.margin_at(reading.around) - floor;
        let pressed = reading.floor_force / gingiva.params.floor_stiffness;
        println!(
            "{:.0} degrees: read {:.2} mm with {:.3} N on the floor; the meshes say {:.2} mm, the floor gives way by {:.2} mm",
            reading.around.to_degrees(),
            reading.depth * 1e3,
            reading.floor_force,
            bare * 1e3,
            pressed * 1e3
        );
        // By the data's own account it is 3.2 to 6.0 mm deep at rest.
        assert!((3.2e-3..=6.0e-3 + pressed).contains(&reading.depth));
        assert!((reading.depth - bare - pressed).abs() <= 0.3e-3);
        assert!(reading.floor_force > 0.05);
    }
    assert_eq!(stroll.readings.len(), 4);
    println!("{on_wall:.2} N on the tooth's wall");
    assert!(on_wall > 0.3);
    let surface = MeshDistance::new(probe.clone());
    for ((fdi, mesh), inside) in teeth.iter().zip(deepest) {
        let object = &scene.objects[scene::object(scene, &format!("tooth {fdi}"))];
        let most = allowed_inside((object, mesh), (tool, &surface));
        println!(
            "tooth {fdi}: deepest {:.4} mm inside, allowed {:.4} mm",
            inside * 1e3,
            most * 1e3
        );
        assert!(inside <= most, "tooth {fdi}: {inside:e} m inside");
    }
    // Narrower than the tip: the wall gave way.
    assert!(m.indentation > 5e-5, "{:e} m", m.indentation);
    let bounds = find("pocket-0.4").expect("in the table").bounds;
    let broken = bounds.broken(&m, 0.0);
    println!("{broken:#?}");
    assert!(broken.is_empty(), "{broken:#?}");
}

/// An explorer of the SOFA tutorial on tooth 36 alone: a tool from a mesh, one that no exercise uses.
#[test]
fn an_explorer_from_a_mesh_rests_on_the_crown_and_is_never_inside() {
    if !long::selected("real-arch-explored") {
        return;
    }
    let Some(scene) = scene::explorer() else {
        return;
    };
    let tooth = scene::mesh(scene::file_of(36)).expect("a tooth");
    let explorer = scene::mesh("dental_probe").expect("an explorer");
    let tool = &scene.tools[0];
    let near = |point: &Vec3| (point - tool.tip).norm() < 30e-3;
    let points = Points::of(explorer.mesh(), 3e-4, near);
    let (low, high) = tooth.mesh().bounds();
    let crown = Vec3::new(0.5 * (low.x + high.x), 0.5 * (low.y + high.y), high.z);
    let (mut state, mut ws) = (State::new(&scene), Workspace::new(&scene));
    let mut observer = Observer::new(&scene);
    observer.residual_every = 10;
    let (mut felt, mut deepest) = (Wrench::ZERO, f64::NEG_INFINITY);
    let pose = |t: f64| {
        // Down on the crown, 2 mm too deep, over it from side to side, up.
        let down = smoothstep(t) - smoothstep(t - 4.0);
        let across = 5e-3 * libm::sin(1.5 * (t - 1.0).clamp(0.0, 3.0));
        let tip = crown + Vec3::new(0.0, across, 5e-3 - 7e-3 * down);
        Pose::new(tip - tool.tip, sulcus_core::Quat::identity())
    };
    let mut hand = Hand::new(HandParams::default(), pose(0.0), 5);
    for k in 0..5000 {
        let mut input = TickInput::IDLE;
        input.tools[0] = present(&hand.step(&pose(f64::from(k) * 1e-3), &felt));
        let out = tick(&scene, &mut state, &mut ws, &input, &mut NoProbe);
        observer.observe(&scene, &input, &out, &ws);
        felt = out.tools[0].wrench;
        if k % 10 == 0 {
            deepest = points.deepest_inside(&tooth, &out.tools[0].graphic, deepest);
        }
    }
    let m = observer.measures();
    let object = &scene.objects[scene::object(&scene, "tooth 36")];
    let most = allowed_inside((object, &tooth), (tool, &explorer));
    println!(
        "explorer: deepest {:.3} mm inside, allowed {:.3} mm; {m:#?}",
        deepest * 1e3,
        most * 1e3
    );
    assert!(m.contact_ticks > 1000 && m.max_raw_force > 0.2);
    assert!(deepest <= most, "{deepest:e} m inside");
    assert!(m.residual <= 1e-6 && m.imbalance <= 1e-6 && m.solver_failed == 0 && m.buzz <= 3e-3);
}
