//! `sulcus-server tree` on meshes as other programs write them: built with a note, built on request, or refused by name.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::common::{json, number, text};

/// The program under test.
const PROGRAM: &str = env!("CARGO_BIN_EXE_sulcus-server");

fn inputs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/inputs")
}

fn tree(arguments: &[&str]) -> Output {
    Command::new(PROGRAM)
        .current_dir(inputs())
        .arg("tree")
        .args(arguments)
        .args(["--levels", "1", "--json"])
        .output()
        .expect("runs")
}

#[test]
fn odd_files_are_built_and_what_was_not_read_or_asked_for_is_told() {
    let cases: [(&[&str], f64, &str); 7] = [
        (&["ngon/arch_ngon_rot.obj"], 8465.8, ""),
        (
            &["stl/solid_header_trailing.stl"],
            0.0,
            "note: 2 bytes behind the last of 952 triangles were not read",
        ),
        (&["ply/tristrips.ply"], 0.0, ""),
        (
            &["scan/inches.stl", "--unit", "in", "--size", "tooth"],
            0.0,
            "",
        ),
        (&["scan/inches.stl", "--size", "any"], 0.0, ""),
        (
            &["scan/crown_open.stl", "--close-base"],
            0.0,
            "repaired: the open base was closed on request: a rim of",
        ),
        (
            &["scan/tooth_with_crumb.stl", "--keep-largest"],
            0.0,
            "repaired: 1 piece was dropped because only the largest piece was requested: 4 triangles",
        ),
    ];
    for (arguments, volume_mm3, told) in cases {
        let output = tree(arguments);
        let report = json(&output);
        let said = text(&output.stderr);
        assert!(said.contains(told), "{arguments:?}: {said}");
        let found = number(&report, "/volume_mm3");
        if volume_mm3 > 0.0 {
            assert!((found - volume_mm3).abs() < 0.1, "{found} mm3");
        }
        let error = number(&report, "/levels/1/volume_error_percent");
        assert!(error.abs() < 50.0, "{arguments:?}: {error} %");
        for (kind, begins) in [("notes", "note: "), ("repairs", "repaired: ")] {
            let list = report[kind].as_array().expect("a list");
            let lines = said.lines().filter(|line| line.starts_with(begins));
            assert_eq!(lines.count(), list.len(), "{arguments:?}: {said}");
        }
    }
}

#[test]
fn meshes_that_are_no_solid_are_refused_in_one_sentence_that_says_what_helps() {
    let cases: [(&[&str], &str); 10] = [
        (&["scan/inches.stl"], "in inches it would be"),
        (&["scan/inches.stl", "--unit", "m"], "`--unit in`"),
        (
            &["scan/inches.stl", "--unit", "ft"],
            "expected `mm`, `m` or `in`",
        ),
        (
            &["scan/inches.stl", "--size", "molar"],
            "expected one of `tooth`",
        ),
        (&["scan/crown_open.stl"], "--close-base"),
        (&["scan/two_teeth.stl"], "--keep-largest"),
        (&["scan/two_teeth.stl", "--close-base"], "2 separate pieces"),
        (
            &["scan/fin.stl", "--keep-largest", "--close-base"],
            "(non-manifold)",
        ),
        (&["stl/count_zero.stl"], "announces 0 triangles"),
        (&["stl/truncated.stl"], "of which 950 are whole"),
    ];
    for (arguments, told) in cases {
        let output = tree(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        let said = text(&output.stderr);
        assert!(said.contains(told), "{arguments:?}: {said}");
        assert!(output.stdout.is_empty(), "{arguments:?}");
    }
}
