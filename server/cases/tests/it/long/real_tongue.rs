//! A real tongue as a scene, from the data folder beside the project: finite elements made from its surface, a mouth mirror
//! that presses it aside.

use std::path::{Path, PathBuf};

use sulcus_cases::table::Driver;
use sulcus_cases::{Case, find, run};
use sulcus_operator::retraction::{Retraction, RetractionParams};
use sulcus_scene::{BuildOptions, compile_text};
use sulcus_support::long;

const SCENE: &str = r#"
name = "real tongue"

[[tool]]
name = "mirror"
kind = "mouth_mirror"
level = 3
levels = 3
stiffness_n_per_mm = 0.5
stiffness_nmm_per_rad = 3000.0
park_mm = [10.0, 0.0, 190.0]

[[object]]
name = "tongue"
mesh = "tongue.stl"
unit = "mm"
level = 3
levels = 3
tissue = "surface_compliance"

[object.surface]
young_kpa = 10.0
fixed_root = 0.1
fixed_bottom = 0.15
"#;

fn mesh() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/meshes/tongue.stl")
}

#[test]
fn the_mirror_presses_a_real_tongue_aside_and_lets_it_come_back() {
    if !long::selected("real-tongue") {
        return;
    }
    if sulcus_support::data("meshes/tongue.stl").is_none() {
        return;
    }
    let case = Case {
        name: "real-tongue",
        scene: || {
            let file = mesh().with_file_name("tongue.toml");
            let compiled = compile_text(SCENE, &file, &BuildOptions::cached(), &|_, _| ());
            compiled.expect("a real tongue").scene
        },
        driver: Driver::Kinematic(|scene| {
            let params = RetractionParams {
                duration: 12.0,
                press: 8e-3,
                most_force: 10.0,
                times: 1,
                ..RetractionParams::default()
            };
            Box::new(Retraction::new(scene, params).expect("a tongue and a mirror"))
        }),
        ..*find("tongue-10-k0.5").expect("in the table")
    };
    let report = run(&case, |_| {});
    let m = &report.measures;
    println!(
        "residual {:.3} um, buzz {:.4} N, {:.2} N, pressed in by {:.2} mm, {} flips, force step {:.3} N",
        m.residual * 1e6,
        m.buzz,
        m.max_raw_force,
        m.indentation * 1e3,
        m.flips,
        m.force_step
    );
    assert!(report.broken.is_empty(), "{:#?}", report.broken);
    assert!(m.indentation > 3e-3 && m.max_raw_force > 0.5);
}
