//! The page and the numbers of a small report.

use sulcus_cases::find;
use sulcus_core::optimise::SolverKind;

use super::page;
use crate::report::{Growth, Loops, Machine, Mouth, Report, row};

fn small() -> Report {
    let case = find("teleport").expect("in the table");
    Report {
        program: "this",
        quick: true,
        machine: Machine::here(),
        rows: vec![
            row(case, false, SolverKind::ActiveSet, true),
            row(case, false, SolverKind::Clarabel, true),
        ],
        mouth: Mouth {
            patient: 1,
            objects: 0,
            levels: Vec::new(),
        },
        matrix: Vec::new(),
        rates: Vec::new(),
        growth: Growth { lines: Vec::new() },
        random_poses: Vec::new(),
        passivity: Loops {
            loops: Vec::new(),
            hours: Vec::new(),
        },
        devices: Vec::new(),
        one_dof: Vec::new(),
        finite_elements: Vec::new(),
        peers: Some(serde_json::json!({
            "rows": [{"scene": "a <block>", "engine": "another", "tick_us": {"p50": 1.0}}],
            "ratios": [{"name": "time", "value": 0.5, "at_least": 1.0, "holds": false}],
        })),
        screen: Some(serde_json::json!({
            "machine": {"processor": "a <processor>", "cores": 2},
            "adapter": "one",
            "size": [1280, 720],
            "bounds": [{"level": "low", "ms": 30.0}, {"level": "lowest", "ms": 16.0}],
            "levels": [{"level": "low", "light": "each vertex", "always": ["bands", "mirror"]}],
            "rows": [
                {"level": "low", "view": "buccal", "draws": 4, "mirror_ms": 29.5},
                {"level": "lowest", "view": "buccal", "draws": 4, "mirror_ms": 16.5},
            ],
        })),
        networks: Some(serde_json::json!([
            {"network": null, "tick": "server", "pose_age_ms": {"p50": 0.6112, "p99": 1.0}, "grade": 99.0},
            {"network": "a <b>", "tick": "hand", "pose_age_ms": {"p50": 1.0, "p99": 1.125}, "felt_identical": true},
        ])),
        paper: None,
        took_s: 1.0,
        parts_s: Vec::new(),
    }
}

#[test]
fn the_three_answers_stand_before_everything_else_and_nothing_is_fetched() {
    let html = page(&small()).expect("a page");
    let at = |text: &str| html.find(text).unwrap_or_else(|| panic!("no {text}"));
    let first = at("What a better answer costs");
    for question in [
        "Does it hold 1 kHz here?",
        "How wrong is it?",
        "Where does it break?",
    ] {
        assert!(at(question) < first);
    }
    for outside in ["src=\"http", "href=\"http", "@import", "url("] {
        assert!(!html.contains(outside), "{outside}");
    }
    // What comes from files is text, not markup.
    assert!(html.contains("a &#60;block&#62;") && html.contains("does not hold"));
}

#[test]
fn a_row_of_each_network_says_what_the_hand_felt() {
    let html = page(&small()).expect("a page");
    let section = html.split("id=\"networks\"").nth(1).expect("the section");
    let section = section.split("</section>").next().unwrap_or_default();
    let at = |text: &str| section.find(text).unwrap_or_else(|| panic!("no {text}"));
    assert!(at("none") < at("0.61") && at("0.61") < at("a &#60;b&#62;"));
    assert!(at("1.12") < at("yes"));
    let without = Report {
        networks: None,
        ..small()
    };
    let html = page(&without).expect("a page");
    assert!(html.contains("example <code>networks</code>"));
}

#[test]
fn costs_of_the_screen_stand_beside_their_bounds_and_looks() {
    let html = page(&small()).expect("a page");
    let section = html.split("id=\"screen\"").nth(1).expect("the section");
    let section = section.split("</section>").next().unwrap_or_default();
    assert!(section.contains("a &#60;processor&#62;, 2 logical cores"));
    assert!(section.contains("1280 x 720") && section.contains("bands, mirror"));
    let [low, lowest] = ["29.5", "16.5"].map(|ms| section.find(ms).expect("a row"));
    let [holds, broken] =
        ["\"holds\"", "\"broken\""].map(|word| section.find(word).expect("a word"));
    assert!(low < holds && holds < lowest && lowest < broken);
    let without = Report {
        screen: None,
        ..small()
    };
    assert!(
        page(&without)
            .expect("a page")
            .contains("Not in this report. The example")
    );
}
