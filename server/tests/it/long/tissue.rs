//! Springs fitted to cases of their own, judged on cases that they have not seen.

use std::path::Path;

use sulcus_core::tissue::TissueModel;
use sulcus_scene::organ::springs::FittedSprings;
use sulcus_scene::{BuildOptions, compile_file};
use sulcus_support::long;

use crate::common::{json, number, text};
use crate::tissue::{evaluated, geometry_of, reference, tissue};

#[test]
fn fitted_to_its_own_cases_a_skeleton_meets_the_unseen_linear_ones() {
    if !long::selected("fitted-skeleton") {
        return;
    }
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
    let [shipped, printed] = ["skeleton", "printed_skeleton"].map(|model| evaluated(&fem, model));
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
