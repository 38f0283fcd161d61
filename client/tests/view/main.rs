//! The program with its window, from outside, under a virtual display.

mod display;

use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;
use sulcus_support::Resource;

use display::VirtualDisplay;

/// Largest time for a window to open, and for a session to end: far over both.
const PATIENCE: Duration = Duration::from_secs(240);

fn demo(folder: &std::path::Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sulcus-client"));
    command
        .args([
            "demo",
            "--exercise",
            "crown",
            "--duration",
            "12",
            "--json",
            "--recordings",
        ])
        .arg(folder)
        .args(["--view", "--stats", "--quality", "low"])
        .env("XDG_CONFIG_HOME", folder)
        .env("HOME", folder)
        .env("XDG_RUNTIME_DIR", folder)
        .env_remove("WAYLAND_DISPLAY")
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    command
}

/// Result of a session: JSON of the last line, and all lines of standard error.
fn result(output: &Output) -> (Value, String) {
    let text = String::from_utf8_lossy(&output.stdout);
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    let last = text
        .lines()
        .last()
        .unwrap_or_else(|| panic!("no output: {told}"));
    (serde_json::from_str(last).expect("one object"), told)
}

#[test]
fn a_window_takes_keys_and_a_new_size_and_its_end_is_not_the_end_of_the_session() {
    if Resource::Adapter.or_skip(display::adapter()).is_none() {
        return;
    }
    let Some(screen) = Resource::Adapter.or_skip(VirtualDisplay::start()) else {
        return;
    };
    let folder = tempfile::tempdir().expect("folder");
    let child = demo(folder.path())
        .env("DISPLAY", screen.name())
        .spawn()
        .expect("started");
    let begin = Instant::now();
    let window = loop {
        if let Some(window) = screen.window("Sulcus") {
            break window;
        }
        assert!(begin.elapsed() < PATIENCE, "no window opened");
        std::thread::sleep(Duration::from_millis(100));
    };
    std::thread::sleep(Duration::from_secs(2));
    for key in ["F3", "Tab", "F6"] {
        screen.tool(&["windowfocus", &window]);
        screen.tool(&["key", "--window", &window, key]);
    }
    screen.tool(&["windowsize", &window, "800", "500"]);
    std::thread::sleep(Duration::from_secs(2));
    screen.close(&window);
    let output = child.wait_with_output().expect("ended");
    let (json, told) = result(&output);
    assert!(output.status.success(), "{told}");
    assert!(
        told.contains("the window was closed; the exercise goes on"),
        "{told}"
    );
    assert!(told.contains("frame age"), "{told}");
    assert_eq!(json["identical"], Value::Bool(true), "{json}");
    // The acts at the window are events of the recording.
    let events = json["events"].to_string();
    assert!(
        json["ticks"].as_u64().expect("ticks") > 10_000,
        "{json} {events}"
    );
}

#[test]
fn without_a_display_the_exercise_goes_on_without_pictures() {
    let folder = tempfile::tempdir().expect("folder");
    let output = demo(folder.path())
        .env_remove("DISPLAY")
        .output()
        .expect("ran");
    let (json, told) = result(&output);
    assert!(output.status.success(), "{told}");
    assert!(told.contains("no display was found"), "{told}");
    assert!(told.contains("goes on without pictures"), "{told}");
    assert_eq!(json["identical"], Value::Bool(true), "{json}");
}
