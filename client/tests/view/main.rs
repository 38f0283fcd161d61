//! The program with its window, from outside, under a virtual display.

mod display;
mod lesson;
mod levels;
mod pages;
mod people;

use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;
use sulcus_sessions::{Message, Occurrence, Recording};
use sulcus_support::Resource;

use display::VirtualDisplay;

/// Largest time for a window to open, and for a session to end: far over both.
const PATIENCE: Duration = Duration::from_secs(240);

fn demo(folder: &std::path::Path, exercise: &str, more: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sulcus-client"));
    command
        .args(["demo", "--exercise", exercise, "--json", "--recordings"])
        .arg(folder)
        .args(["--view", "--stats", "--quality", "low"])
        .args(more)
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

/// Number of the window of a program, when it is open.
fn opened(screen: &VirtualDisplay) -> String {
    let begin = Instant::now();
    loop {
        if let Some(window) = screen.window("Sulcus") {
            return window;
        }
        assert!(begin.elapsed() < PATIENCE, "no window opened");
        std::thread::sleep(Duration::from_millis(100));
    }
}

/// Presses F10 again and again, with pauses, until the program has ended.
fn left(screen: &VirtualDisplay, window: &str, mut child: Child, pause: Duration) -> Output {
    let begin = Instant::now();
    let mut pressed: Option<Instant> = None;
    while child.try_wait().expect("a child").is_none() {
        assert!(begin.elapsed() < PATIENCE, "the window stays");
        if pressed.is_none_or(|at| at.elapsed() > pause) && screen.window("Sulcus").is_some() {
            screen.tool(&["key", "--window", window, "F10"]);
            pressed = Some(Instant::now());
        }
        std::thread::sleep(Duration::from_millis(200));
    }
    child.wait_with_output().expect("ended")
}

/// Recording of a session, and the data of its events of one kind.
fn recording(json: &Value) -> Recording {
    let path = json["recording"].as_str().expect("a recording");
    Recording::open(std::path::Path::new(path)).expect("a recording")
}

fn said(json: &Value, kind: &str) -> Vec<String> {
    let recording = recording(json);
    let events = recording
        .messages()
        .filter_map(|message| match message.expect("sound") {
            Message::Event(event) => Occurrence::parse(&event.text),
            _ => None,
        });
    let events = events
        .filter(|event| event.kind == kind)
        .map(|event| event.data.to_string());
    events.collect()
}

#[test]
fn a_session_by_mouse_alone_is_recorded_replays_identical_and_is_graded() {
    if Resource::Adapter.or_skip(display::adapter()).is_none() {
        return;
    }
    let Some(screen) = Resource::Adapter.or_skip(VirtualDisplay::start()) else {
        return;
    };
    let folder = tempfile::tempdir().expect("folder");
    let child = demo(folder.path(), "probing", &["--mouse"])
        .env("DISPLAY", screen.name())
        .spawn()
        .expect("started");
    let window = opened(&screen);
    std::thread::sleep(Duration::from_secs(3));
    screen.tool(&["windowfocus", &window]);
    screen.tool(&["key", "space"]);
    for _ in 0..40 {
        screen.tool(&["mousemove_relative", "--", "-4", "6"]);
        std::thread::sleep(Duration::from_millis(20));
    }
    screen.tool(&["key", "space"]);
    // A depth by keys: the tool is held still.
    for key in ["3", "Return"] {
        screen.tool(&["key", key]);
    }
    std::thread::sleep(Duration::from_secs(1));
    // The first F10 ends the session, a later one closes the page at its end.
    let output = left(&screen, &window, child, Duration::from_secs(20));
    let (json, told) = result(&output);
    assert_eq!(json["identical"], Value::Bool(true), "{json} {told}");
    assert_eq!(json["gradable"], Value::Bool(true), "{json} {told}");
    assert!(json["grade"]["score"].is_number(), "{json}");
    let calls = said(&json, "reading_called");
    assert!(
        calls.len() == 1 && calls[0].contains(r#""depth_mm":3"#),
        "{calls:?} {told}"
    );
    let recording = recording(&json);
    let mut places = recording
        .messages()
        .filter_map(|message| match message.expect("sound") {
            Message::Row(row) if row.input.tools[0].present => {
                Some(row.input.tools[0].pose.position)
            }
            _ => None,
        });
    let first = places.next().expect("a tool in a hand");
    let farthest = places.fold(0.0f32, |far, at| {
        let off: f32 = (0..3).map(|k| (at[k] - first[k]).powi(2)).sum();
        far.max(off.sqrt())
    });
    assert!(
        (0.002..0.2).contains(&farthest),
        "the tool moved by {farthest} m; {told}"
    );
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
    let child = demo(folder.path(), "crown", &["--duration", "12"])
        .env("DISPLAY", screen.name())
        .spawn()
        .expect("started");
    let window = opened(&screen);
    std::thread::sleep(Duration::from_secs(2));
    for key in ["F3", "Tab", "F6"] {
        screen.tool(&["windowfocus", &window]);
        screen.tool(&["key", "--window", &window, key]);
    }
    screen.tool(&["windowsize", &window, "800", "500"]);
    std::thread::sleep(Duration::from_secs(2));
    screen.tool(&["key", "--window", &window, "F10"]);
    let output = child.wait_with_output().expect("ended");
    let (json, told) = result(&output);
    assert!(output.status.success(), "{told}");
    assert!(
        told.contains("the window was closed; the exercise goes on"),
        "{told}"
    );
    assert!(told.contains("frame age"), "{told}");
    assert_eq!(json["identical"], Value::Bool(true), "{json}");
    assert!(json["ticks"].as_u64().expect("ticks") > 10_000, "{json}");
    let views: Vec<String> = said(&json, "screen")
        .into_iter()
        .filter(|data| data.contains("view"))
        .collect();
    assert_eq!(views, [r#"{"view":"buccal"}"#, r#"{"view":"close-up"}"#]);
}

#[test]
fn a_killed_display_server_is_not_the_end_of_the_session() {
    if Resource::Adapter.or_skip(display::adapter()).is_none() {
        return;
    }
    let Some(mut screen) = Resource::Adapter.or_skip(VirtualDisplay::start()) else {
        return;
    };
    let folder = tempfile::tempdir().expect("folder");
    let child = demo(folder.path(), "crown", &["--duration", "12"])
        .env("DISPLAY", screen.name())
        .spawn()
        .expect("started");
    opened(&screen);
    std::thread::sleep(Duration::from_secs(2));
    screen.kill();
    let output = child.wait_with_output().expect("ended");
    let (json, told) = result(&output);
    assert!(output.status.success(), "{:?} {told}", output.status);
    let sentence = "the display was lost. The exercise goes on without pictures";
    assert_eq!(told.matches(sentence).count(), 1, "{told}");
    assert_eq!(json["identical"], Value::Bool(true), "{json} {told}");
    assert_eq!(json["gradable"], Value::Bool(true), "{json} {told}");
    // The session went on for its whole 12 s. A busy machine skips some ticks.
    let count = |name: &str| json[name].as_u64().expect("a number");
    assert!(count("ticks") + count("skipped") >= 11_900, "{json}");
}

#[test]
fn without_a_display_the_exercise_goes_on_without_pictures() {
    let folder = tempfile::tempdir().expect("folder");
    let output = demo(folder.path(), "crown", &["--duration", "4"])
        .env_remove("DISPLAY")
        .output()
        .expect("ran");
    let (json, told) = result(&output);
    assert!(output.status.success(), "{told}");
    assert!(told.contains("no display was found"), "{told}");
    assert!(told.contains("goes on without pictures"), "{told}");
    assert_eq!(json["identical"], Value::Bool(true), "{json}");
}

#[test]
fn without_a_display_a_session_by_mouse_ends_with_an_error() {
    let folder = tempfile::tempdir().expect("folder");
    let output = demo(folder.path(), "probing", &["--mouse"])
        .env_remove("DISPLAY")
        .output()
        .expect("ran");
    let told = String::from_utf8_lossy(&output.stderr);
    // 2 for a recording that ended before its first tick.
    assert!(
        matches!(output.status.code(), Some(1 | 2)),
        "{:?} {told}",
        output.status
    );
    assert!(told.contains("the mouse needs one"), "{told}");
}
