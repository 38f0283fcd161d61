//! Gingivae that are meshes: the sounded sulcus, and its keys in a scene file.

use std::fs;
use std::path::Path;

use sulcus_core::tissue::TissueModel;
use sulcus_core::tissue::gingiva::Site;
use sulcus_scene::anatomy::sulcus::{Sounded, SulcusError};
use sulcus_scene::anatomy::{Molar, MolarCollar, Pocket};
use sulcus_scene::file::{FileError, SulcusEntry, parse};
use sulcus_scene::mesh::TriMesh;
use sulcus_scene::mesh::distance::MeshDistance;
use sulcus_scene::mesh::load::to_stl;
use sulcus_scene::{BuildOptions, compile_file};

/// Height of a drawn floor over the prescribed depth, metres.
const SINK: f64 = 4.5e-4;

fn drawn(pocket: &Pocket) -> (MeshDistance, TriMesh) {
    let tooth = MeshDistance::new(Molar::default().mesh());
    let mesh = MolarCollar::new(pocket, &tooth, SINK).mesh();
    (tooth, mesh)
}

#[test]
fn sounding_finds_the_floor_the_width_and_the_depths_that_were_drawn() {
    let pocket = Pocket {
        depths_mm: [3.0, 2.0, 3.0, 4.0, 2.5, 3.5],
        ..Pocket::default()
    };
    let (tooth, mesh) = drawn(&pocket);
    let collar = MolarCollar::new(&pocket, &tooth, SINK);
    let given = SulcusEntry {
        origin_mm: Some([0.0; 3]),
        proximal_deg: 80.0,
        ..SulcusEntry::default()
    };
    let found = Sounded::new(&tooth, &MeshDistance::new(mesh.clone()), 36, &given).expect("found");
    let mut worst: f64 = 0.0;
    for k in 0..360 {
        let around = f64::from(k).to_radians();
        let off = found.floor_at(around) - collar.floor(around);
        assert!(off.abs() < 0.05e-3, "{k} degrees: {off:e} m");
        worst = worst.max(off.abs());
    }
    println!(
        "width {:.3} mm, floor within {:.3} mm",
        found.width * 1e3,
        worst * 1e3
    );
    assert!((found.width - 4e-4).abs() < 0.03e-3, "{:e} m", found.width);
    let proximal = given.proximal_deg.to_radians();
    let sites = found.charted(proximal, SINK, false);
    for (site, charted) in Site::ALL.into_iter().zip(sites) {
        // The drawn floor is deepest somewhere in the site's zone, not always in its middle.
        let angles = (0..3600).map(|k| f64::from(k).to_radians() * 0.1);
        let zone = angles.filter(|around| Site::at(*around, proximal) == site);
        let drawn = zone.fold(0.0, |deep: f64, around| deep.max(collar.depth(around)));
        println!(
            "{}: {:.2} mm, drawn {:.2} mm",
            site.name(),
            charted.depth * 1e3,
            drawn * 1e3
        );
        assert!((charted.depth - drawn).abs() < 0.1e-3);
    }
    // Sounding also works without given values: the frame moves to the middle of the tooth and down from its margin.
    let alone = Sounded::new(
        &tooth,
        &MeshDistance::new(mesh),
        36,
        &SulcusEntry::default(),
    );
    let alone = alone.expect("found");
    assert!(alone.frame.origin.x.hypot(alone.frame.origin.y) < 1e-3);
    assert!(
        (alone.margin[32] - 2e-3).abs() < 1e-5,
        "2 mm over the junction"
    );
    let deepest = |of: &Sounded| {
        let depths = of.margin.iter().zip(&of.floor).map(|(m, f)| m - f);
        depths.fold(0.0, f64::max)
    };
    assert!((deepest(&alone) - deepest(&found)).abs() < 0.1e-3);
}

#[test]
fn frames_follow_the_quadrant() {
    let (tooth, mesh) = drawn(&Pocket::default());
    let mesh = MeshDistance::new(mesh);
    let given = SulcusEntry {
        origin_mm: Some([0.0; 3]),
        floor_mm: Some(-2.0),
        width_mm: Some(0.4),
        ..SulcusEntry::default()
    };
    let frame = |fdi| {
        Sounded::new(&tooth, &mesh, fdi, &given)
            .expect("found")
            .frame
    };
    let [x, y, z] = [0, 1, 2].map(|k| sulcus_core::Vec3::ith(k, 1.0));
    for (fdi, mesial, buccal) in [(36, x, y), (46, x, -y), (31, -y, x), (41, y, x)] {
        let frame = frame(fdi);
        assert!((frame.axis - z).norm() < 1e-12);
        assert!((frame.mesial - mesial).norm() < 1e-12, "{fdi}: {frame:?}");
        assert!((frame.buccal - buccal).norm() < 1e-12, "{fdi}: {frame:?}");
    }
}

