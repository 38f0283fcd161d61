//! The disk fills up in mid-session: a clear message, and the file so far is whole.
//!
//! A limit on the size of files (`ulimit -f`) stands for the disk: a write beyond it fails in the same way, and it takes no
//! rights to set one. The system would kill the process by SIGXFSZ instead, so every program ignores that signal.
#![cfg(unix)]

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};

use sulcus_sessions::{Ending, Recording};
use sulcus_tests::{Ended, Place, Program};

/// A shell that limits files to `kib` and becomes the program.
fn limited(place: &Place, program: &Path, kib: u64, arguments: &[&str]) -> Command {
    let script = format!("ulimit -f {kib}; exec \"$0\" \"$@\"");
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

/// The one recording has at least this number of rows and is whole as far as it goes: ends where a chunk does, replays,
/// and cannot be graded.
fn is_whole(place: &Place, least: u64) {
    let file = place.recording();
    let recording = Recording::open(&file).expect("it opens");
    let Ending::CutOff { at_byte, why } = recording.ending() else {
        panic!("{}", recording.ending())
    };
    assert_eq!(
        (*at_byte, why.as_str()),
        (recording.len(), "there is no end record")
    );
    assert!(recording.facts().rows >= least, "{:?}", recording.facts());
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
    is_whole(&place, 500);
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
        // The full disk ends the session, on a slow machine late.
        "--duration",
        "600",
        "--tick",
        "server",
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
    // Rows whose ticks were skipped by a busy machine have more messages for viewers between them.
    is_whole(&place, 1);
}

/// A quota killed every program without a word.
#[test]
fn files_beyond_a_limit_are_said_with_exit_code_2() {
    let place = Place::new();
    let corpus = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../sessions/tests/corpus/hard-wedge.mcap"
    );
    let run = |program: Program, arguments: &[&str], kib| {
        let output = limited(&place, program.path(), kib, arguments).output();
        Ended::new(output.expect("it ends"))
    };
    let export = ["export", corpus, "--out", "out", "--csv"];
    run(Program::Sessions, &export, 1).refused(&["out/ticks.csv", "File too large", "quota"]);
    let pages = ["grade", corpus, "--html", "pages"];
    run(Program::Sessions, &pages, 0).refused(&["pages", "File too large"]);
    // Standard output into a file that may not grow.
    let file = std::fs::File::create(place.path("out.txt")).expect("made");
    let output = limited(&place, Program::Sessions.path(), 0, &["info", corpus])
        .stdout(file)
        .output();
    Ended::new(output.expect("it ends"))
        .refused(&["cannot write to standard output", "File too large"]);
}

/// That a tree cannot be kept is no error, and nothing half written stays.
#[test]
fn a_cache_beyond_a_limit_is_done_without() {
    let place = Place::new();
    let scene = "name = \"test\"\n[[tool]]\nname = \"probe\"\nkind = \"periodontal_probe\"\npark_mm = [0, 0, 120]\n[[object]]\nname = \"box\"\nmesh = \"box.obj\"\nunit = \"mm\"\nlevel = 1\nlevels = 1\n";
    std::fs::write(place.path("scene.toml"), scene).expect("written");
    let mut mesh = String::new();
    for k in 0..8 {
        let [x, y, z] = [k & 1, k >> 1 & 1, k >> 2].map(|bit| 10 * bit);
        mesh += &format!("v {x} {y} {z}\n");
    }
    for [a, b, c, d] in [
        [1, 3, 4, 2],
        [5, 6, 8, 7],
        [1, 2, 6, 5],
        [3, 7, 8, 4],
        [1, 5, 7, 3],
        [2, 4, 8, 6],
    ] {
        mesh += &format!("f {a} {b} {c} {d}\n");
    }
    std::fs::write(place.path("box.obj"), mesh).expect("written");
    let cache = place.path("cache");
    let check = ["scene", "check", "scene.toml"];
    let output = limited(&place, Program::Server.path(), 0, &check)
        .env("SULCUS_CACHE", &cache)
        .output();
    Ended::new(output.expect("it ends")).ok();
    let left = std::fs::read_dir(&cache).map_or(0, |entries| entries.count());
    assert_eq!(left, 0);
}
