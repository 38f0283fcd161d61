//! Hand-written files as people reported them: lists of the wrong length, charts with third molars or of one side.

use std::path::{Path, PathBuf};

use sulcus_scene::anatomy::patient::{Patient, healthy_depth, healthy_recession};
use sulcus_scene::organ::springs::FittedSprings;

fn input(name: &str) -> PathBuf {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/inputs")).join(name)
}

fn patient(name: &str) -> Result<Patient, String> {
    let read = Patient::read(&input("patient").join(name));
    read.map(|(patient, _)| patient)
        .map_err(|error| error.to_string())
}

fn parsed(text: &str) -> Result<Patient, String> {
    Patient::parse(text, Path::new("p.toml")).map_err(|error| error.to_string())
}

/// `[5,5, 4, 4]`, where 5.5 4 4 was meant, was read as 5 5 4.
#[test]
fn a_chart_with_a_decimal_comma_is_refused_with_its_line() {
    let good = patient("good.toml").expect("valid");
    let tooth = good.tooth(36).expect("there");
    assert_eq!(tooth.depth_mm.buccal, [5.0, 4.0, 4.0]);
    let said = patient("comma.toml").expect_err("four numbers");
    assert!(
        said.ends_with(
            "comma.toml, line 6 (`depth_mm.buccal = [5,5, 4, 4]`): depth_mm.buccal: 4 numbers found, 3 expected; a decimal is written with a point, such as 5.5"
        ),
        "{said}"
    );
}

#[test]
fn every_list_of_a_chart_has_its_length() {
    let with = |line: &str| {
        parsed(&format!(
            "name = \"a\"\n[[tooth]]\nfdi = 31\n[[tooth]]\nfdi = 36\n{line}\n"
        ))
    };
    for (line, words) in [
        (
            "depth_mm.lingual = [5, 4]",
            "depth_mm.lingual: 2 numbers found, 3 expected",
        ),
        (
            "depth_mm = { buccal = [3, 2, 3], lingual = [3, 2, 3, 4] }",
            "depth_mm.lingual: 4 numbers found, 3 expected",
        ),
        (
            "recession_mm.buccal = [-1,5, 0, -1,5]",
            "recession_mm.buccal: 5 numbers found, 3 expected",
        ),
        (
            "recession_mm.lingual = []",
            "recession_mm.lingual: 0 numbers found, 3 expected",
        ),
        (
            "bleeding.buccal = [true, false, false, true]",
            "bleeding.buccal: 4 values found, 3 expected",
        ),
        (
            "depth_mm.buccal = [\n  5,5,\n  4,\n  4,\n]",
            "line 6 (`depth_mm.buccal = [`): depth_mm.buccal: 4 numbers",
        ),
        (
            "depth_mm.buccal = [5.5, 4.0, 4.0, 4.0]",
            "depth_mm.buccal: 4 numbers found, 3 expected",
        ),
        (
            "depth_mm = [[3, 2, 3], [3, 2, 3]]",
            "depth_mm: a list found",
        ),
        ("furcation = [1, 2, 3]", "furcation: a list found"),
        (
            "depth_mm.bucal = [3, 2, 3]",
            "unknown field `bucal`, expected `buccal` or `lingual`",
        ),
    ] {
        let said = with(line).expect_err(line);
        assert!(
            said.starts_with("p.toml, line 6 ") && said.contains(words),
            "{said}"
        );
    }
}

/// Third molars are missing in most charts, and the chart was refused for them.
#[test]
fn third_molars_may_be_missing_and_upper_teeth_are_refused_by_name() {
    let wisdom = patient("missing_wisdom.toml").expect("valid");
    assert_eq!(wisdom.missing, [38, 46, 48]);
    assert_eq!((wisdom.tooth(46), wisdom.tooth(38)), (None, None));
    assert!(parsed("name = \"a\"\nmissing = [18, 28, 38, 48]").is_ok());
    assert!(parsed("name = \"a\"\nmissing = [38, 38]").is_err());
    let said = patient("missing_both_jaws.toml").expect_err("the upper jaw");
    assert!(
        said.ends_with("`missing` is 16 of the upper jaw, expected teeth of the lower jaw"),
        "{said}"
    );
    for (missing, named) in [
        ("21", "21"),
        ("46, 11, 12, 27", "11, 12 and 27"),
        ("55, 61", "55 and 61"),
    ] {
        let said = parsed(&format!("name = \"a\"\nmissing = [{missing}]")).expect_err(missing);
        assert!(
            said.contains(&format!("`missing` is {named} of the upper jaw")),
            "{said}"
        );
    }
    for nobodys in [0, 10, 19, 30, 39, 49, 71, 255] {
        let said = parsed(&format!("name = \"a\"\nmissing = [{nobodys}]")).expect_err("none");
        assert!(
            said.contains(&format!("`missing` is {nobodys}, expected 31 to 37")),
            "{said}"
        );
    }
}

