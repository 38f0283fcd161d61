//! `sulcus-server tissue` from outside.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::common::{json, number, text};

/// The folder of reference cases; none where the data is absent.
pub fn reference() -> Option<PathBuf> {
    sulcus_support::data("fem")
}

pub fn tissue(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_sulcus-server"))
        .arg("tissue")
        .args(arguments)
        .output()
        .expect("runs")
}

/// The geometry of a folder alone, elsewhere.
pub fn geometry_of(folder: &Path, to: &Path) {
    for name in ["nodes.csv", "tets10.csv", "fixed_all_nodes.csv"] {
        std::fs::copy(folder.join(name), to.join(name)).expect("copied");
    }
}

/// Output of `tissue evaluate` for a model as it is shipped, on the reference cases in the folder `fem`.
pub fn evaluated(fem: &str, model: &str) -> serde_json::Value {
    json(&tissue(&[
        "evaluate", "--fem", fem, "--model", model, "--json",
    ]))
}

#[test]
fn the_surface_compliance_meets_all_cases_linear_and_not() {
    let Some(folder) = reference() else { return };
    let fem = folder.display().to_string();
    let judged = evaluated(&fem, "surface_compliance");
    assert_eq!(judged["model"], "surface_compliance");
    let cases = judged["cases"].as_array().expect("cases");
    assert_eq!(cases.len(), 18);
    for case in cases {
        let name = case["name"].as_str().expect("a name");
        let (rms, rel) = (
            number(case, "/rms_percent"),
            number(case, "/rel_l2_percent"),
        );
        let most = number(case, "/max_displacement_mm");
        println!("{name}: {most:.2} mm, rms {rms:.2} %, rel_l2 {rel:.1} %");
        let bound = match (name.contains("_lin_"), most) {
            (true, _) => 2.0,
            (false, ..=10.0) => 4.0,
            _ => 5.0,
        };
        assert!(rms <= bound, "{name}: rms {rms}");
        assert!(
            rel <= 7.0 || !name.contains("_lin_"),
            "{name}: rel_l2 {rel}"
        );
    }
    // There is nothing to fit, and that is said.
    let output = tissue(&[
        "evaluate",
        "--fem",
        &fem,
        "--model",
        "surface_compliance",
        "--params",
        "springs.toml",
    ]);
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn displacements_are_read_last_and_what_is_missing_is_said() {
    let Some(folder) = reference() else { return };
    let place = tempfile::tempdir().expect("a temporary folder");
    let at = place.path().display().to_string();
    let evaluate = |more: &[&str]| {
        let mut arguments = vec!["evaluate", "--fem", &at, "--model", "skeleton"];
        arguments.extend(more);
        let output = tissue(&arguments);
        assert_eq!(output.status.code(), Some(2));
        let said = text(&output.stderr);
        assert_eq!(
            said.lines()
                .filter(|line| line.starts_with("error: "))
                .count(),
            1,
            "{said}"
        );
        said
    };
    assert!(evaluate(&[]).contains("nodes.csv"));
    geometry_of(&folder, place.path());
    assert!(evaluate(&[]).contains("found no table of displacements"));
    let table = place.path().join("lateral_lin_1N.csv");
    std::fs::write(&table, "not a table").expect("written");
    assert!(evaluate(&[]).contains("lateral_forces_unit.csv: No such file"));
    let forces = "lateral_forces_unit.csv";
    std::fs::copy(folder.join(forces), place.path().join(forces)).expect("copied");
    let said = evaluate(&[]);
    // The case was begun before its table was opened.
    assert!(
        said.contains("%  lateral_lin_1N") && said.contains("lateral_lin_1N.csv"),
        "{said}"
    );
    let springs = place.path().join("springs.toml");
    let params = ["--params", &springs.display().to_string()];
    assert!(evaluate(&params).contains("springs.toml"));
    std::fs::write(&springs, "young_kpa = \"soft\"").expect("written");
    assert!(evaluate(&params).contains("springs.toml, line 1"));
    let empty = "fitted = \"\"\nyoung_kpa = 100.0\npoisson = 0.49\nnodes_mm = [[0.0, 0.0, 0.0]]\nfixed = [0]\nspring = []\n";
    std::fs::write(&springs, empty).expect("written");
    std::fs::copy(folder.join("lateral_lin_1N.csv"), &table).expect("copied");
    assert!(evaluate(&params).contains("number of nodes_mm is 1, expected 64"));
    let file = springs.display().to_string();
    for (arguments, told) in [
        (
            ["--out", "/nowhere/at/all.toml", "--freedom", "one"],
            "cannot write the file of --out",
        ),
        (
            ["--out", &file, "--poisson", "0.5"],
            "poisson is 0.5, expected 0 to 0.499",
        ),
    ] {
        let mut all = vec!["fit", "--fem", &at, "--model", "skeleton"];
        all.extend(arguments);
        let output = tissue(&all);
        assert_eq!(output.status.code(), Some(2));
        assert!(
            text(&output.stderr).contains(told),
            "{}",
            text(&output.stderr)
        );
    }
    // What was there before is still there.
    assert_eq!(std::fs::read_to_string(&springs).expect("there"), empty);
}

#[test]
fn a_model_without_springs_is_not_fitted() {
    let said = tissue(&[
        "fit",
        "--fem",
        "nowhere",
        "--model",
        "surface_compliance",
        "--out",
        "x.toml",
    ]);
    let error = text(&said.stderr);
    assert_eq!(said.status.code(), Some(2), "{error}");
    assert!(
        error.contains("surface_compliance")
            && error.contains("[possible values: skeleton, printed_skeleton]"),
        "{error}"
    );
}
