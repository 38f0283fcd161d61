//! `sulcus-server report --quick` as a person runs it: the page, the numbers, the exit code.

use serde_json::Value;
use sulcus_tests::{Place, Program};

/// What every row of the JSON has, by the kind of its value.
const TEXTS: [&str; 5] = ["case", "method", "tissue", "solver", "status"];
const NUMBERS: [&str; 7] = [
    "level",
    "residual_um",
    "graphic_jump_um",
    "buzz_n",
    "force_step_n",
    "energy_mj",
    "passes_mean",
];
const PERCENTILES: [&str; 4] = ["p50", "p99", "p999", "max"];

fn list<'a>(of: &'a Value, name: &str) -> &'a Vec<Value> {
    let list = of[name].as_array();
    list.unwrap_or_else(|| panic!("no list `{name}`"))
}

/// A quick report writes its page and its numbers, and all in it holds.
pub fn quick_report_is_whole() {
    let place = Place::new();
    let report = ["report", "--quick", "--json", "--out", "found"];
    let found = place.run(Program::Server, &report).ok().json();
    assert!(found["machine"]["processor"].is_string());
    let rows = list(&found, "rows");
    assert!(rows.len() >= 15, "{} rows", rows.len());
    for row in rows {
        for name in TEXTS {
            assert!(row[name].is_string(), "{name}: {row}");
        }
        for name in NUMBERS {
            assert!(
                row[name].as_f64().is_some_and(f64::is_finite),
                "{name}: {row}"
            );
        }
        for name in PERCENTILES {
            assert!(row["tick_us"][name].as_f64() > Some(0.0), "{name}: {row}");
        }
        if row["method"] == "coupled" {
            assert_eq!(row["status"], "holds", "{row}");
        }
    }
    // One of them as printed, a few by the judge.
    let of = |name: &str, is: &str| rows.iter().filter(|row| row[name] == is).count();
    assert!(of("method", "printed") >= 1 && of("solver", "clarabel") >= 3);
    for part in [
        "matrix",
        "rates",
        "random_poses",
        "finite_elements",
        "one_dof",
    ] {
        assert!(!list(&found, part).is_empty(), "{part}");
    }
    // A minute stands for an hour only where it is said to.
    for hour in list(&found["passivity"], "hours") {
        assert!(hour["whole_hour"].is_boolean(), "{hour}");
    }
    let read = |name: &str| std::fs::read_to_string(place.path(name)).expect("it was written");
    let file: Value = serde_json::from_str(&read("found/report.json")).expect("JSON");
    assert_eq!(file["rows"], found["rows"]);
    let page = read("found/report.html");
    for part in [
        "Does it hold 1 kHz here?",
        "How wrong is it?",
        "Where does it break?",
        "<svg",
        "id=\"matrix\"",
        "id=\"growth\"",
        "id=\"passivity\"",
    ] {
        assert!(page.contains(part), "{part}");
    }
}

#[test]
fn what_a_report_cannot_do_is_refused_before_it_works() {
    let place = Place::new();
    let run = |arguments: &[&str]| {
        let report = [&["report", "--quick"], arguments].concat();
        place.run(Program::Server, &report)
    };
    run(&["--paper=teeth"]).refused(&["teeth", "--paper"]);
    run(&["--peers", "none.json"]).refused(&["none.json", "--peers"]);
    run(&["--paper=tongue", "--peers", "none.json"]).refused(&["--peers"]);
    let tables = ["--readme", "`Hard cases`", "`Paper: the machine`"];
    run(&["--paper", "--readme", "none.md"]).refused(&tables);
    assert!(!place.path("report").join("report.json").exists());
}
