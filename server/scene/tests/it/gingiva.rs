//! The gingiva of one molar: a solid with a pocket of the requested width and depths, its tree, its scene file.

use std::path::Path;
use std::sync::OnceLock;

use sulcus_core::tissue::TissueModel;
use sulcus_core::tissue::gingiva::Gingiva;
use sulcus_core::{Object, Scene, Vec3};
use sulcus_scene::BuiltIn;
use sulcus_scene::anatomy::molar_gingiva::SITES_DEG;
use sulcus_scene::anatomy::{Molar, MolarCollar, Pocket};
use sulcus_scene::file::{FileError, parse};
use sulcus_scene::mesh::check::check;
use sulcus_scene::mesh::distance::MeshDistance;
use sulcus_scene::{BuildOptions, compile_file};

/// The shipped scene, built once for all tests.
fn scene() -> &'static Scene {
    static SCENE: OnceLock<Scene> = OnceLock::new();
    SCENE.get_or_init(|| {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/pocket.toml");
        compile_file(&file, &BuildOptions::cached(), &|_, _| ())
            .expect("the shipped scene")
            .scene
    })
}

fn gingiva(object: &Object) -> &Gingiva {
    match &object.tissue {
        TissueModel::Gingiva(model) => model,
        other => panic!("{other:?}"),
    }
}

/// The molar of the shipped scene.
fn tooth() -> &'static MeshDistance {
    static TOOTH: OnceLock<MeshDistance> = OnceLock::new();
    TOOTH.get_or_init(|| MeshDistance::new(Molar::default().mesh()))
}

/// A point in the middle of the pocket, `above` metres over the floor at `around`.
fn in_pocket(collar: &MolarCollar<'_>, width: f64, around: f64, above: f64) -> Vec3 {
    let height = collar.floor(around) + above;
    let at = |radius: f64| {
        Vec3::new(
            radius * libm::cos(around),
            radius * libm::sin(around),
            height,
        )
    };
    let (mut low, mut high) = (2e-3, 9e-3);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if tooth().signed(&at(middle)) < 0.5 * width {
            low = middle;
        } else {
            high = middle;
        }
    }
    at(low)
}

#[test]
fn the_collar_is_a_solid_with_a_pocket_of_the_width_asked_for() {
    for width_mm in [0.4, 0.8] {
        let pocket = Pocket {
            width_mm,
            ..Pocket::default()
        };
        let collar = MolarCollar::new(&pocket, tooth(), 4.5e-4);
        let mesh = collar.mesh();
        let report = check(&mesh, "gingiva").expect("a solid");
        assert_eq!(report.genus, 1, "a ring: {report:?}");
        let surface = MeshDistance::new(mesh);
        for k in 0..72 {
            let around = f64::from(k).to_radians() * 5.0;
            for above in [5e-4, 8e-4] {
                let p = in_pocket(&collar, width_mm * 1e-3, around, above);
                let free = surface.signed(&p);
                // Half way along the radius is slightly less than half way across where the tooth bends.
                assert!(
                    (-2e-5..5e-5).contains(&(free - 0.5e-3 * width_mm)),
                    "{around}: {free:e} m at {above} m over the floor"
                );
            }
            // Tissue lies under the floor.
            let under = in_pocket(&collar, width_mm * 1e-3, around, -3e-4);
            assert!(surface.signed(&under) < -2e-4, "{around}");
        }
    }
}

#[test]
fn depths_are_those_of_the_sites_and_run_smoothly_between() {
    let pocket = Pocket {
        depths_mm: [2.0, 3.0, 4.0, 5.0, 6.0, 7.0],
        ..Pocket::default()
    };
    let collar = MolarCollar::new(&pocket, tooth(), 4.5e-4);
    for (degrees, depth_mm) in SITES_DEG.iter().zip(&pocket.depths_mm) {
        assert!((collar.depth(degrees.to_radians()) * 1e3 - depth_mm).abs() < 1e-9);
        assert!((collar.depth((degrees - 360.0).to_radians()) * 1e3 - depth_mm).abs() < 1e-9);
    }
    let mut last = collar.floor(0.0);
    for k in 1..=3600 {
        let around = f64::from(k).to_radians() * 0.1;
        let floor = collar.floor(around);
        // The steepest is from 7 to 2 mm over 70 degrees.
        assert!((floor - last).abs() < 2.5e-5, "{around}");
        last = floor;
        assert!((2.0..=7.0).contains(&(collar.depth(around) * 1e3)));
    }
}

