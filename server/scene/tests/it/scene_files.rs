//! Hand-written scene files: understood, or refused in one sentence.

use std::path::Path;

use sulcus_scene::compile::checked;
use sulcus_scene::file::{FileError, parse};
use sulcus_scene::instruments::{Marking, Probe};

fn good() -> &'static str {
    sulcus_scene::BuiltIn::Crown.text()
}

fn message(text: &str) -> String {
    let error: FileError = checked(text, Path::new("my.toml")).expect_err("refused");
    let message = error.to_string();
    assert!(
        message.starts_with("my.toml") && !message.contains('\n'),
        "{message}"
    );
    message
}

#[test]
fn the_shipped_scene_is_understood() {
    let scene = parse(good(), Path::new("crown.toml")).expect("good");
    assert_eq!(
        (scene.name.as_str(), scene.tools.len(), scene.objects[0].fdi),
        ("crown", 1, 36)
    );
}

#[test]
fn an_unknown_key_is_named_with_the_known_ones() {
    let text = good().replace("translate_mm", "translat_mm");
    let said = message(&text);
    assert!(
        said.contains("unknown field `translat_mm`") && said.contains("`translate_mm`"),
        "{said}"
    );
    assert!(said.contains("line "), "{said}");
    assert!(message("name = \"x\"\n[params]\nmax_forse = 1.0\n").contains("`max_force`"));
}

#[test]
fn a_wrong_type_shows_the_line_and_what_was_expected() {
    let said =
        message(&good().replace("stiffness_n_per_mm = 0.5", "stiffness_n_per_mm = \"soft\""));
    assert!(
        said.contains("stiffness_n_per_mm = \"soft\"") && said.contains("expected"),
        "{said}"
    );
    assert!(message("name = \"x").contains("line 1"));
    assert!(message(&good().replace("kind = \"molar\"", "kind = \"mollar\"")).contains("`molar`"));
}

#[test]
fn a_value_out_of_range_is_named_with_its_range() {
    let with = |from: &str, to: &str| message(&good().replace(from, to));
    assert_eq!(
        with("stiffness_n_per_mm = 0.5", "stiffness_n_per_mm = -2.0"),
        "my.toml: `stiffness_n_per_mm` of tool `probe` is -2, expected 0.001 to 100 N/mm"
    );
    assert!(with("fdi = 36", "fdi = 39").contains("`fdi` of object `tooth 36` is 39"));
    assert!(with("park_mm = [0.0,", "park_mm = [nan,").contains("NaN, expected -1000 to 1000 mm"));
    assert!(with("levels = 4", "levels = 9").contains("is 9, expected 1 to 5"));
    assert!(with("level = 3", "level = 5").contains("expected 0 to `levels`"));
    assert!(
        with("kind = \"molar\"", "mesh = \"a.stl\"")
            .contains("`unit` of object `tooth 36` is missing")
    );
    assert!(with("kind = \"molar\"", "").contains("`mesh` of object `tooth 36` is missing"));
    assert!(message("name = \"x\"").contains("number of [[tool]] entries is 0"));
    assert!(
        message("name = \"x\"\n[params]\ntrust = 2.0\n").contains("tool"),
        "tools come first"
    );
    assert!(
        with("[[tool]]", "[params]\ntrust = 2.0\n[[tool]]").contains("`trust` in [params] is 2")
    );
}

#[test]
fn a_tooth_is_named_by_its_number_and_its_sizes_are_checked() {
    let tooth = |lines: &str| good().replace("kind = \"molar\"", lines);
    for fdi in [31, 34, 37, 42, 46] {
        let text = tooth("kind = \"tooth\"\nsizes.crown_height_mm = 8.8")
            .replace("fdi = 36", &format!("fdi = {fdi}"));
        let scene = checked(&text, Path::new("my.toml"));
        // The length is too large for the second molar only, 7.0 mm on average.
        assert_eq!(scene.is_ok(), fdi != 37, "{scene:?}");
    }
    let said = message(&tooth("kind = \"tooth\"").replace("fdi = 36", "fdi = 38"));
    assert!(said.contains("`fdi` of object `tooth 36` is 38"), "{said}");
    assert!(said.contains("31-37, 41-47"), "{said}");
    let said = message(&tooth("kind = \"tooth\"\nsizes.mesiodistal_mm = 3.0"));
    assert_eq!(
        said,
        "my.toml: `sizes.mesiodistal_mm` of object `tooth 36` is 3, expected 0.8 to 1.25 times the average of that tooth"
    );
    let said = message(&tooth("kind = \"tooth\"\nsizes.relief = nan"));
    assert!(said.contains("NaN, expected 0.5 to 1.3"), "{said}");
    let said = message(&tooth("kind = \"molar\"\nsizes.relief = 1.0"));
    assert!(said.contains("nothing without kind = \"tooth\""), "{said}");
}

