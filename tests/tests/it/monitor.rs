//! `sulcus-client monitor`: the table, typed instructions and their answers, tickets of other roles.

use std::io::Write as _;
use std::process::Stdio;

use serde_json::Value;
use sulcus_tests::{Ended, Place, Program, Serving};

/// Ticket of a role, made in the state folder of the place.
fn ticket(place: &Place, role: &str) -> String {
    let out = format!("{role}.ticket");
    place
        .run(
            Program::Server,
            &["token", "add", "--role", role, "--out", &out],
        )
        .ok();
    let text = std::fs::read_to_string(place.path(&out)).expect("a ticket");
    text.trim().to_owned()
}

/// Runs the monitor with lines on standard input.
fn typing(place: &Place, server: &Serving, ticket: &str, more: &[&str], lines: &str) -> Ended {
    let mut child = place
        .command(Program::Client.path())
        .env("SULCUS_TICKET", ticket)
        .args(["monitor", "--server", &server.address])
        .args(more)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the client starts");
    let mut to = child.stdin.take().expect("piped");
    to.write_all(lines.as_bytes()).expect("it reads");
    drop(to);
    Ended::new(child.wait_with_output().expect("it ends"))
}

/// JSON objects of a kind.
fn objects(ended: &Ended, kind: &str) -> Vec<Value> {
    let lines = ended
        .stdout
        .lines()
        .map(|line| serde_json::from_str::<Value>(line).expect("JSON"));
    lines.filter(|object| !object[kind].is_null()).collect()
}

#[test]
fn an_instructor_sees_a_station_and_instructs_it_by_lines() {
    let place = Place::new();
    let server = place.serve(&["--exercise", "crown", "--no-admission"]);
    for role in ["instructor", "examiner", "admin"] {
        let ticket = ticket(&place, role);
        let once = typing(&place, &server, &ticket, &["--once"], "").ok();
        assert!(once.stdout.starts_with("station "), "{role}: {once:#?}");
        assert!(
            once.stdout
                .lines()
                .any(|line| line.starts_with("station      free")),
            "{once:#?}"
        );
    }
}

#[test]
fn lines_are_answered_and_wrong_ones_named() {
    let place = Place::new();
    let server = place.serve(&["--exercise", "crown", "--no-admission"]);
    let ticket = ticket(&place, "instructor");
    let lines = "pause station\nlimit station 0.5\nstop station\npause elsewhere\nnote station too late\nresume station\nquit\n";
    let ended = typing(&place, &server, &ticket, &["--json"], lines).ok();
    let answers: Vec<(bool, String)> = objects(&ended, "answer")
        .iter()
        .map(|object| {
            let answer = &object["answer"];
            (
                answer["taken"] == true,
                answer["text"].as_str().unwrap_or_default().to_owned(),
            )
        })
        .collect();
    let taken: Vec<bool> = answers.iter().map(|answer| answer.0).collect();
    assert_eq!(taken, [true, true, false, false, true], "{answers:?}");
    assert!(
        answers[2].1.contains("`elsewhere`") && answers[3].1.contains("no session runs"),
        "{answers:?}"
    );
    let plain = typing(
        &place,
        &server,
        &ticket,
        &[],
        "pause station\nstop station\nquit\n",
    )
    .ok();
    assert!(
        plain
            .stdout
            .contains("station: in force for the next session"),
        "{plain:#?}"
    );
    assert!(
        plain.stdout.contains("error: `stop` is unknown"),
        "{plain:#?}"
    );
    let errors = objects(&ended, "error");
    assert_eq!(errors.len(), 1, "{errors:?}");
    assert!(
        errors[0]["error"]
            .as_str()
            .is_some_and(|text| text.contains("`stop` is unknown")),
        "{errors:?}"
    );
}

#[test]
fn a_student_and_a_wrong_server_are_refused_with_a_sentence() {
    let place = Place::new();
    let server = place.serve(&["--exercise", "crown", "--no-admission"]);
    let student = ticket(&place, "student");
    typing(&place, &server, &student, &["--once"], "").refused(&["role student", "instructor"]);
    typing(&place, &server, "nonsense", &["--once"], "").refused(&["ticket"]);
    place
        .run(
            Program::Client,
            &["monitor", "--server", &server.address, "--once"],
        )
        .refused(&["ticket is missing", "token add --role instructor"]);
}
