//! kill -9 in the middle of a session loses at most 200 ms and leaves a clean prefix.
#![cfg(unix)]
#![allow(clippy::unwrap_used)]

use std::io::{BufRead as _, BufReader};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::common::*;
use sulcus_sessions::*;

/// Tells the child where to record; without it the child is no test of its own.
const FILE: &str = "SULCUS_TEST_KILL_FILE";

#[test]
fn child_records_in_real_time_until_killed() {
    let Some(path) = std::env::var_os(FILE) else {
        return;
    };
    let mut session = Session::begin(path.as_ref(), key());
    let began = Instant::now();
    for k in 0..60_000 {
        let row = session.tick(&input(k));
        session.recorder.push(&row).unwrap();
        if row.tick.is_multiple_of(10) {
            eprintln!("tick {}", row.tick);
        }
        let due = Duration::from_millis(k);
        std::thread::sleep(due.saturating_sub(began.elapsed()));
    }
}

#[test]
fn a_killed_process_leaves_all_but_the_last_fifth_of_a_second() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("killed.mcap");
    let mut child = Command::new(std::env::current_exe().unwrap())
        .args([
            "--exact",
            "kill::child_records_in_real_time_until_killed",
            "--nocapture",
        ])
        .env(FILE, &path)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut ran = 0;
    for line in BufReader::new(child.stderr.take().unwrap()).lines() {
        if let Some(tick) = line.unwrap().strip_prefix("tick ") {
            ran = tick.parse().unwrap();
        }
        if ran >= 1250 {
            break;
        }
    }
    child.kill().unwrap(); // SIGKILL
    child.wait().unwrap();
    let recording = Recording::open(&path).unwrap();
    let report = replay(&recording, &ReplayOptions::default(), &mut |_| {}).unwrap();
    assert!(
        report.identical && report.ticks + 200 >= ran,
        "{} of {ran}",
        report.ticks
    );
    assert!(matches!(report.ending, Ending::CutOff { .. }) && !report.gradable);
}
