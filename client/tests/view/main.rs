//! The program with its window, from outside, under a virtual display.

mod display;
mod lesson;
mod levels;
mod pages;
mod people;
mod running;

use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;
use sulcus_sessions::{Message, Occurrence, Recording};
use sulcus_support::Resource;

use display::VirtualDisplay;
use running::Running;

/// Longest wait for a condition, beside pictures that the processor draws.
const PATIENCE: Duration = Duration::from_secs(240);
/// Exercise of an hour with three sites to read. Its test ends the session.
const PROBING: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/view/probing.toml");
/// Length of another session that its test ends.
const LONG: [&str; 2] = ["--duration", "3600"];
/// Ticks that a session makes after the end of its window, at the least.
const MORE: u64 = 2000;

fn demo(folder: &Path, exercise: &str, more: &[&str]) -> Command {
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

/// Waits until `met` gives a value. `what` names the condition.
fn until<T>(what: &str, mut met: impl FnMut() -> Option<T>) -> T {
    let begin = Instant::now();
    loop {
        if let Some(found) = met() {
            return found;
        }
        assert!(begin.elapsed() < PATIENCE, "no {what} in {PATIENCE:?}");
        std::thread::sleep(Duration::from_millis(200));
    }
}

/// Number of the window of a program, which has the focus and shows pictures of the running session.
fn ready(screen: &VirtualDisplay, program: &mut Running) -> String {
    program.hears("window        draws ");
    let window = until("window", || screen.window("Sulcus"));
    screen.tool(&["windowfocus", &window]);
    // A key that is down when the window takes the focus comes twice. Two presses of this key do what one does.
    screen.tool(&["key", "Home"]);
    program.hears("window act    Camera ");
    window
}

/// Waits until the recording in `folder` fulfils a condition. The file is still being written.
fn recorded(folder: &Path, mut met: impl FnMut(&Recording) -> bool) {
    until("such recording", || {
        let files = std::fs::read_dir(folder).expect("a folder").flatten();
        let mut paths = files.map(|file| file.path());
        let path = paths.find(|path| path.extension().is_some_and(|kind| kind == "mcap"))?;
        met(&Recording::open(&path).ok()?).then_some(())
    });
}

/// Waits until a session has made [`MORE`] ticks from now on.
fn goes_on(folder: &Path) {
    let mut from = None;
    recorded(folder, |recording| {
        let last = recording.facts().ticks.map_or(0, |(_, last)| last);
        last >= *from.get_or_insert(last) + MORE
    });
}

/// Asserts that a session has the ticks of [`goes_on`]. A busy machine skips some.
fn has_gone_on(json: &Value) {
    let count = |name: &str| json[name].as_u64().expect("a number");
    assert!(count("ticks") + count("skipped") >= MORE, "{json}");
}

/// Recording of a session.
fn recording(json: &Value) -> Recording {
    let path = json["recording"].as_str().expect("a recording");
    Recording::open(Path::new(path)).expect("a recording")
}

/// Data of the events of one kind in a session.
fn said(json: &Value, kind: &str) -> Vec<String> {
    let recording = recording(json);
    assert!(recording.messages().all(|message| message.is_ok()));
    events(&recording, kind)
}

/// Data of the events of one kind in a recording. An unfinished recording has those that have reached the file.
fn events(recording: &Recording, kind: &str) -> Vec<String> {
    let events = recording.messages().filter_map(|message| match message {
        Ok(Message::Event(event)) => Occurrence::parse(&event.text),
        _ => None,
    });
    let events = events
        .filter(|event| event.kind == kind)
        .map(|event| event.data.to_string());
    events.collect()
}

/// Largest distance of the first tool from its first place in a hand, metres.
fn farthest(recording: &Recording) -> f32 {
    let mut places = recording.messages().filter_map(|message| match message {
        Ok(Message::Row(row)) if row.input.tools[0].present => {
            Some(row.input.tools[0].pose.position)
        }
        _ => None,
    });
    let Some(first) = places.next() else {
        return 0.0;
    };
    places.fold(0.0f32, |far, at| {
        let off: f32 = (0..3).map(|k| (at[k] - first[k]).powi(2)).sum();
        far.max(off.sqrt())
    })
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
    let mut program =
        Running::start(demo(folder.path(), PROBING, &["--mouse"]).env("DISPLAY", screen.name()));
    ready(&screen, &mut program);
    // Keys are taken in their order: the clutch is closed when the view is chosen.
    screen.tool(&["key", "space", "F1"]);
    program.hears("window act    View(Overview)");
    for _ in 0..40 {
        screen.tool(&["mousemove_relative", "--", "-4", "6"]);
        std::thread::sleep(Duration::from_millis(20));
    }
    recorded(folder.path(), |recording| farthest(recording) >= 0.002);
    // A depth by keys: the tool is held still.
    screen.tool(&["key", "space", "3", "Return"]);
    program.hears("window act    Reading(Digit(3))");
    program.hears("window act    Reading(Next)");
    recorded(folder.path(), |recording| {
        !events(recording, "reading_called").is_empty()
    });
    // The first F10 ends the session, a later one closes the page at its end.
    screen.tool(&["key", "F10"]);
    program.prints();
    assert!(program.is_running(), "the window did not stay");
    screen.tool(&["key", "F10"]);
    let output = program.ended();
    let (json, told) = result(&output);
    assert_eq!(json["identical"], Value::Bool(true), "{json} {told}");
    assert_eq!(json["gradable"], Value::Bool(true), "{json} {told}");
    assert!(json["grade"]["score"].is_number(), "{json}");
    let calls = said(&json, "reading_called");
    assert!(
        calls.len() == 1 && calls[0].contains(r#""depth_mm":3"#),
        "{calls:?} {told}"
    );
    let farthest = farthest(&recording(&json));
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
    let mut program =
        Running::start(demo(folder.path(), "crown", &LONG).env("DISPLAY", screen.name()));
    let window = ready(&screen, &mut program);
    screen.tool(&["key", "F3", "Tab", "F6"]);
    program.hears("window act    View(Buccal)");
    program.hears("window act    View(CloseUp)");
    screen.tool(&["windowsize", &window, "800", "500"]);
    program.hears("window        draws 800 x 500 pixels");
    screen.tool(&["key", "F10"]);
    program.hears("the window was closed; the exercise goes on");
    goes_on(folder.path());
    program.interrupt();
    let output = program.ended();
    let (json, told) = result(&output);
    assert!(output.status.success(), "{:?} {told}", output.status);
    assert!(told.contains("frame age"), "{told}");
    assert_eq!(json["identical"], Value::Bool(true), "{json}");
    has_gone_on(&json);
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
    let mut program =
        Running::start(demo(folder.path(), "crown", &LONG).env("DISPLAY", screen.name()));
    program.hears("window        draws ");
    screen.kill();
    let sentence = "the display was lost. The exercise goes on without pictures";
    program.hears(sentence);
    goes_on(folder.path());
    program.interrupt();
    let output = program.ended();
    let (json, told) = result(&output);
    assert!(output.status.success(), "{:?} {told}", output.status);
    assert_eq!(told.matches(sentence).count(), 1, "{told}");
    assert_eq!(json["identical"], Value::Bool(true), "{json} {told}");
    assert_eq!(json["gradable"], Value::Bool(true), "{json} {told}");
    has_gone_on(&json);
}

#[test]
fn without_a_display_the_exercise_goes_on_without_pictures() {
    let _turn = display::turn();
    let folder = tempfile::tempdir().expect("folder");
    let output =
        Running::start(demo(folder.path(), "crown", &["--duration", "4"]).env_remove("DISPLAY"))
            .ended();
    let (json, told) = result(&output);
    assert!(output.status.success(), "{told}");
    assert!(told.contains("no display was found"), "{told}");
    assert!(told.contains("goes on without pictures"), "{told}");
    assert_eq!(json["identical"], Value::Bool(true), "{json}");
}

#[test]
fn without_a_display_a_session_by_mouse_ends_with_an_error() {
    let _turn = display::turn();
    let folder = tempfile::tempdir().expect("folder");
    let output =
        Running::start(demo(folder.path(), "probing", &["--mouse"]).env_remove("DISPLAY")).ended();
    let told = String::from_utf8_lossy(&output.stderr);
    // 2 for a recording that ended before its first tick.
    assert!(
        matches!(output.status.code(), Some(1 | 2)),
        "{:?} {told}",
        output.status
    );
    assert!(told.contains("the mouse needs one"), "{told}");
}
