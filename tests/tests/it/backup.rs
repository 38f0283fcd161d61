//! A backup of a school, restored on an empty machine: tickets, classes, audit log, grades of old sessions.

use sulcus_tests::{Place, Program};

/// Words of a command with paths of the place.
fn words(line: &str) -> Vec<&str> {
    line.split_whitespace().collect()
}

#[test]
fn a_restored_machine_admits_the_same_tickets_and_grades_an_old_session_to_the_same_bytes() {
    let place = Place::new();
    let run = |line: &str| place.run(Program::Server, &words(line));
    std::fs::write(place.path("class.csv"), "learner,class\ns-4f7k2,Year 4\n").expect("a table");
    run("class import class.csv").ok();
    run("token add --role student --station station --out ticket").ok();
    let ticket = std::fs::read_to_string(place.path("ticket")).expect("a ticket");
    let server = place.serve(&["--mode", "exam"]);
    let hand = [
        "run",
        "--server",
        &server.address,
        "--ticket",
        ticket.trim(),
        "--duration",
        "3",
        "--tick",
        "server",
    ];
    place.run(Program::Client, &hand).ok();
    // The server runs meanwhile.
    let made = run("backup school.backup --json").ok().json();
    assert!(
        made["files"].as_u64().is_some_and(|files| files >= 5),
        "{made}"
    );
    drop(server);
    run("backup school.backup").refused(&["school.backup", "exists"]);
    run("backup state/inside.backup").refused(&["lies in the state folder"]);
    let file = place.recording();
    let file = file.to_str().expect("plain");
    let grade = |place: &Place| {
        let graded = place.run(Program::Sessions, &["grade", file, "--json"]);
        (graded.code, graded.stdout)
    };
    let before = grade(&place);
    assert!(before.1.contains("\"signer_trusted\":true"), "{}", before.1);

    // Another machine: an empty place with the backup and the recordings alone.
    let other = Place::new();
    let from = place.path("school.backup");
    let from = from.to_str().expect("plain");
    let restore = |at: &Place| at.run(Program::Server, &["restore", from]);
    restore(&other).ok();
    restore(&other).refused(&["is not empty", "--state"]);
    assert_eq!(grade(&other), before, "the same bytes");
    let list = |at: &Place, line: &str| at.run(Program::Server, &words(line)).ok().stdout;
    for line in ["token list", "class list", "certificate show"] {
        assert_eq!(list(&other, line), list(&place, line), "{line}");
    }
    let log = std::fs::read_to_string(other.path("state").join("audit.jsonl")).expect("a log");
    assert!(log.contains("\"action\":\"restore\""), "{log}");
    let server = other.serve(&["--mode", "exam"]);
    let hand = [
        "run",
        "--server",
        &server.address,
        "--ticket",
        ticket.trim(),
        "--duration",
        "2",
        "--tick",
        "server",
    ];
    other.run(Program::Client, &hand).ok();

    // A machine whose disk has a part of the file.
    let bytes = std::fs::read(from).expect("a backup");
    let third = Place::new();
    std::fs::write(third.path("part"), &bytes[..bytes.len() / 2]).expect("a part");
    third
        .run(Program::Server, &["restore", "part"])
        .refused(&["part is no whole backup"]);
    assert!(!third.path("state").exists());
}
