//! The disk fills up in mid-session: a clear message, and the file so far is whole.
//!
//! A limit on the size of files stands for the disk: what is written beyond it fails in the same way, and it takes no rights
//! to set one. (Without `trap` the system would end the process instead, which is the business of the tests of kill -9.)
#![cfg(unix)]

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};

use sulcus_sessions::{Ending, Recording};
use sulcus_tests::{Ended, Place, Program};

/// A shell that limits files to `kib` and becomes the program.
fn limited(place: &Place, program: &Path, kib: u64, arguments: &[&str]) -> Command {
    let script = format!("trap '' XFSZ; ulimit -f {kib}; exec \"$0\" \"$@\"");
    let mut command = place.command(Path::new("bash"));
    command.args(["-c", &script]).arg(program).args(arguments);
    command
}

/// Length of a recording's beginning, KiB: header and scene, which must fit.
fn beginning_kib(place: &Place) -> u64 {
    let short = [
        "demo",
        "--virtual",
        "--exercise",
        "crown",
        "--duration",
        "0.2",
        "--recordings",
        "short",
        "--json",
    ];
    let said = place.run(Program::Client, &short).ok().json();
    let file = place.path(said["recording"].as_str().expect("a path"));
    std::fs::metadata(file).expect("there").len() / 1024
}

/// The one recording is whole as far as it goes: ends where a chunk does, replays, and cannot be graded.
fn is_whole(place: &Place) {
    let file = place.recording();
    let recording = Recording::open(&file).expect("it opens");
    let Ending::CutOff { at_byte, why } = recording.ending() else {
        panic!("{}", recording.ending())
    };
    assert_eq!(
        (*at_byte, why.as_str()),
        (recording.len(), "there is no end record")
    );
    assert!(recording.facts().rows > 500, "{:?}", recording.facts());
    let replay = place.run(
        Program::Sessions,
        &["replay", file.to_str().expect("plain"), "--json"],
    );
    let replay = replay.json();
    assert_eq!(
        (&replay["identical"], &replay["gradable"]),
        (&true.into(), &false.into()),
        "{replay}"
    );
    let whole = place.path("whole.mcap");
    let names = [&file, &whole].map(|path| path.to_str().expect("plain").to_owned());
    place
        .run(
            Program::Sessions,
            &["info", &names[0], "--recover", &names[1]],
        )
        .ok();
}

#[test]
fn the_demo_says_that_the_recording_stopped_and_leaves_a_whole_file() {
    let place = Place::new();
    let kib = beginning_kib(&place) + 300;
    let demo = [
        "demo",
        "--virtual",
        "--exercise",
        "crown",
        "--duration",
        "20",
        "--json",
    ];
    let ended = limited(&place, Program::Client.path(), kib, &demo)
        .output()
        .expect("starts");
    let ended = Ended::new(ended);
    ended.refused(&["recording stopped", "File too large"]);
    is_whole(&place);
}

#[test]
fn a_server_ends_the_session_tells_the_client_and_serves_the_next() {
    let place = Place::new();
    let kib = beginning_kib(&place) + 300;
    let serve = ["serve", "--listen", "127.0.0.1:0", "--json"];
    let mut server = limited(&place, Program::Server.path(), kib, &serve)
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .expect("the server starts");
    let mut first = String::new();
    BufReader::new(server.stdout.take().expect("piped"))
        .read_line(&mut first)
        .expect("a line");
    let said: serde_json::Value = serde_json::from_str(&first).expect("JSON");
    let of = |field: &str| said[field].as_str().expect("text").to_owned();
    let (address, ticket) = (of("address"), of("ticket"));
    let run = [
        "run",
        "--server",
        &address,
        "--ticket",
        &ticket,
        "--duration",
        "30",
        "--json",
    ];
    let ended = place.run(Program::Client, &run);
    server.kill().expect("it still ran");
    server.wait().expect("it is gone");
    let told = ended.json();
    assert_eq!(told["server_lost"], false, "{ended:#?}");
    assert_eq!(told["session"]["end"], "recording", "{ended:#?}");
    assert_eq!(told["session"]["complete"], false, "{ended:#?}");
    let text = format!("{}{}", ended.stdout, ended.stderr);
    assert!(
        text.contains("could not be written") && text.contains("File too large"),
        "{ended:#?}"
    );
    assert_ne!(ended.code, 0, "{ended:#?}");
    // The hand was let go.
    assert_eq!(told["device"]["last_displayed_n"], 0.0, "{ended:#?}");
    is_whole(&place);
}
