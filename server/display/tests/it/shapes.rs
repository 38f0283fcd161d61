//! Shapes of a display: as near to the simulated ones as an eye can tell.

use std::collections::BTreeSet;

use sulcus_core::tissue::TissueModel;
use sulcus_core::{NoProbe, Pose, Quat, Scene, State, TickInput, ToolInput, Vec3, Workspace, tick};
use sulcus_display::{Display, Frames};
use sulcus_proto::display::{DisplayFrame, DisplayMesh, DisplayObject, HANDLES, Kind};
use sulcus_scene::anatomy::patient::LOWER;
use sulcus_scene::{BuildOptions, BuiltIn, compile_built_in};
use sulcus_sessions::{Moved, Sampler, Shapes};

use crate::common::{any_patient, compiled};

fn built_in(which: BuiltIn) -> Scene {
    let options = BuildOptions::cached();
    compile_built_in(which, &options, &|_, _| ())
        .expect("a scene")
        .scene
}

/// Vertices of a displayed object at a frame, metres.
fn vertices(object: &DisplayObject, k: usize, frame: &DisplayFrame) -> Vec<Vec3> {
    let skin = object.skin.as_ref().expect("a skin");
    let mut handles = vec![[0.0; 3]; skin.handles.len()];
    for moved in frame
        .moved
        .iter()
        .filter(|moved| usize::from(moved.object) == k)
    {
        for handle in &moved.handles {
            handles[usize::from(handle.handle)] = handle.by_m();
        }
    }
    let mut by = vec![[0.0; 3]; object.mesh.len()];
    skin.displacements(&handles, &mut by);
    let place = |(v, by): ([f32; 3], &[f32; 3])| {
        Vec3::from(v.map(f64::from)) + Vec3::from(by.map(f64::from))
    };
    object.mesh.vertices().zip(&by).map(place).collect()
}

/// Vertices of a mesh, metres.
fn places(mesh: &DisplayMesh) -> Vec<Vec3> {
    mesh.vertices()
        .map(|v| Vec3::from(v.map(f64::from)))
        .collect()
}

/// Moves tool 0 along `way` (a unit vector) from 8 mm before `tip` to `beyond` behind it. Returns the workspace and the
/// frame.
fn pressed(
    scene: &Scene,
    display: &Display,
    (tip, way): (Vec3, Vec3),
    beyond: f64,
) -> (Workspace, DisplayFrame) {
    let tool = &scene.tools[0];
    let turn = Quat::rotation_between(&tool.tip_axis, &way).unwrap_or(Quat::identity());
    let pose = |along: f64| {
        let at = tip + way * along;
        Pose::new(at - turn * tool.tip, turn)
    };
    let (mut state, mut workspace) = (State::new(scene), Workspace::new(scene));
    let mut sampler = Sampler::new(scene);
    let mut shapes = Shapes::new(scene);
    let (mut moved, mut frames) = (Moved::new(scene), Frames::new(scene, display));
    let mut newest = None;
    let (from, to) = (-8e-3, beyond);
    let ticks = 1600;
    for k in 0..=ticks {
        let share = (f64::from(k) / 1200.0).min(1.0);
        let mut input = TickInput::IDLE;
        input.tools[0] = ToolInput::at(&pose(from + (to - from) * share));
        let output = tick(scene, &mut state, &mut workspace, &input, &mut NoProbe);
        if sampler.is_due(output.tick) {
            sampler.read(output.tick, &workspace, &mut shapes);
            moved.follow(&shapes);
            assert!(frames.is_due(output.tick));
            newest = Some(frames.frame(display, &output, false, &moved));
            if output.tick == 1600 {
                break;
            }
        }
    }
    (workspace, newest.expect("a frame"))
}

