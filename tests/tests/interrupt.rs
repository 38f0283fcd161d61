//! Ends that are not the plain end: Ctrl-C, the server's time limit. Nothing good is lost.

use std::process::{Command, Stdio};
use std::time::Duration;

use sulcus_tests::{Ended, Place, Program};

/// Sends SIGINT, as Ctrl-C does.
fn interrupt(process: u32) {
    let sent = Command::new("kill")
        .args(["-INT", &process.to_string()])
        .status()
        .expect("kill runs");
    assert!(sent.success());
}

#[test]
fn an_interrupted_demo_is_finished_signed_and_gradable() {
    let place = Place::new();
    // The scene is cached by a first short run, so that the interruption meets the session.
    place
        .run(
            Program::Client,
            &[
                "demo",
                "--virtual",
                "--exercise",
                "crown",
                "--duration",
                "1",
                "--recordings",
                "first",
            ],
        )
        .ok();
    let demo = place
        .command(Program::Client.path())
        .args(["demo", "--exercise", "crown", "--duration", "60", "--json"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the demo starts");
    std::thread::sleep(Duration::from_secs(3));
    interrupt(demo.id());
    let ended = Ended::new(demo.wait_with_output().expect("it ends")).ok();
    let said = ended.json();
    let ticks = said["ticks"].as_u64().expect("ticks");
    assert!((100..50_000).contains(&ticks), "{said}");
    assert_eq!(
        (&said["identical"], &said["gradable"]),
        (&true.into(), &true.into()),
        "{said}"
    );
}

#[test]
fn an_interrupted_client_lets_the_hand_go_before_it_leaves() {
    Program::Client.path();
    let place = Place::new();
    let server = place.serve(&[]);
    let session = place.join(&server);
    // Long enough to be in contact.
    std::thread::sleep(Duration::from_secs(5));
    interrupt(session.id());
    let ended = Ended::new(session.wait_with_output().expect("it ends")).ok();
    let said = ended.json();
    let device = &said["device"];
    assert_eq!(device["interrupted"], true, "{said}");
    assert!(
        device["max_displayed_n"].as_f64().expect("a force") > 0.05,
        "it never touched: {said}"
    );
    assert_eq!(device["last_displayed_n"], 0.0, "{said}");
    assert!(
        device["max_displayed_step_n"].as_f64().expect("a force") <= 0.5 + 1e-9,
        "{said}"
    );
    assert_eq!(said["session"]["end"], "stopped", "{said}");
}

#[test]
fn the_servers_time_limit_is_its_word_and_not_a_loss() {
    let place = Place::new();
    let server = place.serve(&["--max-session", "2"]);
    let run = [
        "run",
        "--server",
        &server.address,
        "--ticket",
        &server.ticket,
        "--duration",
        "30",
        "--json",
    ];
    let ended = place.run(Program::Client, &run).ok();
    let said = ended.json();
    assert_eq!(said["server_lost"], false, "{said}");
    assert_eq!(said["session"]["end"], "time_up", "{said}");
    assert_eq!(said["device"]["last_displayed_n"], 0.0, "{said}");
    let replay = place.run(
        Program::Sessions,
        &[
            "replay",
            "--json",
            place.recording().to_str().expect("plain"),
        ],
    );
    assert_eq!(replay.ok().json()["gradable"], true);
}
