//! Program.

use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

use sulcus_standin_haply::{
    EndReason, Fault, Log, Motion, Options, Process, Request, Violation, What, find_program, now_ns,
};
use tungstenite::Message;

use crate::client::{ARM, Client, probe, shown, vector, wait_for};

const PROGRAM: &str = env!("CARGO_BIN_EXE_standin-haply");
const CLIENT: &str = env!("CARGO_BIN_EXE_standin-haply-client");

#[test]
fn the_program_serves_faults_and_writes_its_log() {
    let before = now_ns();
    let program = Process::start(
        Path::new(PROGRAM),
        &Options {
            watchdog_ms: 5000.0,
            ..Options::default()
        },
    )
    .unwrap();
    let mut client = Client::raw(program.ready().port).unwrap();
    client.read();
    assert_eq!(shown(&client.push(0.5)), 0.5);
    let at = [0.01, 0.02, 0.03];
    program
        .apply(&Request::Hand {
            device: ARM.into(),
            motion: Motion::Rest { at },
        })
        .unwrap();
    let position = vector(&client.ask(probe()), "cursor_position");
    assert!(
        position.iter().zip(at).all(|(x, y)| (x - y).abs() < 1e-12),
        "{position:?}"
    );
    let fault = program.fault(Fault::DropConnections).unwrap();
    assert!(
        fault > before && fault <= now_ns(),
        "one clock for both processes"
    );
    assert!(client.text().is_err());
    assert!(
        program
            .apply(&Request::Turn {
                device: "x".into(),
                turn: rest()
            })
            .is_err()
    );
    let log = program.stop().unwrap();
    assert_eq!(log.messages(), 2);
    assert_eq!(log.count(Violation::Pipelined), 0);
    assert_eq!(log.entries.last().unwrap().what, What::Stopped);
    assert_eq!(
        find_program().unwrap().file_name(),
        Path::new(PROGRAM).file_name()
    );
}

fn rest() -> sulcus_standin_haply::Turn {
    sulcus_standin_haply::Turn::Rest {
        at: [1.0, 0.0, 0.0, 0.0],
    }
}

#[test]
fn the_log_outlives_a_killed_client() {
    let program = Process::start(Path::new(PROGRAM), &Options::default()).unwrap();
    // The client sends forces until it is killed.
    let port = program.ready().port.to_string();
    let mut child = Command::new(CLIENT)
        .args([&port, ARM, "0.3"])
        .spawn()
        .unwrap();
    assert!(wait_for(|| program.log().unwrap().messages() > 20));
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(wait_for(|| !program.log().unwrap().idles(ARM).is_empty()));
    let lost = |what: &What| {
        matches!(
            what,
            What::Ended {
                reason: EndReason::Lost,
                ..
            }
        )
    };
    let log = program.log().unwrap();
    assert!(log.entries.iter().any(|entry| lost(&entry.what)));
    let idle = *log.idles(ARM).last().unwrap();
    assert_eq!(idle.after_ns(), 20_000_000);
    assert_eq!(log.largest_force(ARM), 0.3);
}

#[test]
fn the_log_of_a_killed_program_is_readable_and_appended_to() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("haply.log");
    let options = Options {
        log: Some(log.clone()),
        ..Options::default()
    };
    for round in 1..=2 {
        let mut program = Process::start(Path::new(PROGRAM), &options).unwrap();
        let mut client = Client::raw(program.ready().port).unwrap();
        client.read();
        client.push(0.1);
        assert!(wait_for(|| program.log().unwrap().messages() == round));
        program.kill().unwrap();
        while client.socket.read().is_ok() {}
        assert!(client.socket.send(Message::text("{}")).is_err());
    }
    assert_eq!(Log::read(&log).unwrap().connections(), 2);
}

#[test]
fn wrong_input_gets_an_error() {
    let mut child = Command::new(PROGRAM)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    writeln!(
        child.stdin.as_mut().unwrap(),
        "nonsense\n\"now\"\n{{\"fault\":{{\"stall\":{{\"ms\":1}}}}}}"
    )
    .unwrap();
    let output = child.wait_with_output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    let starts: Vec<_> = text
        .lines()
        .map(|line| line.split(' ').next().unwrap())
        .collect();
    assert_eq!(starts, ["ready", "error", "ok", "ok"]);
    assert!(output.status.success());
}
