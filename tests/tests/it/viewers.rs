//! Channels for viewers on demand, from the server's setting to the made file: a session with readings, a pause and a
//! gap.

use std::collections::BTreeMap;
use std::io::Write as _;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;
use sulcus_sessions::{Message, Recording};
use sulcus_tests::{Ended, Place, Program, Serving, files_with};

/// Length of a session, seconds.
const DURATION_S: &str = "20";

/// Sends a signal to a client.
fn send(signal: &str, client: &Child) {
    let sent = Command::new("kill")
        .args([signal, &client.id().to_string()])
        .status()
        .expect("kill runs");
    assert!(sent.success());
}

/// Gives lines of an instructor to the server.
fn instruct(place: &Place, server: &Serving, lines: &str) {
    let mut child = place
        .command(Program::Client.path())
        .env(
            "SULCUS_TICKET",
            std::fs::read_to_string(place.path("t"))
                .expect("a ticket")
                .trim(),
        )
        .args(["monitor", "--server", &server.address, "--json"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the client starts");
    let mut to = child.stdin.take().expect("piped");
    to.write_all(lines.as_bytes()).expect("it reads");
    drop(to);
    Ended::new(child.wait_with_output().expect("it ends")).ok();
}

/// Performs a session of the exercise `probing`: called readings, a pause by the instructor, and a hand that is gone
/// until its connection is lost.
fn perform(place: &Place, arguments: &[&str]) -> String {
    let arguments = [&["--exercise", "probing", "--no-admission"], arguments].concat();
    let server = place.serve(&arguments);
    let add = ["token", "add", "--role", "instructor", "--out", "t"];
    place.run(Program::Server, &add).ok();
    let mut client = place
        .command(Program::Client.path())
        .args(["run", "--server", &server.address])
        .args(["--ticket", &server.ticket, "--exercise", "probing"])
        .args(["--duration", DURATION_S, "--readings", "--json"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the client starts");
    let mut typed = client.stdin.take().expect("piped");
    let patience = Instant::now() + Duration::from_secs(120);
    while files_with(&place.path("recordings"), "mcap").is_empty() {
        assert!(Instant::now() < patience, "no session began");
        std::thread::sleep(Duration::from_millis(20));
    }
    std::thread::sleep(Duration::from_secs(2));
    typed.write_all(b"36 MB 5 -2 b\n").expect("it reads");
    instruct(place, &server, "pause station\nquit\n");
    std::thread::sleep(Duration::from_millis(500));
    instruct(place, &server, "resume station\nlimit station 0.5\nquit\n");
    send("-STOP", &client);
    std::thread::sleep(Duration::from_millis(4500));
    send("-CONT", &client);
    let _ = typed.write_all(b"36 b 3 nb f1\n");
    drop(typed);
    Ended::new(client.wait_with_output().expect("it ends")).ok();
    place.recording().to_str().expect("plain").to_owned()
}

/// Result of a command of `sulcus-sessions` that succeeds.
fn told(place: &Place, arguments: &[&str]) -> Value {
    place.run(Program::Sessions, arguments).ok().json()
}

/// Number of messages by topic.
fn counts(file: &Path) -> BTreeMap<String, usize> {
    let bytes = std::fs::read(file).expect("a file");
    let mut counts = BTreeMap::new();
    for message in mcap::MessageStream::new(&bytes).expect("MCAP") {
        let topic = message.expect("a message").channel.topic.clone();
        *counts.entry(topic).or_default() += 1;
    }
    counts
}

/// Lines of the log of a recording.
fn lines(file: &str) -> Vec<String> {
    let recording = Recording::open(file.as_ref()).expect("a recording");
    let text = |message: Result<Message, _>| match message.expect("a message") {
        Message::Event(event) => Some(event.text),
        _ => None,
    };
    recording.messages().filter_map(text).collect()
}

/// Asserts that the session had all that could set a made channel apart from a live one.
fn had_everything(file: &str) {
    let lines = lines(file);
    for kind in ["paused", "resumed", "detached", "attached", "reading"] {
        let found = lines.iter().any(|line| line.starts_with(kind));
        assert!(found, "no `{kind}`: {lines:#?}");
    }
}

#[test]
fn a_station_that_records_no_channels_has_them_made_as_it_would_have_recorded_them() {
    let place = Place::new();
    let file = perform(&place, &["--viewers", "on-demand"]);
    had_everything(&file);
    let before = told(&place, &["info", &file, "--json"]);
    assert_eq!(before["viewers"], "on_demand", "{before}");
    let kept = counts(file.as_ref());
    assert!(kept.contains_key("/session/metrics") && !kept.contains_key("/tf"));
    // The station signed a hash over the messages of the live session.
    told(&place, &["viewers", &file, "--out", "made.mcap", "--json"]);
    let after = told(&place, &["info", "made.mcap", "--json"]);
    assert_eq!(after["viewers"], "as_signed", "{after}");
    for field in ["signature", "ticks", "events", "snapshots", "end"] {
        assert_eq!(before[field], after[field], "{field}");
    }
    let made = counts(&place.path("made.mcap"));
    let moved = |(topic, count): (&String, &usize)| topic.starts_with("/objects/") && *count > 1;
    assert!(made.iter().any(moved), "{made:?}");
    assert!(made["/tf"] > 100 && made["/log"] > 5, "{made:?}");
    // Grade and export need no channels.
    let grade = |file: &str| told(&place, &["grade", file, "--json"])["score"].clone();
    assert_eq!(grade(&file), grade("made.mcap"));
    told(&place, &["export", &file, "--out", "tables", "--json"]);
    let again = ["viewers", "made.mcap", "--out", "again.mcap"];
    place
        .run(Program::Sessions, &again)
        .refused(&["made.mcap", "are in the recording"]);
}

#[test]
fn recorded_channels_are_those_that_a_replay_makes() {
    let place = Place::new();
    let file = perform(&place, &[]);
    had_everything(&file);
    assert!(counts(file.as_ref())["/tf"] > 100);
    let compared = told(&place, &["viewers", &file, "--json"]);
    assert_eq!(compared["identical"], true, "{compared}");
    place
        .run(Program::Sessions, &["viewers", &file, "--out", "new.mcap"])
        .refused(&["are in the recording"]);
}
