//! Output whose reader goes away, a disk that takes no output: never a panic, and the work is done.

use std::fs::{File, OpenOptions};
use std::io::{BufRead, BufReader, Read as _};
use std::net::{SocketAddr, UdpSocket};
use std::process::{Child, ChildStderr, ChildStdout, Stdio};
use std::time::{Duration, Instant};

use sulcus_sessions::{Ending, Recording};
use sulcus_tests::{Ended, LIMIT, Place, Program, files_with, signal};

/// Commands of each program that print, whose work is short, and their exit codes.
const COMMANDS: [(Program, &[&str], i32); 11] = [
    (Program::Client, &["--help"], 0),
    (Program::Client, &["--version"], 0),
    (Program::Client, &["demo", "--list-exercises"], 0),
    (Program::Client, DEMO, 0),
    (Program::Server, &["--help"], 0),
    (Program::Server, &["scene", "check", SCENE, "--json"], 0),
    (Program::Sessions, &["--help"], 0),
    (Program::Sessions, &["info", RECORDING], 0),
    (Program::Sessions, &["replay", RECORDING, RECORDING], 0),
    // Nothing in this recording can be graded: a finding.
    (Program::Sessions, &["grade", RECORDING, "--json"], 1),
    (
        Program::Sessions,
        &["export", RECORDING, "--out", "export"],
        0,
    ),
];

const DEMO: &[&str] = &[
    "demo",
    "--virtual",
    "--exercise",
    "crown",
    "--duration",
    "0.5",
];

const SCENE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../server/scenes/crown.toml");

const RECORDING: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../sessions/tests/corpus/hard-wedge.mcap"
);

fn full() -> File {
    let full = OpenOptions::new().write(true).open("/dev/full");
    full.expect("/dev/full")
}

fn quiet(ended: &Ended) {
    assert!(!ended.stderr.contains("panicked"), "{ended:#?}");
    assert!(!ended.stderr.contains("Broken pipe"), "{ended:#?}");
}

/// `println!` panics when the reader has gone: exit code 101, and a backtrace over the terminal.
#[test]
fn a_reader_that_goes_away_ends_nothing_and_changes_no_exit_code() {
    for (program, arguments, expected) in COMMANDS {
        // Closed before the first line; and after it.
        for lines in [0, 1] {
            let place = Place::new();
            let mut child = place
                .command(program.path())
                .args(arguments)
                .stdout(Stdio::piped())
                .stderr(Stdio::piped())
                .spawn()
                .expect("it starts");
            let mut reader = BufReader::with_capacity(1, child.stdout.take().expect("piped"));
            for _ in 0..lines {
                reader.read_line(&mut String::new()).expect("a line");
            }
            drop(reader);
            let ended = Ended::new(child.wait_with_output().expect("it ends"));
            quiet(&ended);
            assert_eq!(ended.code, expected, "{arguments:?}: {ended:#?}");
        }
    }
}

#[test]
fn a_full_disk_behind_standard_output_is_said_with_exit_code_2() {
    for (program, arguments, _) in COMMANDS {
        let place = Place::new();
        let output = place
            .command(program.path())
            .args(arguments)
            .stdout(full())
            .output()
            .expect("it ends");
        let ended = Ended::new(output);
        quiet(&ended);
        assert_eq!(ended.code, 2, "{arguments:?}: {ended:#?}");
        assert!(
            ended.stderr.contains("cannot write to standard output"),
            "{arguments:?}: {ended:#?}"
        );
    }
}

#[test]
fn standard_error_that_takes_nothing_changes_nothing() {
    for (program, arguments, expected) in COMMANDS {
        let run = |stderr: Stdio| {
            let output = Place::new()
                .command(program.path())
                .args(arguments)
                .stderr(stderr)
                .output();
            Ended::new(output.expect("it ends"))
        };
        let ended = run(full().into());
        assert_eq!(ended.code, expected, "{arguments:?}: {ended:#?}");
        // A pipe whose reader has gone.
        let (reader, writer) = std::io::pipe().expect("a pipe");
        drop(reader);
        let ended = run(writer.into());
        assert_eq!(ended.code, expected, "{arguments:?}: {ended:#?}");
        // Wrong usage says so nowhere, and still has its exit code.
        let (reader, writer) = std::io::pipe().expect("a pipe");
        drop(reader);
        let output = Place::new()
            .command(program.path())
            .arg("--no-such-option")
            .stderr(writer)
            .output();
        assert_eq!(Ended::new(output.expect("it ends")).code, 2);
    }
}

