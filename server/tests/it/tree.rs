//! `sulcus-server tree` from outside: what it prints, what it writes, what it refuses.

use std::path::Path;
use std::process::{Command, Output};

use crate::common::{json, number, text};
use sulcus_core::Vec3;
use sulcus_scene::mesh::load::to_stl;
use sulcus_scene::mesh::shapes::{cuboid, ellipsoid};

/// The program under test.
const PROGRAM: &str = env!("CARGO_BIN_EXE_sulcus-server");

/// A folder with two meshes: an ellipsoid and a plate that lies under it.
fn place() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let egg = ellipsoid(Vec3::new(0.006, 0.004, 0.003), 3);
    std::fs::write(folder.path().join("egg & <b>.stl"), to_stl(&egg)).expect("writes");
    let plate = cuboid(Vec3::new(0.01, 0.01, 0.0005)).placed(1.0, Vec3::new(0.0, 0.0, -0.0037));
    std::fs::write(folder.path().join("plate.stl"), to_stl(&plate)).expect("writes");
    folder
}

fn tree(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(PROGRAM)
        .current_dir(folder)
        .arg("tree")
        .args(arguments)
        .output()
        .expect("runs")
}

#[test]
fn the_json_says_what_others_rely_on_and_how_sure_it_is() {
    let folder = place();
    let report = json(&tree(
        folder.path(),
        &[
            "egg & <b>.stl",
            "--levels",
            "2",
            "--json",
            "--zone",
            "under=near:plate.stl:0.5",
            "--zone",
            "tip=ball:6,0,0,2",
        ],
    ));
    assert!(number(&report, "/build_s") > 0.0);
    assert_eq!(number(&report, "/triangles"), 1280.0);
    let levels = report["levels"].as_array().expect("levels");
    assert_eq!(levels.len(), 3);
    let zones = report["zones"].as_array().expect("zones");
    let names: Vec<_> = zones.iter().map(|zone| zone["name"].as_str()).collect();
    assert_eq!(names, [Some("under"), Some("tip")]);
    for zone in zones {
        assert_eq!(zone["levels"].as_array().expect("levels").len(), 3);
        let part = number(zone, "/area_mm2") / 230.0;
        assert!((0.005..0.3).contains(&part), "{zone}");
    }
    let in_zones = zones.iter().flat_map(|zone| zone["levels"].as_array());
    for level in levels.iter().chain(in_zones.flatten()) {
        for way in ["mesh_to_spheres_mm", "spheres_to_mesh_mm"] {
            // No point of a coarse sphere need be nearest to a zone: then there is no distance.
            if level["measured"]["exposed_points"] == 0 && way == "spheres_to_mesh_mm" {
                assert!(level[way]["max"].is_null() && level["volume_error_percent"].is_null());
                continue;
            }
            let [mean, p95, max, at_most] = ["mean", "p95", "max", "max_at_most"]
                .map(|k| number(level, &format!("/{way}/{k}")));
            assert!(0.0 < mean && mean <= p95 && p95 <= max, "{level}");
            assert!(max <= at_most && at_most <= 1.1 * max, "{level}");
        }
        let outside = number(level, "/uncovered_area_percent");
        assert!((0.0..=100.0).contains(&outside));
        assert!(number(level, "/uncovered_beyond/0/percent") <= outside);
        assert!(number(level, "/cavity_area_percent") <= 100.0);
    }
    for (k, level) in levels.iter().enumerate() {
        assert_eq!(number(level, "/level"), k as f64);
        assert!(number(level, "/spheres") <= 8_f64.powi(k as i32));
        let [error, missing, excess] = ["volume_error", "missing_volume", "excess_volume"]
            .map(|k| number(level, &format!("/{k}_percent")));
        assert!((error - (excess - missing)).abs() < 1e-9);
        for (zone, way) in [(0, "mesh_to_spheres_mm"), (1, "mesh_to_spheres_mm")] {
            let part = number(&zones[zone]["levels"][k], &format!("/{way}/max"));
            let whole = number(level, &format!("/{way}/max_at_most"));
            assert!(part <= whole, "a part has no larger maximum than the whole");
        }
    }
    // A finer level fits better, whatever the builder.
    let mean = |k: usize| number(&levels[k], "/mesh_to_spheres_mm/mean");
    assert!(mean(2) < mean(1) && mean(1) < mean(0));
}

#[test]
fn out_writes_the_numbers_and_a_file_for_rerun() {
    let folder = place();
    let output = tree(
        folder.path(),
        &[
            "egg & <b>.stl",
            "--levels",
            "1",
            "--out",
            "deep/in/side",
            "--zone",
            "tip=ball:6,0,0,2",
            "--json",
        ],
    );
    let report = json(&output);
    let out = folder.path().join("deep/in/side");
    let numbers = std::fs::read_to_string(out.join("tree.json")).expect("the numbers");
    let numbers: serde_json::Value = serde_json::from_str(&numbers).expect("JSON");
    assert_eq!(numbers, report);
    assert_eq!(report["levels"].as_array().map(Vec::len), Some(2));
    assert_eq!(report["zones"][0]["name"], "tip");
    let said = text(&output.stdout);
    assert!(said.contains("written to deep/in/side/tree.json"), "{said}");
    // The file for Rerun comes from the program beside, where a build has made the program.
    let rerun = out.join("tree.rrd");
    let installed = Path::new(PROGRAM).with_file_name("sulcus-review").exists();
    assert_eq!(rerun.exists(), installed);
    assert_eq!(report["rerun"].is_string(), installed);
    if installed {
        assert!(std::fs::read(rerun).expect("reads").starts_with(b"RRF"));
    } else {
        assert!(text(&output.stderr).contains("no tree.rrd: the program `sulcus-review`"));
    }
    // Numbers and scene, no further file.
    let files = std::fs::read_dir(&out).expect("a folder").count();
    assert_eq!(files, 1 + usize::from(installed));
}

#[test]
fn what_cannot_be_done_is_refused_in_one_sentence_before_anything_is_built() {
    let folder = place();
    std::fs::write(folder.path().join("file"), "in the way").expect("writes");
    for (arguments, told) in [
        (
            ["--out", "file"],
            "file: cannot write into the folder of --out",
        ),
        (["--out", "file/below"], "file/below: cannot write into"),
        (
            ["--zone", "cone:1"],
            "kind is `cone`, expected near:FILE:MM",
        ),
        (["--zone", "near:absent.stl:1"], "absent.stl: cannot read"),
        (
            ["--zone", "far=ball:90,0,0,1"],
            "zone `far` holds nothing of the surface of egg",
        ),
        (["--zone-weight", "3"], "--zone"),
    ] {
        let output = tree(
            folder.path(),
            &["egg & <b>.stl", "--levels", "1", arguments[0], arguments[1]],
        );
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        let said = text(&output.stderr);
        assert!(said.contains(told), "{arguments:?}: {said}");
        let errors = said.lines().filter(|line| line.starts_with("error: "));
        assert_eq!(errors.count(), 1, "{said}");
        assert!(output.stdout.is_empty(), "{arguments:?}");
        assert!(!said.contains('%'), "something was built: {said}");
    }
}
