//! The real lower left arch, the parametric probe and mirror: what the meshes alone say of the pocket, and a probe in it.

mod scene;
mod stroll;
mod ways;

use sulcus_cases::inside::{deepest_inside, points_of};
use sulcus_cases::{Observer, find};
use sulcus_core::tissue::gingiva::Site;
use sulcus_core::{NoProbe, State, TickInput, ToolInput, Workspace, tick};
use sulcus_operator::{Hand, HandParams, present};
use sulcus_scene::blend::blend_error;
use sulcus_scene::distance::MeshDistance;
use sulcus_scene::error::level_error;
use sulcus_scene::parametric::Probe;

use stroll::Stroll;

/// Height of the pocket's floor in the data, metres: a plane.
const FLOOR: f64 = 1e-3;

#[test]
fn the_pocket_of_tooth_36_is_found_by_sounding_the_meshes() {
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

/// Most that the probe may be inside a tooth, metres: the stated errors of both trees at the level in contact.
fn allowed(scene: &sulcus_core::Scene, tooth: &MeshDistance, fdi: u8, tool: &MeshDistance) -> f64 {
    let object = &scene.objects[scene::object(scene, &format!("tooth {fdi}"))];
    let of_tooth = blend_error(&object.tree, object.level, tooth, 2.5e-4).max;
    let of_tool = level_error(&scene.tools[0].tree, scene.tools[0].level, tool).max_gap_mm;
    println!("tooth {fdi}: stated error {of_tooth:.4} mm, the tool's {of_tool:.4} mm");
    (of_tooth + of_tool) * 1e-3
}

#[test]
fn a_probe_opens_the_pocket_reads_walks_and_is_never_inside_a_tooth() {
    let Some(scene) = scene::scene() else { return };
    let teeth = [36, 35, 37].map(|fdi| (fdi, scene::mesh(scene::file_of(fdi)).expect("a tooth")));
    let meshes: Vec<&MeshDistance> = teeth.iter().map(|(_, mesh)| mesh).collect();
    let gingiva = scene::gingiva(scene);
    let floor = FLOOR - gingiva.tooth.origin.z;
    // Distobuccal, then buccally in steps of about a millimetre.
    let tissue = scene::mesh("gingiva_patch_36_pocket").expect("a gingiva");
    let site = ways::Site::new(scene, meshes.clone(), &tissue, floor);
    if std::env::var("SCAN").is_ok() {
        for degrees in (0..24).map(|k| 15.0 * f64::from(k)) { print!("{degrees}:"); site.descent(degrees); println!(" margin {:.2}", (gingiva.margin_at(degrees.to_radians()) - floor) * 1e3); }
        return;
    }
    let ways = [140.0, 131.0, 122.0, 113.0].map(|degrees| site.descent(degrees));
    for way in &ways {
        for k in 0..9 { let w = way.at(1e-3 * f64::from(k)); println!("{k} up {:.3?} tissue at tip {:.3}", w.up.as_slice(), tissue.signed(&(w.floor + w.up * 2.5e-4)) * 1e3); }
    }
    let probe = Probe::default().touching_mesh();
    let points = points_of(&probe, 1e-4);
    let tool = &scene.tools[0];

    {
        let g = &scene.objects[scene::object(scene, "gingiva 36")];
        let mut errs = Vec::new();
        for k in 0..128 { for h in 1..9 {
            let a = std::f64::consts::TAU * k as f64 / 128.0;
            let out = gingiva.tooth.mesial * a.cos() + gingiva.tooth.buccal * a.sin();
            let h = floor + 0.5e-3 * h as f64;
            if h > gingiva.margin_at(a) - 3e-4 { continue; }
            let mut along = 0.02;
            for _ in 0..200 { along -= meshes[0].signed(&(gingiva.tooth.origin + out * along + gingiva.tooth.axis * h)) - 2e-4; }
            let p = gingiva.tooth.origin + out * along + gingiva.tooth.axis * h;
            let by_mesh = tissue.signed(&p);
            let by_spheres = g.tree.shape_at(3).map(|(_, n)| (p - n.centre).norm() - n.contact_radius).fold(f64::INFINITY, f64::min);
            errs.push(((by_spheres - by_mesh) * 1e3, by_mesh * 1e3));
        }}
        errs.sort_by(|a, b| a.0.total_cmp(&b.0));
        let n = errs.len();
        println!("pocket wall: spheres minus mesh: {n} places, min {:.3?} 5% {:.3?} median {:.3?} 95% {:.3?} max {:.3?}; nodes {}", errs[0], errs[n/20], errs[n/2], errs[n-n/20], errs[n-1], g.tree.shape_at(3).count());
    }
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
        if ticks % 100 == 0 && std::env::var("TRACE").is_ok() {
            let tip = out.tools[0].graphic.transform(&tool.tip);
            let (around, height) = gingiva.tooth.cylindrical(&tip);
            let hand_tip = out.tools[0].haptic.transform(&tool.tip);
            let loads: Vec<f64> = state.loads.iter().map(|l| l.force.norm()).collect();
            println!("{ticks} around {:.1} over floor {:.3} mm (hand {:.3}), off tooth {:.3}, f {:.3} N {:?} loads {loads:.3?} {:?}", around.to_degrees(), (height - floor) * 1e3, (gingiva.tooth.cylindrical(&hand_tip).1 - floor) * 1e3, meshes[0].signed(&tip) * 1e3, out.tools[0].raw_wrench.force.norm(), out.tools[0].pocket.map(|p| p.floor_force), out.tools[0].converged);
        }
        if std::env::var("TRACE").is_ok() && (ticks == 3000 || ticks == 6000 || ticks == 8100) {
            for (c, l) in ws.contacts().filter(|(_, l)| *l > 0.005) {
                let node = &scene.tools[0].tree.nodes()[c.tool_sphere as usize];
                let at = out.tools[0].graphic.transform(&node.centre);
                let o = &scene.objects[c.object as usize];
                let on = &o.tree.nodes()[c.object_sphere as usize];
                println!("   {} load {l:.3} normal {:.2?} tool r {:.3} at over floor {:.2}; sphere r {:.3} centre over floor {:.2} off tooth {:.3}, its mesh err {:.3}", o.name, c.normal.as_slice(), node.contact_radius*1e3, (gingiva.tooth.cylindrical(&at).1-floor)*1e3, on.contact_radius*1e3, (gingiva.tooth.cylindrical(&on.centre).1-floor)*1e3, meshes[0].signed(&on.centre)*1e3, (on.contact_radius + tissue.signed(&on.centre))*1e3);
            }
        }
        if ticks % 5 == 0 && false && out.tools[0].converged {
            for (deepest, (_, mesh)) in deepest.iter_mut().zip(&teeth) {
                let inside = deepest_inside(mesh, &points, &out.tools[0].graphic);
                *deepest = deepest.max(inside);
            }
        }
        assert!(ticks < 40_000);
    }
    let m = observer.measures();
    println!("{ticks} ticks, {m:#?}");
    let sink = gingiva.params.sink();
    for reading in &stroll.readings {
        let margin = gingiva.margin_at(reading.around);
        let prescribed = margin - floor + sink;
        println!(
            "{:.0} degrees: read {:.2} mm at {:.3} N on the floor, {:.2} mm by the meshes",
            reading.around.to_degrees(),
            reading.depth * 1e3,
            reading.floor_force,
            prescribed * 1e3
        );
        assert!((3.2e-3..=6.0e-3 + sink).contains(&reading.depth));
        assert!((reading.depth - prescribed).abs() <= 0.3e-3);
    }
    assert_eq!(stroll.readings.len(), 4);
    println!("{on_wall:.2} N on the tooth's wall");
    assert!(on_wall > 0.3);
    for ((fdi, mesh), inside) in teeth.iter().zip(deepest) {
        let most = allowed(scene, mesh, *fdi, &MeshDistance::new(probe.clone()));
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
    assert!(broken.is_empty(), "{broken:#?}");
}