/// A server with its log and output in these; the first line of its output, when that can be read.
fn serve(place: &Place, stdout: Stdio, stderr: Stdio) -> Child {
    place
        .command(Program::Server.path())
        .args(["serve", "--listen", "127.0.0.1:0", "--json"])
        .args(["--token", "t", "--certificate-out", "server.der"])
        .env("SULCUS_LOG", "debug")
        .stdout(stdout)
        .stderr(stderr)
        .spawn()
        .expect("the server starts")
}

fn first_line(stdout: &mut BufReader<ChildStdout>) -> serde_json::Value {
    let mut line = String::new();
    stdout.read_line(&mut line).expect("a line");
    serde_json::from_str(&line).expect("JSON")
}

fn session(place: &Place, address: &str) -> Ended {
    let run = ["run", "--server", address, "--token", "t"];
    let more = ["--certificate", "server.der", "--duration", "1"];
    let last = ["--tick", "server", "--json"];
    place.run(Program::Client, &[&run[..], &more, &last].concat())
}

fn stop(mut server: Child) -> i32 {
    signal("-TERM", &server);
    let began = Instant::now();
    while began.elapsed() < LIMIT {
        if let Some(status) = server.try_wait().expect("waits") {
            return status.code().unwrap_or(-1);
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    let _ = server.kill();
    panic!("the server does not end");
}

/// The reader of its log and of its output may end at any time: `serve --json | head -1`, a log collector that is restarted.
#[test]
fn a_station_whose_log_pipe_closes_keeps_ticking_and_recording() {
    let place = Place::new();
    let mut server = serve(&place, Stdio::piped(), Stdio::piped());
    let mut stdout = BufReader::with_capacity(1, server.stdout.take().expect("piped"));
    let said = first_line(&mut stdout);
    drop(stdout);
    let mut stderr = server.stderr.take().expect("piped");
    let mut some = [0; 1];
    // (The log of a debug run begins at once.)
    let _ = stderr.read(&mut some);
    drop(stderr);
    let address = said["address"].as_str().expect("an address");
    for session_number in 1..=2 {
        let ended = session(&place, address).ok().json();
        assert_eq!(ended["session"]["complete"], true, "{ended}");
        let ticks = ended["session"]["ticks"].as_u64().expect("ticks");
        assert!(ticks > 0, "{ended}");
        let files = files_with(&place.path("recordings"), "mcap");
        assert_eq!(files.len(), session_number);
    }
    assert_eq!(stop(server), 0);
    for file in files_with(&place.path("recordings"), "mcap") {
        let recording = Recording::open(&file).expect("it opens");
        assert!(matches!(recording.ending(), Ending::Finished));
    }
}

/// A server whose output is on a full disk, after it has said so; its named address, and its log, which stays open.
///
/// The port was free a moment ago. Another process may take it before the server does: then another port is tried.
fn serve_on_a_full_disk(place: &Place) -> (Child, SocketAddr, BufReader<ChildStderr>) {
    for _ in 0..20 {
        let free = UdpSocket::bind("127.0.0.1:0").and_then(|socket| socket.local_addr());
        let address = free.expect("a port");
        let mut server = place
            .command(Program::Server.path())
            .args(["serve", "--listen", &address.to_string()])
            .args(["--token", "t", "--certificate-out", "server.der"])
            .stdout(full())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the server starts");
        let mut stderr = BufReader::new(server.stderr.take().expect("piped"));
        let mut told = String::new();
        while stderr.read_line(&mut told).expect("a line") > 0 {
            if told.contains("cannot write to standard output") {
                return (server, address, stderr);
            }
        }
        server.wait().expect("it ends");
        assert!(told.contains(&address.to_string()), "{told}");
    }
    panic!("no port stays free");
}

/// Nobody can read the address then, but a port may have been named, and the sessions are worth more than a line.
#[test]
fn a_station_whose_output_is_on_a_full_disk_serves_and_says_so_at_the_end() {
    let place = Place::new();
    let (server, address, _stderr) = serve_on_a_full_disk(&place);
    let ended = session(&place, &address.to_string()).ok().json();
    assert_eq!(ended["session"]["complete"], true, "{ended}");
    assert_eq!(stop(server), 2);
}
