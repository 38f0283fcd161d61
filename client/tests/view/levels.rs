//! Work and looks of a whole mouth by level of quality. Times differ between machines; counts do not.

use std::path::Path;

use nalgebra::{UnitQuaternion, Vector3};
use sulcus_display::Display;
use sulcus_proto::display::{DisplayObject, DisplayScene, Kind, Spot};
use sulcus_scene::{BuildOptions, compile_file};
use sulcus_screen::gpu::{Backend, Drawing, Graphics, Image, Mode, Renderer};
use sulcus_screen::moment::Moment;
use sulcus_screen::quality::Quality;
use sulcus_screen::stage::Stage;
use sulcus_screen::views::View;
use sulcus_support::Resource;

use crate::display;

/// Size of a picture.
const SIZE: [u32; 2] = [1280, 720];
/// Tooth in the middle of the view.
const TOOTH: u8 = 36;
/// Distance of the glass from the middle of the view, mm.
const BEFORE_MM: f32 = 15.0;
/// Most triangles of a stage and of a picture with a mirror, and most calls of that picture. The times of the report
/// were measured with less.
const MOST: [(Quality, [usize; 3]); 2] = [
    (Quality::Low, [65_000, 65_000, 6]),
    (Quality::Lowest, [27_000, 25_000, 6]),
];

fn mouth() -> DisplayScene {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../server/scenes/mouth.toml");
    let options = BuildOptions {
        seed: Some(4),
        ..BuildOptions::cached()
    };
    let compiled = compile_file(&file, &options, &|_, _| ()).expect("a scene");
    let display = Display::new(&compiled.scene).expect("a display");
    display.scene().clone()
}

fn renderer(scene: &DisplayScene, quality: Quality) -> Option<Renderer> {
    let graphics = Graphics::headless(Backend::Any).map_err(|error| error.to_string());
    let graphics = Resource::Adapter.or_skip(graphics)?;
    let stage = Stage::new(scene, quality.looks().thinned_um);
    Some(Renderer::new(graphics, stage, quality, Mode::Beauty))
}

/// View of the tooth, and the instants without and with each mirror before it.
fn view(scene: &DisplayScene) -> (Drawing, Moment, Moment) {
    let rest = Moment::rest(scene);
    let aspect = f64::from(SIZE[0]) / f64::from(SIZE[1]);
    let camera = View::Buccal.camera(scene, &rest, Some(TOOTH), aspect);
    let middle = camera.middle().cast::<f32>();
    let to_eye = (camera.eye().cast::<f32>() - middle).normalize();
    let mut held = rest.clone();
    for (at, tool) in held.tools.iter_mut().zip(&scene.tools) {
        let Some(glass) = tool.glass else { continue };
        let normal = Vector3::from(glass.normal);
        at.held = true;
        at.orientation = UnitQuaternion::rotation_between(&normal, &to_eye).unwrap_or_default();
        let centre = at.orientation * Vector3::from(glass.centre) * 1e3;
        at.position = middle + to_eye * BEFORE_MM - centre;
    }
    (Drawing::through(camera), rest, held)
}

fn count(a: &Image, b: &Image, differs: impl Fn([u8; 4], [u8; 4]) -> bool) -> usize {
    let pixels = a.rgba.iter().zip(&b.rgba);
    pixels.filter(|(a, b)| differs(**a, **b)).count()
}

#[test]
fn cheap_levels_have_few_triangles_and_calls() {
    let _turn = display::turn();
    let scene = mouth();
    let (drawing, _, held) = view(&scene);
    for (quality, [most, drawn, draws]) in MOST {
        let Some(mut renderer) = renderer(&scene, quality) else {
            return;
        };
        renderer.unread(&drawing, &held, SIZE).expect("a picture");
        let (stage, work) = (renderer.stage().triangles(), renderer.work());
        println!("{quality:?}: {stage} triangles, {work:?}");
        assert!(stage <= most, "{quality:?}: {stage} triangles");
        assert!(
            work.triangles <= drawn && work.draws <= draws,
            "{quality:?}: {work:?}"
        );
    }
}

#[test]
fn every_level_shows_the_mirror_and_blood_in_a_whole_mouth() {
    let _turn = display::turn();
    let scene = mouth();
    let is_gingiva = |object: &DisplayObject| object.kind == Kind::Gingiva && object.fdi == TOOTH;
    let object = scene
        .objects
        .iter()
        .position(is_gingiva)
        .expect("a gingiva");
    let (mut drawing, rest, held) = view(&scene);
    // The shadow of the mirror, which the best levels alone have, is not the mirror.
    drawing.lamp.shadows_mm = 0.01;
    let spot = Spot {
        object: object as u16,
        site: 1,
        since: 0,
    };
    let bleeding = Moment {
        spots: vec![(spot, 6.0)],
        ..rest.clone()
    };
    let mut found = Vec::new();
    for quality in Quality::ALL {
        let Some(mut renderer) = renderer(&scene, quality) else {
            return;
        };
        let mut draw = |moment: &Moment| renderer.picture(&drawing, moment, SIZE);
        let [dry, bloody, glass] = [&rest, &bleeding, &held].map(|at| draw(at).expect("a picture"));
        let is_redder = |a: [u8; 4], b: [u8; 4]| i32::from(a[1]) - i32::from(b[1]) > 24;
        found.push((
            quality,
            count(&dry, &bloody, is_redder),
            count(&dry, &glass, |a, b| a != b),
        ));
    }
    println!("pixels of blood and of the mirror: {found:?}");
    let (_, blood, glass) = found[0];
    assert!(blood > 500 && glass > 50_000, "{found:?}");
    for (quality, own_blood, own_glass) in found {
        // Coarser meshes blur blood. No level loses half of it.
        assert!(
            2 * own_blood > blood && own_blood < 3 * blood,
            "{quality:?}: {own_blood} of {blood}"
        );
        assert!(
            10 * own_glass > 8 * glass,
            "{quality:?}: {own_glass} of {glass}"
        );
    }
}
