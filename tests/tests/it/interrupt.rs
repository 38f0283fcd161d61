//! Ends that are not the plain end: Ctrl-C, a terminal that is gone, the server's time limit. Nothing good is lost.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::Stdio;

use sulcus_tests::{Ended, Place, Program, Serving, signal};

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
    place.begun("recordings");
    signal("-INT", &demo);
    let ended = Ended::new(demo.wait_with_output().expect("it ends")).ok();
    let said = ended.json();
    let ticks = said["ticks"].as_u64().expect("ticks");
    assert!((1..60_000).contains(&ticks), "{said}");
    assert_eq!(
        (&said["identical"], &said["gradable"]),
        (&true.into(), &true.into()),
        "{said}"
    );
}

#[test]
fn an_interrupted_client_lets_the_hand_go_before_it_leaves() {
    let place = Place::new();
    let server = place.serve(&[]);
    let session = place.join(&server);
    place.touched();
    signal("-INT", &session);
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
fn a_server_whose_terminal_hangs_up_leaves_a_finished_gradable_recording() {
    let place = Place::new();
    // (Where the tests run under `nohup`, hang-ups are ignored: not here.)
    let mut process = place
        .command(Path::new("env"))
        .arg("--default-signal=HUP")
        .arg(Program::Server.path())
        .args(["serve", "--listen", "127.0.0.1:0", "--json"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the server starts");
    let mut first = String::new();
    BufReader::new(process.stdout.take().expect("piped"))
        .read_line(&mut first)
        .expect("a first line");
    // A terminal that is gone takes no words either.
    drop(process.stderr.take());
    let said: serde_json::Value = serde_json::from_str(&first).expect("JSON");
    let text = |field: &str| said[field].as_str().expect("text").to_owned();
    let mut server = Serving {
        address: text("address"),
        ticket: text("ticket"),
        console: None,
        process,
    };
    let session = place.join(&server);
    place.begun("recordings");
    signal("-HUP", &server.process);
    let ended = Ended::new(session.wait_with_output().expect("it ends"));
    let said = ended.json();
    assert_eq!(said["session"]["end"], "shutdown", "{said}");
    assert!(server.process.wait().expect("it ends").success());
    let file = place.recording();
    let replay = place.run(
        Program::Sessions,
        &["replay", "--json", file.to_str().expect("plain")],
    );
    assert_eq!(replay.ok().json()["gradable"], true);
}

#[test]
fn the_servers_time_limit_is_its_word_and_not_a_loss() {
    let place = Place::new();
    let server = place.serve(&["--max-session", "2"]);
    let ended = place.perform(&server, &["--duration", "30"]).ok();
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