#[test]
fn the_model_knows_margin_floor_and_the_way_out() {
    let object = &scene().objects[1];
    let model = gingiva(object);
    let written = parse(BuiltIn::Pocket.text(), Path::new("pocket.toml")).expect("good");
    let pocket = written.objects[1].pocket.clone().expect("given");
    let collar = MolarCollar::new(&pocket, tooth(), model.params.sink());
    for k in 0..360 {
        let around = f64::from(k).to_radians();
        // From the margin down to the floor at rest is the prescribed depth less the sink.
        let depth = model.margin_at(around) - collar.floor(around);
        let wanted = collar.depth(around) - model.params.sink();
        assert!(
            (depth - wanted).abs() < 3e-5,
            "{around}: {depth:e} m, not {wanted:e}"
        );
    }
    let leaves: Vec<u32> = object.tree.shape_at(3).map(|(id, _)| id).collect();
    let floors = leaves.iter().filter(|&&id| model.places[id as usize].floor);
    let (mut floor, mut walls) = (0, 0);
    for &id in floors {
        let place = &model.places[id as usize];
        assert!(
            place.height < 3e-4 && (place.floor || place.height >= 0.0),
            "{place:?}"
        );
        floor += 1;
    }
    for &id in &leaves {
        let (node, place) = (
            &object.tree.nodes()[id as usize],
            &model.places[id as usize],
        );
        let clear = tooth().signed(&node.centre);
        if place.height > 3e-4 {
            walls += 1;
            // A step along `away` leaves the tooth.
            let on = tooth().signed(&(node.centre + place.away * 1e-4));
            assert!(on > clear + 5e-5, "{place:?}");
        }
    }
    println!(
        "{} spheres, {floor} of the floor, {walls} of the walls",
        leaves.len()
    );
    assert!(floor >= 30 && walls >= 200, "{floor} {walls}");
}

#[test]
fn tooth_and_gingiva_do_not_overlap_in_the_open_pocket() {
    let [tooth, collar] = &scene().objects[..] else {
        panic!("two objects")
    };
    let model = gingiva(collar);
    let mut least = f64::INFINITY;
    for (id, a) in collar.tree.shape_at(collar.level) {
        let place = &model.places[id as usize];
        // Attached tissue overlaps its tooth.
        if place.floor || place.height < 4e-4 {
            continue;
        }
        for (_, b) in tooth.tree.shape_at(tooth.level) {
            let gap = (a.centre - b.centre).norm() - a.contact_radius - b.contact_radius;
            least = if gap < least { gap } else { least };
        }
    }
    println!("least free width {:.3} mm", least * 1e3);
    assert!(least > 0.2e-3, "{least:e} m");
}

fn message(text: &str) -> String {
    let error: FileError = parse(text, Path::new("my.toml")).expect_err("refused");
    error.to_string()
}

#[test]
fn a_gingiva_that_cannot_stand_is_refused_in_one_sentence() {
    let with = |from: &str, to: &str| message(&BuiltIn::Pocket.text().replace(from, to));
    assert_eq!(
        with("tooth = \"tooth 36\"", "tooth = \"tooth 37\""),
        "my.toml: `tooth` of object `gingiva 36` is \"tooth 37\", expected the name of an object of kind \"molar\""
    );
    assert!(
        with("tooth = \"tooth 36\"\n", "").contains("`tooth` of object `gingiva 36` is missing")
    );
    assert!(with("tissue = \"gingiva\"", "tissue = \"rigid\"").contains("`tissue` of object"));
    assert!(with("width_mm = 0.4", "width_mm = 0.1").contains("`pocket.width_mm` of object"));
    assert!(with("[3.0, 2.0,", "[3.0, nan,").contains("NaN, expected 1.5 to 8 mm each"));
    assert!(with("inflammation = 0.0", "inflammation = 2.0").contains("`gingiva.inflammation`"));
    assert!(
        with("inflammation = 0.0", "inflamation = 1.0").contains("unknown field `inflamation`")
    );
    assert!(
        with("kind = \"molar\"", "kind = \"molar\"\ntooth = \"x\"")
            .contains("expected nothing without tissue = \"gingiva\"")
    );
}