#[test]
fn one_side_of_a_tooth_alone_leaves_the_other_healthy() {
    let one = patient("buccal_only.toml").expect("valid");
    let tooth = one.tooth(36).expect("there");
    assert_eq!(tooth.depth_mm.buccal, [5.0, 4.0, 4.0]);
    assert_eq!(tooth.depth_mm.lingual, healthy_depth().lingual);
    let text = "name = \"a\"\n[[tooth]]\nfdi = 36\nrecession_mm.lingual = [1, 0, 1]\nbleeding.lingual = [true, true, false]\n";
    let tooth = parsed(text).expect("valid").tooth(36).expect("there");
    assert_eq!(tooth.recession_mm.buccal, healthy_recession().buccal);
    assert_eq!(tooth.recession_mm.lingual, [1.0, 0.0, 1.0]);
    assert_eq!(tooth.bleeding.buccal, [false; 3]);
    assert_eq!(tooth.bleeding.lingual, [true, true, false]);
    assert_eq!(tooth.depth_mm, healthy_depth());
    let again = parsed(&parsed(text).expect("valid").to_toml());
    assert_eq!(again, parsed(text));
}

/// `translate_mm = [1,5, 0,0, 0,0]` was read as 1 5 0.
#[test]
fn a_scene_with_a_decimal_comma_is_refused_with_its_line() {
    for (name, line, key) in [
        ("decimal_comma_translate.toml", 23, "translate_mm"),
        ("decimal_comma_park.toml", 14, "park_mm"),
        ("decimal_comma_rotation.toml", 14, "park_rotation_deg"),
    ] {
        let file = input("scene").join(name);
        let said = sulcus_scene::file::read(&file).expect_err(name).to_string();
        let text = std::fs::read_to_string(&file).expect("there");
        let at = text
            .lines()
            .position(|line| line.starts_with(key))
            .expect(key)
            + 1;
        assert!(at.abs_diff(line) < 3, "{name}: {at}");
        assert!(
            said.contains(&format!("{name}, line {at} (`{key} = [")),
            "{said}"
        );
        let found = text
            .lines()
            .nth(at - 1)
            .expect("a line")
            .matches(',')
            .count()
            + 1;
        assert!(
            said.contains(&format!("{key}: {found} numbers found, 3 expected")),
            "{said}"
        );
    }
    for name in [
        "pocket_k2.toml",
        "pocket_k5.toml",
        "pocket_k10.toml",
        "pocket_k20.toml",
    ] {
        assert!(
            sulcus_scene::file::read(&input("scene").join(name)).is_ok(),
            "{name}"
        );
    }
}

/// Every list of fixed length that a scene file can hold, longer and shorter by one.
#[test]
fn every_list_of_a_scene_has_its_length() {
    let scene = |line: &str| {
        let (section, line) = line.split_once('|').expect("a section");
        let own = |of: &str| if of == section { line } else { "" };
        let text = format!(
            "name = \"x\"\n[[tool]]\nname = \"probe\"\nkind = \"periodontal_probe\"\n{}\n{}\n[[object]]\nname = \"o\"\nkind = \"molar\"\n{}\n",
            if line.starts_with("park_mm") {
                ""
            } else {
                "park_mm = [0, 0, 115]"
            },
            own("tool"),
            own("object"),
        );
        sulcus_scene::file::parse(&text, Path::new("s.toml")).map_err(|error| error.to_string())
    };
    for (list, expected) in [
        ("tool|park_mm", 3),
        ("tool|park_rotation_deg", 3),
        ("tool|working_point_mm", 3),
        ("tool|tip_mm", 3),
        ("tool|tip_axis", 3),
        ("object|translate_mm", 3),
        ("object|skeleton.stiffness_n_per_mm", 3),
        ("object|pocket.depths_mm", 6),
        ("object|sulcus.axis", 3),
        ("object|sulcus.mesial", 3),
        ("object|sulcus.origin_mm", 3),
    ] {
        for found in [expected - 1, expected + 1, 2 * expected] {
            let numbers = vec!["1"; found].join(", ");
            let said = scene(&format!("{list} = [{numbers}]")).expect_err(list);
            let key = list.split_once('|').expect("a section").1;
            let words = format!("{key}: {found} numbers found, {expected} expected");
            assert!(
                said.starts_with("s.toml, line ") && said.contains(&words),
                "{said}"
            );
        }
        let numbers = vec!["1"; expected].join(", ");
        let said = scene(&format!("{list} = [{numbers}]"))
            .err()
            .unwrap_or_default();
        assert!(!said.contains("numbers found"), "{list}: {said}");
    }
    let said = scene("tool|probe = [1, 2]").expect_err("a list");
    assert!(said.contains("probe: a list found"), "{said}");
}

#[test]
fn every_list_of_springs_has_its_length() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("springs.toml");
    let read = |nodes: &str, stiffness: &str| {
        let text = format!(
            "fitted = \"x\"\nyoung_kpa = 10.0\npoisson = 0.49\nnodes_mm = [[0, 0, 0],\n {nodes}]\nfixed = [0]\n[[spring]]\na = 0\nb = 1\nn_per_mm = {stiffness}\n"
        );
        std::fs::write(&file, text).expect("written");
        FittedSprings::read(&file).map_err(|error| error.to_string())
    };
    assert!(read("[1, 0, 0]", "[1, 1, 1, 0, 0, 0]").is_ok());
    let said = read("[1,5, 0, 0]", "[1, 1, 1, 0, 0, 0]").expect_err("four");
    assert!(
        said.contains(
            "springs.toml, line 5 (`[1,5, 0, 0]]`): nodes_mm[1]: 4 numbers found, 3 expected"
        ),
        "{said}"
    );
    let said = read("[1, 0, 0]", "[1, 1, 1, 0, 0, 0, 0]").expect_err("seven");
    assert!(
        said.contains("n_per_mm: 7 numbers found, 6 expected"),
        "{said}"
    );
}
