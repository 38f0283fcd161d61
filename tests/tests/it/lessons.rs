//! The exercises with tissue from outside: performed, recorded, replayed bit for bit, read.

use serde_json::Value;
use sulcus_tests::{Place, Program};

/// Performs an exercise in virtual time and replays what was recorded.
fn perform(exercise: &str, seconds: &str, seed: &str) -> (Place, Value) {
    let place = Place::new();
    let arguments = [
        "demo",
        "--virtual",
        "--exercise",
        exercise,
        "--duration",
        seconds,
        "--seed",
        seed,
        "--json",
    ];
    let demo = place.run(Program::Client, &arguments).ok().json();
    let file = place.recording();
    let replay = place
        .run(
            Program::Sessions,
            &["replay", "--json", file.to_str().expect("plain")],
        )
        .ok()
        .json();
    assert_eq!(
        (&replay["ticks"], &replay["identical"]),
        (&demo["ticks"], &true.into()),
        "{replay}"
    );
    assert!(replay["first_divergent_tick"].is_null(), "{replay}");
    assert_eq!(demo["identical"], true, "{demo}");
    let most = demo["max_residual_um"].as_f64().expect("a number");
    assert!(most <= 1.0, "{demo}");
    (place, demo)
}

#[test]
fn probing_reads_a_pocket_and_replays() {
    let (place, demo) = perform("probing", "12", "3");
    let sites = demo["pocket"]["sites"].as_array().expect("sites");
    assert!(!sites.is_empty(), "{demo}");
    let read = sites.iter().find(|site| !site["measured_mm"].is_null());
    let read = read.unwrap_or_else(|| panic!("no site was read at correct force: {demo}"));
    let (measured, truth) = (
        read["measured_mm"].as_f64().expect("a depth"),
        read["truth_mm"].as_f64().expect("a depth"),
    );
    assert!((measured - truth).abs() <= 0.5, "{demo}");
    assert_eq!(read["tooth"], 36);
    let file = place.recording();
    let info = place.run(Program::Sessions, &["info", file.to_str().expect("plain")]);
    assert!(info.ok().stdout.contains("probing"));
    // The grade of the recording alone is the demo's own.
    let grade = place.run(
        Program::Sessions,
        &["grade", "--json", file.to_str().expect("plain")],
    );
    let grade = grade.ok().json();
    for field in ["score", "metrics", "sites", "rubric"] {
        assert_eq!(grade[field], demo["grade"][field], "{field}");
    }
    assert_eq!(grade["rubric"]["source"], "recording");
    let called = grade["sites"].as_array().expect("sites").iter();
    assert!(
        called.filter(|site| site["called_mm"].is_u64()).count() >= 1,
        "{grade}"
    );
}

#[test]
fn retraction_presses_the_tongue_and_replays() {
    let (_, demo) = perform("retraction", "6", "1");
    // Hidden until the tongue is held aside, and once it is let go.
    let visible = demo["events"]["visible_share"].as_f64();
    let visible = visible.expect("a target");
    assert!((0.2..=0.9).contains(&visible), "{demo}");
    let tissue = &demo["tissue"];
    let indentation = tissue["indentation_mm"].as_f64().expect("a length");
    assert!((4.0..=14.0).contains(&indentation), "{demo}");
    assert_eq!(tissue["flips"], 0, "{demo}");
    assert!(
        demo["max_force_n"].as_f64().expect("a force") > 0.2,
        "{demo}"
    );
    assert!(demo["pocket"].is_null(), "{demo}");
}
