//! The image: settings, size, user, and a session of a client outside of it.

use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use sulcus_link::schedule::may_fifo;
use sulcus_sessions::{Ending, Recording};
use sulcus_support::Resource;
use sulcus_tests::{Image, LIMIT, Place, Program, signal};

/// Largest size of the unpacked image with the console, megabytes, of the programs of the tests: these are half as large
/// again as those of a release, whose limit of 80 `docker/release` checks.
const LARGEST_MB: u32 = 100;

/// Scheduling policies of the kernel.
const OTHER: u32 = 0;
const FIFO: u32 = 1;

/// Scheduling policy of a thread by its name; `None`: there is no such thread.
fn policy(process: u32, thread: &str) -> Option<u32> {
    let tasks = std::fs::read_dir(format!("/proc/{process}/task")).ok()?;
    tasks.flatten().find_map(|task| {
        let stat = std::fs::read_to_string(task.path().join("stat")).ok()?;
        let (name, fields) = stat.split_once('(')?.1.rsplit_once(") ")?;
        // The 41st field of all; two stand before these.
        let policy = fields.split(' ').nth(38)?.parse().ok()?;
        (name == thread).then_some(policy)
    })
}

#[test]
fn a_session_of_a_client_outside_is_recorded_graded_and_found_after_the_end() {
    let Some(image) = Resource::Image.or_skip(Image::new()) else {
        return;
    };
    if let Some((_, rest)) = image.printed.split_once("unpacked  ") {
        let size: u32 = rest
            .split(' ')
            .next()
            .and_then(|size| size.parse().ok())
            .expect("a size");
        assert!(size <= LARGEST_MB, "the unpacked image has {size} MB");
    }
    let settings = image.settings();
    assert_eq!(settings["User"], "10001:10001", "{settings}");
    assert_eq!(settings["StopSignal"], "SIGTERM", "{settings}");
    assert_eq!(settings["Entrypoint"][0], "/usr/local/bin/sulcus-server");
    assert_eq!(settings["Cmd"][0], "serve", "{settings}");
    for volume in ["/recordings", "/var/lib/sulcus"] {
        assert!(settings["Volumes"].get(volume).is_some(), "{settings}");
    }
    for absent in ["bin/sh", "usr/bin/dpkg", "usr/bin/apt-get", "usr/bin/env"] {
        assert!(!image.root().join(absent).exists(), "{absent} in the image");
    }
    let program = image.root().join("usr/local/bin/sulcus-server");
    let rights = Command::new("getcap")
        .arg(program)
        .output()
        .expect("getcap");
    let rights = String::from_utf8_lossy(&rights.stdout).into_owned();
    // Permitted alone: a runtime that withholds the rights starts the program all the same.
    assert!(
        rights.trim().ends_with("cap_ipc_lock,cap_sys_nice=p"),
        "{rights}"
    );

    let place = Place::with_image(image);
    let mut server = place.serve(&["--exercise", "crown", "--recordings", "recordings"]);
    let status = format!("/proc/{}/status", server.process.id());
    let status = std::fs::read_to_string(status).expect("a process");
    let user = status.lines().find(|line| line.starts_with("Uid:"));
    assert_eq!(user, Some("Uid:\t10001\t10001\t10001\t10001"), "{status}");
    let hand = place.perform(&server, &["--duration", "4"]);
    assert_eq!(hand.code, 0, "{hand:#?}");

    let mut student = place
        .command(Program::Client.path())
        .args(["run", "--server", &server.address])
        .args(["--ticket", &server.ticket])
        .args(["--duration", "600", "--tick", "server"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the client starts");
    let began = Instant::now();
    while sulcus_tests::files_with(&place.path("recordings"), "mcap").len() < 2 {
        assert!(began.elapsed() < LIMIT, "no second session");
        std::thread::sleep(Duration::from_millis(50));
    }
    // Without the right of the network, simulations would take its core.
    let expected = if may_fifo() { FIFO } else { OTHER };
    for thread in ["sulcus-net", "sulcus-sim"] {
        // The thread of a session begins after its recording, and asks for its right after its begin.
        let found = || policy(server.process.id(), thread);
        let began = Instant::now();
        while found() != Some(expected) {
            let is_late = began.elapsed() > LIMIT;
            assert!(!is_late, "{thread}: {:?}, expected {expected}", found());
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    let began = Instant::now();
    signal("-TERM", &server.process);
    let ended = server.process.wait().expect("it ends");
    eprintln!("SIGTERM to the end: {:.1} s", began.elapsed().as_secs_f64());
    assert!(ended.success(), "{ended}");
    let _ = student.wait();

    for file in sulcus_tests::files_with(&place.path("recordings"), "mcap") {
        let recording = Recording::open(&file).expect("a recording");
        let is_whole = matches!(recording.ending(), Ending::Finished);
        assert!(is_whole, "{}", recording.ending());
        // Graded by the image's own program.
        let grade = place.run(
            Program::Sessions,
            &["grade", file.to_str().expect("plain"), "--json"],
        );
        assert!(grade.json()["score"].is_f64(), "{grade:#?}");
    }
}
