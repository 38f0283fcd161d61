//! Instruments of a display, and teeth whose mesh is their own.

use sulcus_core::{Scene, Vec3};
use sulcus_display::Display;
use sulcus_proto::display::{DisplayTool, Kind};
use sulcus_scene::anatomy::patient::{Patient, ToothChart};
use sulcus_scene::{BuildOptions, BuiltIn, compile_built_in};

use crate::common::compiled;

/// Largest number of triangles of an instrument.
const TRIANGLES: usize = 9_000;

fn two_tools() -> (Scene, Display) {
    let mut patient = Patient::healthy("one");
    patient.teeth = vec![ToothChart::healthy(37)];
    let scene = compiled(&patient, &[37]);
    let display = Display::new(&scene).expect("a display");
    (scene, display)
}

/// Vertices with distance from the tip along the working end, mm, roughness and brightness.
fn along(tool: &DisplayTool) -> Vec<(f64, f64, u8)> {
    let at = |v: [f32; 3]| Vec3::from(v.map(f64::from));
    let (tip, axis) = (at(tool.tip), -at(tool.tip_axis));
    let finishes = tool.mesh.finishes.iter();
    let rows = tool
        .mesh
        .vertices()
        .zip(&tool.mesh.vertex_colours)
        .zip(finishes);
    rows.map(|((v, colour), finish)| {
        let s = (at(v) - tip).dot(&axis) * 1e3;
        (s, f64::from(finish.roughness) / 255.0, colour[1])
    })
    .collect()
}

#[test]
fn instruments_have_few_triangles_and_a_finish_at_each_vertex() {
    let (scene, display) = two_tools();
    for (tool, shown) in scene.tools.iter().zip(&display.scene().tools) {
        let counts = [tool.mesh.triangles.len(), shown.mesh.triangles().count()];
        println!("{}: {counts:?} triangles", tool.name);
        assert!(counts[1] < counts[0] && counts[1] <= TRIANGLES);
        assert_eq!(shown.mesh.finishes.len(), shown.mesh.len());
        // Steel: the screen tells metal by a finish that lets no light through.
        assert!(shown.mesh.finishes.iter().all(|finish| finish.thin == 0));
        let rough = |wanted: f64| {
            let near = |finish: &&sulcus_proto::display::Finish| {
                (f64::from(finish.roughness) / 255.0 - wanted).abs() < 0.005
            };
            shown.mesh.finishes.iter().filter(near).count()
        };
        assert!(rough(0.12) > 100 && rough(0.28) > 100 && rough(0.40) > 500);
        let is_probe = !tool.bands.is_empty();
        assert_eq!(rough(0.60) > 100, is_probe, "black bands");
        assert_eq!(rough(0.10) > 100, !is_probe, "the mirror's rim");
    }
}

#[test]
fn black_bands_are_matt_between_their_marks_with_sharp_edges() {
    let (scene, display) = two_tools();
    let probe = &display.scene().tools[0];
    let rows: Vec<(f64, f64, u8)> = along(probe)
        .into_iter()
        .filter(|row| row.0 < 15.5)
        .collect();
    for band in scene.tools[0].bands.iter().filter(|band| band.dark) {
        for (edge, inwards) in [(band.from * 1e3, 1.0), (band.to * 1e3, -1.0)] {
            // The nearest vertices on both sides of an edge.
            let side = |way: f64| {
                let on_side = rows.iter().filter(|row| (row.0 - edge) * way > 0.0);
                let away = |row: &&(f64, f64, u8)| (row.0 - edge).abs();
                *on_side
                    .min_by(|a, b| away(a).total_cmp(&away(b)))
                    .expect("a vertex")
            };
            let (inside, outside) = (side(inwards), side(-inwards));
            assert!(
                (inside.0 - outside.0).abs() <= 0.05,
                "{inside:?} {outside:?}"
            );
            assert!(
                (inside.1 - 0.6).abs() < 0.005 && inside.2 < 45,
                "{inside:?}"
            );
            assert!(outside.1 < 0.2 && outside.2 > 150, "{outside:?}");
        }
        let dark = rows.iter().filter(|row| row.2 < 45);
        assert!(
            dark.filter(|row| row.0 > band.from * 1e3 && row.0 < band.to * 1e3)
                .count()
                > 28
        );
    }
}

#[test]
fn the_working_end_is_drawn_where_it_touches() {
    let (scene, display) = two_tools();
    for (tool, shown) in scene.tools.iter().zip(&display.scene().tools) {
        let near = |v: &Vec3| (v - tool.tip).norm() < 15e-3;
        let own: Vec<Vec3> = shown
            .mesh
            .vertices()
            .map(|v| Vec3::from(v.map(f64::from)))
            .collect();
        let compiled = tool.mesh.vertices.iter();
        let compiled: Vec<Vec3> = compiled.map(|v| Vec3::from(v.map(f64::from))).collect();
        // Every drawn vertex is one of the compiled mesh, or lies in its flat faces at the rim of the glass.
        let glass = shown
            .glass
            .map(|glass| Vec3::from(glass.centre.map(f64::from)));
        for v in own.iter().filter(|v| near(v)) {
            let off = compiled.iter().map(|c| (c - v).norm());
            let off = off.fold(f64::INFINITY, f64::min);
            let is_rim = glass.is_some_and(|centre| ((v - centre).norm() - 10.4e-3).abs() < 2e-5);
            assert!(off < 3e-6 || is_rim, "{}: {off}", tool.name);
        }
    }
}

#[test]
fn a_tooth_of_its_own_mesh_keeps_its_colour_and_has_a_finish() {
    let options = BuildOptions::cached();
    let scene = compile_built_in(BuiltIn::Crown, &options, &|_, _| ())
        .expect("a scene")
        .scene;
    let display = Display::new(&scene).expect("a display");
    let objects = scene.objects.iter().zip(&display.scene().objects);
    let mut teeth = 0;
    for (object, shown) in objects.filter(|(_, shown)| shown.kind == Kind::Tooth) {
        teeth += 1;
        assert_eq!(shown.mesh.colour, object.mesh.colour);
        assert!(shown.mesh.vertex_colours.is_empty());
        assert_eq!(shown.mesh.len(), object.mesh.vertices.len());
        assert_eq!(shown.mesh.finishes.len(), shown.mesh.len());
        assert!(
            shown
                .mesh
                .finishes
                .iter()
                .all(|finish| finish.roughness > 15)
        );
    }
    assert!(teeth > 0);
}