#[test]
fn the_drawn_margin_is_the_patients() {
    for seed in [1, 2, 3, 4, 5, 7] {
        let scene = compiled(&any_patient(seed), &[31, 33, 34, 36, 37, 46]);
        let display = Display::new(&scene).expect("a display");
        let all = &display.scene().objects;
        let shared = |own: &DisplayObject, at: &Vec3| {
            let others = all.iter().filter(|object| !std::ptr::eq(*object, own));
            let mut vertices = others.flat_map(|object| object.mesh.vertices());
            vertices.any(|v| (Vec3::from(v.map(f64::from)) - at).norm() < 5e-6)
        };
        let mut worst: f64 = 0.0;
        for (object, shown) in scene.objects.iter().zip(all) {
            let TissueModel::Gingiva(model) = &object.tissue else {
                continue;
            };
            // The border of the mesh that no other mesh shares: the margin. Away from the papillae.
            let vertices: Vec<Vec3> = places(&shown.mesh);
            let mut edges = BTreeSet::new();
            for [a, b, c] in shown.mesh.triangles() {
                edges.extend([(a, b), (b, c), (c, a)]);
            }
            let border = edges.iter().filter(|(a, b)| !edges.contains(&(*b, *a)));
            let mut count = 0;
            for (a, _) in border {
                let (around, height) = model.tooth.cylindrical(&vertices[*a as usize]);
                let off = (height - model.margin_at(around)).abs();
                if around.sin().abs() > 0.75 && off < 1e-3 && !shared(shown, &vertices[*a as usize])
                {
                    worst = worst.max(off);
                    count += 1;
                }
            }
            assert!(count > 10, "{count} vertices of the margin");
            for (k, site) in shown.sites.iter().enumerate() {
                let at = Vec3::from(site.map(f64::from));
                let (around, height) = model.tooth.cylindrical(&at);
                let off = (height - model.margin_at(around)).abs();
                assert!(
                    off < 0.2e-3,
                    "site {k} of {}: {:.3} mm",
                    object.fdi,
                    off * 1e3
                );
                let nearest = shown
                    .mesh
                    .vertices()
                    .map(|v| (Vec3::from(v.map(f64::from)) - at).norm());
                assert!(nearest.fold(f64::INFINITY, f64::min) < 1e-3);
            }
        }
        // Pockets of up to 7 mm; shallow ones differ by less than 0.1 mm, as tests of the sheet show.
        assert!(worst < 0.3e-3, "{:.3} mm", worst * 1e3);
    }
}

#[test]
fn soft_tissues_are_coloured_and_few_triangles() {
    let scene = compiled(&any_patient(5), &LOWER);
    let display = Display::new(&scene).expect("a display");
    let mut triangles = 0;
    for object in &display.scene().objects {
        if !matches!(object.kind, Kind::Gingiva | Kind::Mucosa) {
            continue;
        }
        triangles += object.mesh.triangles().count();
        assert_eq!(object.mesh.vertex_colours.len(), object.mesh.len());
        assert_eq!(object.mesh.finishes.len(), object.mesh.len());
    }
    assert!(triangles < 31_397, "{triangles} triangles");
    // Vertices on a cut are in two objects, at the same place but for the rounding of both.
    let of = |fdi: u8| {
        let mut all = display.scene().objects.iter();
        let found = all.find(|object| object.kind == Kind::Gingiva && object.fdi == fdi);
        let vertices = found.expect("there").mesh.vertices();
        vertices
            .map(|v| Vec3::from(v.map(f64::from)))
            .collect::<Vec<Vec3>>()
    };
    let (a, b) = (of(31), of(32));
    let welded = |v: &&Vec3| b.iter().any(|other| (*v - other).norm() < 5e-6);
    assert!(a.iter().filter(welded).count() >= 30);
}

