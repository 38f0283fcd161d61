//! What people write by hand: understood, or refused in one sentence.

use std::path::Path;

use sulcus_scene::file::{FileError, parse};

const GOOD: &str = sulcus_scene::compile::DEFAULT_SCENE;

fn message(text: &str) -> String {
    let error: FileError = parse(text, Path::new("my.toml")).expect_err("refused");
    let message = error.to_string();
    assert!(
        message.starts_with("my.toml") && !message.contains('\n'),
        "{message}"
    );
    message
}

#[test]
fn the_shipped_scene_is_understood() {
    let scene = parse(GOOD, Path::new("crown.toml")).expect("good");
    assert_eq!(
        (scene.name.as_str(), scene.tools.len(), scene.objects[0].fdi),
        ("crown", 1, 36)
    );
}

#[test]
fn an_unknown_key_is_named_with_the_known_ones() {
    let text = GOOD.replace("translate_mm", "translat_mm");
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
    let said = message(&GOOD.replace("stiffness_n_per_mm = 0.5", "stiffness_n_per_mm = \"soft\""));
    assert!(
        said.contains("stiffness_n_per_mm = \"soft\"") && said.contains("expected"),
        "{said}"
    );
    assert!(message("name = \"x").contains("line 1"));
    assert!(message(&GOOD.replace("kind = \"molar\"", "kind = \"mollar\"")).contains("`molar`"));
}

#[test]
fn a_value_out_of_range_is_named_with_its_range() {
    let with = |from: &str, to: &str| message(&GOOD.replace(from, to));
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
