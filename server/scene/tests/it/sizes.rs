//! Sizes and units: a mesh of implausible size is refused, and the message names plausible units.

use std::path::Path;

use sulcus_core::Vec3;
use sulcus_scene::mesh::load::{Unit, to_stl};
use sulcus_scene::mesh::shapes::ellipsoid;
use sulcus_scene::mesh::size::Size;
use sulcus_scene::mesh::solid::{Reading, read_solid};
use sulcus_scene::{BuildOptions, compile_text};

use crate::ngons::input;

fn reading(unit: Unit, size: Size) -> Reading {
    Reading {
        size,
        ..unit.into()
    }
}

#[test]
fn a_tooth_in_inches_is_refused_and_read_in_its_unit() {
    let file = input("scan/inches.stl");
    for size in [Size::Mouth, Size::Tooth] {
        let said = read_solid(&file, reading(Unit::Millimetre, size))
            .expect_err("too small")
            .to_string();
        assert!(
            said.contains("found an overall size of 0.5") && said.contains("expected 4 to "),
            "{said}"
        );
        assert!(
            said.contains("in inches it would be 1")
                && said.contains("`--unit in`")
                && said.contains("`unit = \"in\"`"),
            "{said}"
        );
        assert!(said.contains("`--size any`"), "{said}");
    }
    let solid = read_solid(&file, reading(Unit::Inch, Size::Tooth)).expect("a tooth");
    let [x, y, z] = solid.report.size_mm;
    assert!(
        (10.0..16.0).contains(&x.max(y).max(z)),
        "{:?}",
        solid.report
    );
    // A request for any size accepts it.
    read_solid(&file, reading(Unit::Millimetre, Size::Any)).expect("a grain");
}

#[test]
fn every_kind_is_taken_in_its_own_unit_and_refused_in_each_other() {
    let dir = tempfile::tempdir().expect("a folder");
    // Longest edge of each kind, mm.
    for (size, long) in [
        (Size::Tooth, 21.0),
        (Size::Tongue, 72.0),
        (Size::Arch, 100.0),
        (Size::Instrument, 95.0),
    ] {
        let mesh = ellipsoid(Vec3::new(0.5, 0.3, 0.2) * long * 1e-3, 3);
        for drawn in Unit::ALL {
            let file = dir
                .path()
                .join(format!("{}-{}.stl", size.name(), drawn.symbol()));
            // STL is written in millimetres.
            let numbers = mesh.clone().placed(1e-3 / drawn.metres(), Vec3::zeros());
            std::fs::write(&file, to_stl(&numbers)).expect("written");
            for read in Unit::ALL {
                let found = read_solid(&file, reading(read, size));
                if read == drawn {
                    let longest = found.expect("its own unit").report.size_mm[0];
                    assert!((longest / long - 1.0).abs() < 0.01, "{longest} mm");
                    continue;
                }
                let said = found.expect_err("another unit").to_string();
                let symbol = drawn.symbol();
                assert!(
                    said.contains(&format!("`--unit {symbol}`")),
                    "{} in {symbol}: {said}",
                    size.name()
                );
                let (low, high) = size.range_mm();
                assert!(
                    said.contains(&format!("expected {low} to {high} mm for ")),
                    "{said}"
                );
            }
        }
    }
}

#[test]
fn units_and_kinds_are_read_as_they_are_written() {
    for unit in Unit::ALL {
        assert_eq!(unit.symbol().parse(), Ok(unit));
    }
    assert_eq!(
        "inch".parse::<Unit>(),
        Err("unit is `inch`, expected `mm`, `m` or `in`".to_owned())
    );
    for size in Size::ALL {
        assert_eq!(size.name().parse(), Ok(size));
    }
    assert!(
        "giant"
            .parse::<Size>()
            .expect_err("none")
            .contains("`tooth`")
    );
}

/// Returns the warnings of a scene with one object from `tooth.stl` of this size; `more` are further keys.
fn scene(folder: &Path, long_mm: f64, more: &str) -> Result<Vec<String>, String> {
    let mesh = ellipsoid(Vec3::new(0.3, 0.3, 0.5) * long_mm * 1e-3, 2);
    std::fs::write(
        folder.join("tooth.stl"),
        [to_stl(&mesh), vec![b'\n']].concat(),
    )
    .expect("written");
    let text = format!(
        "name = \"x\"\n[[tool]]\nname = \"probe\"\nkind = \"periodontal_probe\"\nlevel = 1\nlevels = 1\npark_mm = [0, 0, 400]\n[[object]]\nname = \"tooth\"\nmesh = \"tooth.stl\"\nlevel = 1\nlevels = 1\n{more}\n"
    );
    let options = BuildOptions::default();
    let built = compile_text(&text, &folder.join("x.toml"), &options, &|_, _| ());
    built
        .map(|built| built.warnings)
        .map_err(|error| error.to_string())
}

#[test]
fn scene_files_judge_a_mesh_by_its_object_and_pass_on_notes() {
    let dir = tempfile::tempdir().expect("a folder");
    let at = |long: f64, more: &str| scene(dir.path(), long, more);
    let warnings = at(20.0, "unit = \"mm\"\nfdi = 36").expect("a tooth");
    assert!(
        warnings
            .iter()
            .any(|said| said.contains("bytes behind the last of 320 triangles")),
        "{warnings:?}"
    );
    at(20.0 / 25.4, "unit = \"in\"\nfdi = 36").expect("a tooth in inches");
    let said = at(20.0 / 25.4, "unit = \"mm\"\nfdi = 36").expect_err("inches");
    assert!(
        said.contains("4 to 45 mm for a tooth") && said.contains("unit = \"in\""),
        "{said}"
    );
    // A jaw instead of a tooth; without a number it is any object in a mouth.
    let said = at(110.0, "unit = \"mm\"\nfdi = 36").expect_err("a jaw");
    assert!(said.contains("4 to 45 mm for a tooth"), "{said}");
    at(110.0, "unit = \"mm\"").expect("a jaw");
    at(110.0, "unit = \"mm\"\nfdi = 36\nsize = \"arch\"").expect("a jaw");
    at(2.0, "unit = \"mm\"\nsize = \"any\"").expect("a grain");
    let said = at(2.0, "unit = \"mm\"").expect_err("a grain");
    assert!(said.contains("`size = \"any\"`"), "{said}");
    let said = at(20.0, "unit = \"cm\"").expect_err("no unit");
    assert!(said.contains("line 13") && said.contains("cm"), "{said}");
    let said = scene(dir.path(), 20.0, "unit = \"mm\"\nsize = \"big\"").expect_err("no kind");
    assert!(said.contains("big"), "{said}");
}