#[test]
fn a_mirror_is_understood_and_its_dimensions_are_checked() {
    let mirror = good().replace(
        "kind = \"periodontal_probe\"",
        "kind = \"mouth_mirror\"\nmirror = { disc_diameter_mm = 24.0 }",
    );
    let scene = parse(&mirror, Path::new("my.toml")).expect("good");
    let dimensions = scene.tools[0].mirror.as_ref().expect("dimensions");
    assert_eq!(
        (dimensions.disc_diameter_mm, dimensions.disc_thickness_mm),
        (Some(24.0), 2.0)
    );
    let number_5 = mirror.replace("disc_diameter_mm = 24.0", "number = 5");
    let number_5 = parse(&number_5, Path::new("my.toml")).expect("good");
    let number_5 = number_5.tools[0].mirror.clone().expect("dimensions");
    assert_eq!(
        (number_5.diameter_mm(), number_5.name().as_str()),
        (24.0, "No. 5")
    );
    let with = |to: &str| message(&mirror.replace("disc_diameter_mm = 24.0", to));
    assert!(
        with("disc_diameter_mm = 5.0")
            .contains("`mirror.disc_diameter_mm` of tool `probe` is 5, expected 16 to 30 mm")
    );
    assert!(
        with("number = 7")
            .contains("`mirror.number` of tool `probe` is 7, expected 4 (22 mm) or 5 (24 mm)")
    );
    assert!(with("edge_radius_mm = 1.5").contains("expected 0.1 mm to half of disc_thickness_mm"));
    assert!(with("neck_diameter_mm = 3.0").contains("expected 0.8 mm to disc_thickness_mm"));
    assert!(with("touching_mm = 20.0").contains("is 20, expected disc_diameter_mm + neck_mm + 5"));
    assert!(with("disc_deg = nan").contains("`mirror.disc_deg` of tool `probe` is NaN"));
    assert!(with("diameter = 1.0").contains("unknown field `diameter`"));
    // Dimensions of another object.
    assert!(
        message(
            &mirror
                .replace("mirror = {", "probe = {")
                .replace("disc_diameter", "tip_diameter")
        )
        .contains("`probe` of tool `probe` is given, expected nothing without kind")
    );
    assert!(
        message(&mirror.replace("mouth_mirror", "periodontal_probe"))
            .contains("`mirror` of tool `probe` is given, expected nothing without kind")
    );
}

#[test]
fn a_probe_carries_the_marks_of_a_standard_and_no_others() {
    let with = |probe: &str| {
        let kind = "kind = \"periodontal_probe\"";
        good().replace(kind, &format!("{kind}\nprobe = {{ {probe} }}"))
    };
    for (key, marking) in [
        ("unc15", Marking::Unc15),
        ("williams", Marking::Williams),
        ("who", Marking::Who),
    ] {
        let text = with(&format!("marking = \"{key}\""));
        let scene = parse(&text, Path::new("my.toml")).expect("good");
        let probe = scene.tools[0].probe.clone().expect("dimensions");
        assert_eq!(probe.marking, marking);
        assert_eq!(probe.bands(), marking.bands());
    }
    assert_eq!(Probe::default().marking, Marking::Unc15);
    let unknown = message(&with("marking = \"nabers\""));
    assert!(
        unknown.contains("unknown variant `nabers`")
            && unknown.contains("`unc15`, `williams`, `who`"),
        "{unknown}"
    );
    let stem = message(&with("marking = \"who\", stem_diameter_mm = 0.6"));
    assert!(
        stem.contains("`probe.stem_diameter_mm` of tool `probe` is 0.6, expected half of tip"),
        "{stem}"
    );
    assert!(message(&with("neck_diameter_mm = 0.3")).contains("expected stem_diameter_mm to 2.4"));
}
