//! Channels for viewers on demand, from the server's setting to the made file: a session with readings, a pause and a
//! gap.

use std::collections::BTreeMap;
use std::io::Write as _;
use std::path::Path;
use std::process::Stdio;
use std::time::{Duration, Instant};

use serde_json::Value;
use sulcus_relay::Relay;
use sulcus_sessions::{Message, Recording};
use sulcus_tests::{Ended, LIMIT, Place, Program, Serving, signal};

/// Rows with a force after which the hand has moved what it presses.
const PRESSED: usize = 1000;

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

/// Waits until a recording that is still being written fulfils a condition.
pub fn until(file: &Path, what: &str, holds: impl Fn(&Recording) -> bool) {
    let began = Instant::now();
    while !Recording::open(file).is_ok_and(|recording| holds(&recording)) {
        assert!(began.elapsed() < LIMIT, "no {what} in {}", file.display());
        std::thread::sleep(Duration::from_millis(100));
    }
}

/// Lines of the log of a recording. A message that is still being written is left out.
pub fn lines(recording: &Recording) -> Vec<String> {
    let text = |message: Result<Message, _>| match message {
        Ok(Message::Event(event)) => Some(event.text),
        _ => None,
    };
    recording.messages().filter_map(text).collect()
}

/// Waits until the log of a recording has a line of this kind.
fn logged(file: &Path, kind: &str) {
    until(file, kind, |recording| {
        lines(recording).iter().any(|line| line.starts_with(kind))
    });
}

/// Number of rows with a force of more than 0.05 N on the first tool.
fn pressed(recording: &Recording) -> usize {
    let presses = |message: &Result<Message, _>| match message {
        Ok(Message::Row(row)) => row.wrench[0][..3].iter().any(|x| x.abs() > 0.05),
        _ => false,
    };
    recording.messages().filter(presses).count()
}

/// Performs a session of the exercise `probing`: called readings, a pause by the instructor, and a cable that is pulled
/// until the connection is lost. The session ends when all of it is in the recording.
fn perform(place: &Place, arguments: &[&str]) -> String {
    let serve = [
        "--exercise",
        "probing",
        "--no-admission",
        "--resume-within",
        "600",
    ];
    let server = place.serve(&[&serve[..], arguments].concat());
    let relay = Relay::to(server.address.parse().expect("an address")).expect("a relay");
    let cable = relay.address().to_string();
    let add = ["token", "add", "--role", "instructor", "--out", "t"];
    place.run(Program::Server, &add).ok();
    let mut client = place
        .command(Program::Client.path())
        .args(["run", "--server", &cable])
        .args(["--ticket", &server.ticket, "--exercise", "probing"])
        .args(["--duration", "600", "--tick", "server"])
        .args(["--readings", "--json"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the client starts");
    let mut typed = client.stdin.take().expect("piped");
    let file = place.begun("recordings");
    typed.write_all(b"36 MB 5 -2 b\n").expect("it reads");
    logged(&file, "reading");
    // The hand goes on in pauses and gaps: it may have finished after them.
    until(&file, "pressing hand", |recording| {
        pressed(recording) >= PRESSED
    });
    instruct(place, &server, "pause station\nquit\n");
    logged(&file, "paused");
    instruct(place, &server, "resume station\nlimit station 0.5\nquit\n");
    logged(&file, "resumed");
    relay.cut(true);
    logged(&file, "detached");
    relay.cut(false);
    logged(&file, "attached");
    typed.write_all(b"36 b 3 nb f1\n").expect("it reads");
    drop(typed);
    signal("-INT", &client);
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

/// Asserts that the session had all that could set a made channel apart from a live one.
fn had_everything(file: &str) {
    let recording = Recording::open(file.as_ref()).expect("a recording");
    let lines = lines(&recording);
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
    // A row in sixteen has a message at least.
    assert!(made["/tf"] > PRESSED / 20, "{made:?}");
    assert!(made["/log"] > 5, "{made:?}");
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
    assert!(counts(file.as_ref())["/tf"] > PRESSED / 20);
    let compared = told(&place, &["viewers", &file, "--json"]);
    assert_eq!(compared["identical"], true, "{compared}");
    place
        .run(Program::Sessions, &["viewers", &file, "--out", "new.mcap"])
        .refused(&["are in the recording"]);
}
