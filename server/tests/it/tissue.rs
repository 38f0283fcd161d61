//! `sulcus-server tissue` from outside: fitted springs judged on cases that they have not seen.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::common::{json, number, text};
use sulcus_core::tissue::TissueModel;
use sulcus_scene::springs::FittedSprings;
use sulcus_scene::{BuildOptions, compile_file};

/// The folder of reference cases; none where the data is absent.
fn reference() -> Option<PathBuf> {
    sulcus_support::data("fem")
}

fn tissue(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_sulcus-server"))
        .arg("tissue")
        .args(arguments)
        .output()
        .expect("runs")
}

/// The geometry of a folder alone, elsewhere.
fn geometry_of(folder: &Path, to: &Path) {
    for name in ["nodes.csv", "tets10.csv", "fixed_all_nodes.csv"] {
        std::fs::copy(folder.join(name), to.join(name)).expect("copied");
    }
}

#[test]
fn fitted_to_its_own_cases_a_skeleton_meets_the_unseen_linear_ones() {
    let Some(folder) = reference() else { return };
    let place = tempfile::tempdir().expect("a temporary folder");
    geometry_of(&folder, place.path());
    let (geometry, springs) = (
        place.path().display().to_string(),
        place.path().join("springs.toml").display().to_string(),
    );
    // Nothing of the reference but its geometry is there to be seen.
    let fit = json(&tissue(&[
        "fit", "--fem", &geometry, "--model", "skeleton", "--out", &springs, "--json",
    ]));
    assert!(number(&fit, "/training_cases") > 100.0 && number(&fit, "/springs") > 150.0);
    let fem = folder.display().to_string();
    let page = place.path().join("page");
    let judged = json(&tissue(&[
        "evaluate",
        "--fem",
        &fem,
        "--model",
        "skeleton",
        "--params",
        &springs,
        "--json",
        "--out",
        &page.display().to_string(),
    ]));
    let shipped = json(&tissue(&[
        "evaluate", "--fem", &fem, "--model", "skeleton", "--json",
    ]));
    let printed = json(&tissue(&[
        "evaluate",
        "--fem",
        &fem,
        "--model",
        "printed_skeleton",
        "--json",
    ]));
    assert_eq!(judged["model"], "skeleton");
    let cases = judged["cases"].as_array().expect("cases");
    assert_eq!(cases.len(), 18);
    let mut linear = 0;
    for (k, case) in cases.iter().enumerate() {
        let name = case["name"].as_str().expect("a name");
        let [rms, rel, max, most] = ["rms", "rel_l2", "max"]
            .map(|what| number(case, &format!("/{what}_percent")))
            .into_iter()
            .chain([number(case, "/max_displacement_mm")])
            .collect::<Vec<_>>()
            .try_into()
            .expect("four");
        println!("{name}: rms {rms:.2} %, rel_l2 {rel:.1} %, max {max:.1} %, {most:.3} mm");
        assert!(rms <= max && 2.0 < most && most < 16.0, "{case}");
        if name.contains("_lin_") {
            linear += 1;
            assert!(rms <= 8.0, "{name}: rms {rms}");
            assert!(rel <= 25.0, "{name}: rel_l2 {rel}");
        }
        for unfitted in [&shipped, &printed] {
            let other = &unfitted["cases"][k];
            assert_eq!(other["name"], case["name"]);
            assert!(number(other, "/rel_l2_percent") > 2.0 * rel, "{other}");
        }
    }
    assert_eq!(linear, 9);
    // A scene of the surface that was written beside them is made of these springs.
    let scene = place.path().join("scene.toml");
    let with = |object: &str| {
        let text = format!(
            "name = \"fitted\"\n[[tool]]\nname = \"mirror\"\nkind = \"mouth_mirror\"\nlevel = 2\nlevels = 2\npark_mm = [10.0, 0.0, 160.0]\n\
             [[object]]\nname = \"tongue\"\n{object}\nlevel = 3\nlevels = 3\ntissue = \"skeleton\"\n\
             [object.skeleton]\nsprings_file = \"springs.toml\"\nsprings_young_kpa = 20.0\n"
        );
        std::fs::write(&scene, text).expect("written");
        compile_file(&scene, &BuildOptions::cached(), &|_, _| {})
    };
    let made = with("mesh = \"springs.obj\"\nunit = \"m\"")
        .expect("a scene")
        .scene;
    let TissueModel::Skeleton(model) = &made.objects[0].tissue else {
        panic!("a skeleton");
    };
    let file = FittedSprings::read(Path::new(&springs)).expect("springs");
    assert_eq!(model.coarse.springs.len(), file.spring.len());
    let softer = model.coarse.springs[7].stiffness[1] / (1e3 * file.spring[7].n_per_mm[1]);
    assert!((softer - 0.2).abs() < 1e-9, "{softer}");
    // A mesh of that name that is somebody's own stays.
    std::fs::write(place.path().join("springs.obj"), "v 0 0 0").expect("written");
    let refused = tissue(&[
        "fit", "--fem", &geometry, "--model", "skeleton", "--out", &springs,
    ]);
    assert_eq!(refused.status.code(), Some(2));
    let error = text(&refused.stderr);
    assert!(error.contains("springs.obj: found another file"), "{error}");
    let said = with("kind = \"tongue\"")
        .expect_err("another tree")
        .to_string();
    assert!(said.contains("the springs are of another tree"), "{said}");
    let [p50, p999] = ["p50", "p999"].map(|p| number(&judged, &format!("/tick_us/{p}")));
    assert!(0.0 < p50 && p50 <= p999);

    let html = std::fs::read_to_string(page.join("tissue.html")).expect("a page");
    assert_eq!(html.matches("src=\"data:image/png;base64,").count(), 18 * 6);
    for part in [
        "Tissue against finite elements",
        "tip_vertical_lin_1.5N",
        "at rest",
        "finite elements",
        "model",
    ] {
        assert!(html.contains(part), "{part} is not on the page");
    }
    for outside in ["http://", "https://", "<script", "<link"] {
        assert!(!html.contains(outside), "{outside} is on the page");
    }
    let picture = std::fs::read(page.join("lateral_nl_4N-above-model.png")).expect("a picture");
    assert!(picture.starts_with(b"\x89PNG\r\n\x1a\n"));
}

#[test]
fn the_surface_compliance_meets_all_cases_linear_and_not() {
    let Some(folder) = reference() else { return };
    let fem = folder.display().to_string();
    let judged = json(&tissue(&[
        "evaluate",
        "--fem",
        &fem,
        "--model",
        "surface_compliance",
        "--json",
    ]));
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
