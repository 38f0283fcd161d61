//! The first start of a school: `init` makes everything that a class needs, and nothing twice.

use sulcus_tests::{Place, Program, files_with};

const INIT: [&str; 12] = [
    "init",
    "school",
    "--stations",
    "2",
    "--exercise",
    "crown",
    "--class",
    "Year 4",
    "--hours",
    "0.1",
    "--listen",
    "127.0.0.1:0",
];

fn init(place: &Place, more: &[&str]) -> sulcus_tests::Ended {
    place.run(Program::Server, &[&INIT[..], more].concat())
}

#[test]
fn a_machine_is_ready_for_a_recorded_session_after_one_command() {
    let place = Place::new();
    let checked = init(&place, &["--yes", "--check", "--json"]).ok().json();
    assert_eq!(checked["ready"], true, "{checked}");
    assert!(
        !place.path("school").exists() && !place.path("state").exists(),
        "a check makes nothing"
    );

    let made = init(&place, &["--json"]).ok().json();
    assert_eq!(made["kept"], serde_json::json!([]), "{made}");
    let tickets = std::fs::read_to_string(place.path("school/tickets.csv")).expect("tickets");
    let rows: Vec<Vec<&str>> = tickets
        .lines()
        .map(|line| line.split(',').collect())
        .collect();
    let roles: Vec<&str> = rows.iter().map(|row| row[0]).collect();
    assert_eq!(roles, ["role", "student", "student", "instructor", "admin"]);
    let mode = std::fs::metadata(place.path("school/tickets.csv")).expect("a file");
    assert_eq!(
        std::os::unix::fs::PermissionsExt::mode(&mode.permissions()) & 0o777,
        0o600
    );

    let before = tickets.clone();
    let again = init(&place, &["--yes"]).ok();
    assert!(again.stdout.contains("kept     class Year 4"), "{again:#?}");
    assert!(!again.stdout.contains("made     "), "{again:#?}");
    let after = std::fs::read_to_string(place.path("school/tickets.csv")).expect("tickets");
    assert_eq!(before, after, "tickets stay valid");

    let server = place.serve_at("127.0.0.1:0", &["--config", "school/stations.toml"]);
    let hand = [
        "run",
        "--server",
        &server.address,
        "--ticket",
        rows[2][2],
        "--duration",
        "2",
        "--tick",
        "server",
    ];
    place.run(Program::Client, &hand).ok();
    assert_eq!(
        files_with(&place.path("school/recordings"), "mcap").len(),
        1
    );
    place
        .run(
            Program::Client,
            &[
                "monitor",
                "--server",
                &server.address,
                "--ticket",
                rows[3][2],
                "--once",
            ],
        )
        .ok();
}

#[test]
fn a_wrong_value_and_a_full_disk_make_nothing() {
    let place = Place::new();
    init(&place, &["--yes", "--exercise", "none"]).refused(&["exercise"]);
    let planned = place.run(
        Program::Server,
        &[
            "init",
            "school",
            "--stations",
            "64",
            "--hours",
            "10000",
            "--listen",
            "127.0.0.1:0",
            "--yes",
        ],
    );
    assert_eq!(planned.code, 1, "{planned:#?}");
    assert!(planned.stdout.contains("PROBLEM"), "{planned:#?}");
    assert!(planned.stderr.contains("nothing was made"), "{planned:#?}");
    assert!(!place.path("school").exists(), "nothing is left");
}