#[test]
fn every_yielding_object_has_a_skin_within_the_limits() {
    for which in BuiltIn::ALL {
        let scene = built_in(which);
        let display = Display::new(&scene).expect("a display");
        for (object, shown) in scene.objects.iter().zip(&display.scene().objects) {
            assert_eq!(
                object.tissue.is_rigid(),
                shown.skin.is_none(),
                "{}",
                object.name
            );
            // The gingiva of a scene file has no number of its own; a screen shows it with its tooth's.
            let is_its_tooths = object.fdi == 0 && shown.kind == Kind::Gingiva && shown.fdi == 36;
            assert!(object.fdi == shown.fdi || is_its_tooths, "{}", object.name);
            assert!(shown.mesh.len() > 100, "{}", object.name);
            let Some(skin) = &shown.skin else { continue };
            assert!(
                (32..=HANDLES).contains(&skin.handles.len()),
                "{}",
                object.name
            );
            for v in 0..skin.vertices() {
                let sum: f32 = skin.carriers(v).map(|(_, weight)| weight).sum();
                let whole = (-0.01..1.01).contains(&sum);
                assert!(whole, "{}: vertex {v} has weights of {sum}", object.name);
            }
        }
        assert!(display.scene().tools[0].mesh.len() > 100);
    }
}

#[test]
fn a_pressed_tongue_is_drawn_where_it_is() {
    for which in [BuiltIn::Tongue, BuiltIn::Organ] {
        let scene = built_in(which);
        let display = Display::new(&scene).expect("a display");
        let object = &scene.objects[0];
        let top = object
            .mesh
            .vertices
            .iter()
            .max_by(|a, b| a[2].total_cmp(&b[2]));
        let tip = Vec3::from(top.expect("a vertex").map(f64::from));
        let (workspace, frame) = pressed(&scene, &display, (tip, -Vec3::z()), 3e-3);
        let skin = sulcus_core::DisplaySkin::of(object);
        let mut by = vec![Vec3::zeros(); skin.vertices()];
        skin.displacements(&workspace.carriers_moved(&scene, 0), &mut by);
        let most = by.iter().map(|by| by.norm()).fold(0.0, f64::max);
        assert!(most > 1e-3, "it gives way by {:.2} mm", most * 1e3);
        let drawn = vertices(&display.scene().objects[0], 0, &frame);
        let off = object
            .mesh
            .vertices
            .iter()
            .zip(&by)
            .zip(&drawn)
            .map(|((v, by), drawn)| (Vec3::from(v.map(f64::from)) + by - drawn).norm());
        let off = off.fold(0.0, f64::max);
        assert!(
            off < 0.01 * most + 5e-6,
            "{:.3} mm of {:.3}",
            off * 1e3,
            most * 1e3
        );
    }
}

#[test]
fn a_pressed_gingiva_gives_way_in_the_picture() {
    let scene = compiled(&any_patient(2), &[35, 36]);
    let display = Display::new(&scene).expect("a display");
    let (k, gingiva) = display
        .scene()
        .objects
        .iter()
        .enumerate()
        .find(|(_, object)| object.kind == Kind::Gingiva && object.fdi == 36)
        .expect("there");
    let site = Vec3::from(gingiva.sites[1].map(f64::from));
    // From the cheek against the outer face, a millimetre below the margin.
    let TissueModel::Gingiva(model) = &scene.objects[k].tissue else {
        panic!("a gingiva");
    };
    let place = (site - model.tooth.axis * 1e-3, -model.tooth.buccal);
    let (workspace, frame) = pressed(&scene, &display, place, 0.0);
    let carriers = workspace.carriers_moved(&scene, k);
    let most = carriers.iter().map(|by| by.norm()).fold(0.0, f64::max);
    let rest = DisplayFrame::default();
    let (at_rest, now) = (vertices(gingiva, k, &rest), vertices(gingiva, k, &frame));
    let moved = at_rest.iter().zip(&now).map(|(a, b)| (a - b).norm());
    let drawn = moved.fold(0.0, f64::max);
    assert!(most > 5e-5, "the probe presses");
    assert!(
        drawn > 0.3 * most && drawn < 1.3 * most,
        "{drawn} of {most}"
    );
    // Far from the probe nothing moves.
    for (a, b) in at_rest.iter().zip(&now) {
        assert!((a - site).norm() < 6e-3 || (a - b).norm() < 2e-5);
    }
}
