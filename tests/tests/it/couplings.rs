//! Couplings that are stiffer than a device can display: warned of, and no base for a grade.

use sulcus_tests::{Place, Program};

fn scene(name: &str) -> String {
    format!("{}/inputs/scene/{name}.toml", env!("CARGO_MANIFEST_DIR"))
}

/// Couplings of 10 N/mm and more were taken without a word: they buzz, and what is read and graded under them is wrong.
#[test]
fn a_coupling_that_no_device_displays_is_warned_of_and_not_graded() {
    for (name, found) in [
        ("pocket_k2", None),
        ("pocket_k5", None),
        ("pocket_k10", Some("10")),
        ("pocket_k20", Some("20")),
    ] {
        let file = scene(name);
        let place = Place::new();
        let checked = place.run(Program::Server, &["scene", "check", &file]).ok();
        let demo = [
            "demo",
            "--virtual",
            "--exercise",
            "probing",
            "--duration",
            "2",
            "--scene",
            &file,
        ];
        let shown = place.run(Program::Client, &demo).ok();
        for said in [&checked.stderr, &shown.stderr] {
            let warned = said.contains("warning: ");
            assert_eq!(warned, found.is_some(), "{name}: {said}");
            let Some(found) = found else { continue };
            let words = format!(
                "`stiffness_n_per_mm` of tool `probe` is {found} N/mm, expected under 5.71 N/mm"
            );
            assert!(said.contains(&words), "{said}");
            for number in ["b = 4 N s/m", "T = 1 ms", "t_d = 0.2 ms"] {
                assert!(said.contains(number), "{said}");
            }
        }
        let recording = place.recording();
        let grade = place.run(
            Program::Sessions,
            &["grade", recording.to_str().expect("plain"), "--json"],
        );
        let said = grade.json();
        assert_eq!(said["gradable"], found.is_none(), "{said}");
        assert_eq!(grade.code, i32::from(found.is_some()), "{said}");
        let reason = said["reason"].as_str().unwrap_or_default();
        assert_eq!(
            reason.contains("expected under 5.71 N/mm"),
            found.is_some(),
            "{said}"
        );
        if found.is_some() {
            let serve = [
                "serve",
                "--listen",
                "127.0.0.1:0",
                "--exercise",
                "probing",
                "--scene",
                &file,
            ];
            place.run(Program::Server, &serve).refused(&[
                "exercise `probing` is graded",
                "expected under 5.71 N/mm",
                "b = 4 N s/m",
            ]);
        }
    }
}

/// The limit follows the rate, and what is not graded may be served.
#[test]
fn a_faster_loop_displays_a_stiffer_coupling() {
    let place = Place::new();
    let demo = [
        "demo",
        "--virtual",
        "--exercise",
        "probing",
        "--duration",
        "1",
        "--rate-hz",
        "4000",
    ];
    let file = scene("pocket_k10");
    let shown = place
        .run(Program::Client, &[&demo[..], &["--scene", &file]].concat())
        .ok();
    assert!(!shown.stderr.contains("stiffness_n_per_mm"), "{shown:?}");
    place.serve(&[
        "--exercise",
        "probing",
        "--scene",
        &file,
        "--rate-hz",
        "4000",
    ]);
    place.serve(&["--exercise", "free", "--scene", &file]);
}