#[test]
fn what_has_no_sulcus_is_refused_in_words() {
    let (tooth, mesh) = drawn(&Pocket::default());
    let away = MeshDistance::new(
        mesh.clone()
            .placed(1.0, sulcus_core::Vec3::new(0.1, 0.0, 0.0)),
    );
    let error = Sounded::new(&tooth, &away, 36, &SulcusEntry::default()).expect_err("far away");
    assert!(matches!(error, SulcusError::NoMargin { .. }), "{error}");
    assert!(error.to_string().contains("no tissue within 1.5 mm"));
}

fn scene(dir: &Path) -> String {
    let pocket = Pocket::default();
    let (tooth, mesh) = drawn(&pocket);
    fs::write(dir.join("tooth.stl"), to_stl(tooth.mesh())).expect("written");
    fs::write(dir.join("gingiva.stl"), to_stl(&mesh)).expect("written");
    r#"
name = "two meshes"
[[tool]]
name = "probe"
kind = "periodontal_probe"
levels = 2
level = 2
park_mm = [20, 10, 115]
[[object]]
name = "tooth"
fdi = 36
mesh = "tooth.stl"
unit = "mm"
levels = 2
level = 2
translate_mm = [20, 10, 0]
[[object]]
name = "gum"
mesh = "gingiva.stl"
unit = "mm"
levels = 2
level = 2
translate_mm = [20, 10, 0]
tooth = "tooth"
tissue = "gingiva"
sulcus = { proximal_deg = 60 }
"#
    .to_owned()
}

#[test]
fn a_gingiva_from_a_mesh_yields_round_a_tooth_from_a_mesh() {
    let dir = tempfile::tempdir().expect("temporary directory");
    let file = dir.path().join("scene.toml");
    fs::write(&file, scene(dir.path())).expect("written");
    let compiled = compile_file(&file, &BuildOptions::default(), &|_, _| ()).expect("a scene");
    let gum = &compiled.scene.objects[1];
    assert_eq!(gum.fdi, 36, "its tooth's");
    let TissueModel::Gingiva(model) = &gum.tissue else {
        panic!("{:?}", gum.tissue)
    };
    assert!(
        (model.tooth.origin.x - 0.02).abs() < 1e-3 && (model.tooth.origin.y - 0.01).abs() < 1e-3
    );
    assert!((model.proximal.to_degrees() - 60.0).abs() < 1e-9);
    assert!(model.places.iter().filter(|place| place.floor).count() > 10);
    for site in Site::ALL {
        let depth = model.prescribed(site).depth;
        assert!(
            (1.8e-3..3.4e-3).contains(&depth),
            "{}: {depth:e}",
            site.name()
        );
    }
    let mesh = &gum.mesh;
    assert_eq!(gum.carriers.len(), mesh.vertices.len());
}

#[test]
fn keys_that_do_not_fit_are_named() {
    let dir = tempfile::tempdir().expect("temporary directory");
    let good = scene(dir.path());
    let message = |from: &str, to: &str| {
        assert!(good.contains(from), "{from}");
        let error: FileError =
            parse(&good.replace(from, to), Path::new("my.toml")).expect_err("refused");
        error.to_string()
    };
    for (from, to, said) in [
        (
            "tooth = \"tooth\"\n",
            "",
            "`tooth` of object `gum` is missing",
        ),
        (
            "tooth = \"tooth\"\n",
            "tooth = \"gum\"\n",
            "or of a rigid mesh",
        ),
        (
            "proximal_deg = 60",
            "proximal_deg = 5",
            "`sulcus.proximal_deg` of object `gum` is 5, expected 20 to 80 degrees",
        ),
        (
            "proximal_deg = 60",
            "axis = [0, 0, 0]",
            "a direction that is not zero",
        ),
        (
            "proximal_deg = 60",
            "open_mm = 3",
            "`sulcus.open_mm` of object `gum` is 3",
        ),
        ("proximal_deg = 60", "depth = 3", "unknown field `depth`"),
        (
            "sulcus = {",
            "pocket = { width_mm = 0.4 } #",
            "`pocket` of object `gum` is given, expected nothing without kind",
        ),
        (
            "tissue = \"gingiva\"",
            "tissue = \"rigid\"",
            "`tooth` of object `gum` is given, expected nothing without tissue",
        ),
    ] {
        let found = message(from, to);
        assert!(found.contains(said), "{found}");
    }
}
