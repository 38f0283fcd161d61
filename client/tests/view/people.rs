//! Pedal, hand, finger rest, the patient's head, and the voice, by keys of a virtual display.

use std::os::unix::fs::PermissionsExt;
use std::time::Duration;

use serde_json::Value;
use sulcus_support::Resource;

use crate::display::{self, VirtualDisplay};
use crate::{demo, opened, result, said};

/// Presses, ms: far from the border of 500 ms, because a window on a busy machine takes events late.
const SHORT: u64 = 40;
const LONG: u64 = 1500;
const SHORT_SHORT_SHORT_LONG: [u64; 4] = [SHORT, SHORT, SHORT, LONG];
/// Pause that ends a group, and pause between two presses, far below it.
const REST: Duration = Duration::from_millis(1500);
const BETWEEN: Duration = Duration::from_millis(60);

/// Holds a key or a button for a time, and rests shortly. `kind` is `key` or `mouse`.
fn hold(screen: &VirtualDisplay, kind: &str, name: &str, ms: u64) {
    screen.tool(&[&format!("{kind}down"), name]);
    std::thread::sleep(Duration::from_millis(ms));
    screen.tool(&[&format!("{kind}up"), name]);
    std::thread::sleep(BETWEEN);
}

#[test]
fn a_pedal_alone_charts_and_the_recording_names_hand_rest_and_head() {
    if Resource::Adapter.or_skip(display::adapter()).is_none() {
        return;
    }
    let Some(screen) = Resource::Adapter.or_skip(VirtualDisplay::start()) else {
        return;
    };
    let folder = tempfile::tempdir().expect("folder");
    let spoken = folder.path().join("spoken");
    let program = folder.path().join("espeak-ng");
    let line = format!(
        "#!/bin/sh\nfor text; do :; done; echo \"$text\" >> '{}'\n",
        spoken.display()
    );
    std::fs::write(&program, line).expect("a program");
    let may_run = std::fs::Permissions::from_mode(0o755);
    std::fs::set_permissions(&program, may_run).expect("a program");
    let more = [
        "--mouse",
        "--pedal",
        "F8",
        "--hand",
        "left",
        "--finger-rest",
        "tooth",
        "--speak",
        "--close-at-end",
    ];
    let path = std::env::var("PATH").expect("folders of programs");
    let child = demo(folder.path(), "probing", &more)
        .env("DISPLAY", screen.name())
        .env("PATH", format!("{}:{path}", folder.path().display()))
        .spawn()
        .expect("started");
    let window = opened(&screen);
    std::thread::sleep(Duration::from_secs(5));
    screen.tool(&["windowfocus", &window]);
    // Three presses and a long one: 3 mm, confirmed.
    for ms in SHORT_SHORT_SHORT_LONG {
        hold(&screen, "key", "F8", ms);
    }
    std::thread::sleep(REST);
    // Bleeding by three long presses, and one that confirms: without a depth nothing is confirmed.
    for presses in [3, 1] {
        for _ in 0..presses {
            hold(&screen, "key", "F8", LONG);
        }
        std::thread::sleep(REST);
    }
    for key in ["shift+Right", "shift+Up", "Right"] {
        screen.tool(&["key", key]);
        std::thread::sleep(Duration::from_millis(200));
    }
    std::thread::sleep(Duration::from_secs(1));
    screen.tool(&["key", "F10"]);
    let output = child.wait_with_output().expect("ended");
    let (json, told) = result(&output);
    assert_eq!(json["identical"], Value::Bool(true), "{json} {told}");
    let calls = said(&json, "reading_called");
    assert!(
        calls.len() == 1 && calls[0].contains(r#""depth_mm":3"#),
        "{calls:?} {told}"
    );
    let screens = said(&json, "screen").join(" ");
    for event in [
        r#""finger_rest":"tooth","hand":"left""#,
        r#"{"head_tilt_deg":0,"head_turn_deg":15}"#,
        r#"{"head_tilt_deg":15,"head_turn_deg":15}"#,
    ] {
        assert!(screens.contains(event), "{event}: {screens}");
    }
    assert_eq!(screens.matches("head_turn_deg").count(), 2, "{screens}");
    let path = json["recording"].as_str().expect("a recording");
    let recording = crate::recording(&json);
    let info = sulcus_sessions::info(std::path::Path::new(path), &recording).expect("sound");
    let line = "student    probe in the left hand, finger rest: tooth";
    assert!(info.to_string().contains(line), "{info}");
    let spoken = std::fs::read_to_string(spoken).expect("the voice");
    assert!(spoken.starts_with("Place the tip at "), "{spoken}");
}

#[test]
fn a_button_of_the_mouse_is_a_pedal_beside_the_keyboard() {
    if Resource::Adapter.or_skip(display::adapter()).is_none() {
        return;
    }
    let Some(screen) = Resource::Adapter.or_skip(VirtualDisplay::start()) else {
        return;
    };
    let folder = tempfile::tempdir().expect("folder");
    let more = [
        "--pedal",
        "mouse-middle",
        "--pedal-use",
        "beside",
        "--close-at-end",
    ];
    let child = demo(
        folder.path(),
        "probing",
        &[&more[..], &["--duration", "24"]].concat(),
    )
    .env("DISPLAY", screen.name())
    .spawn()
    .expect("started");
    let window = opened(&screen);
    std::thread::sleep(Duration::from_secs(5));
    screen.tool(&["windowfocus", &window]);
    screen.tool(&["mousemove", "--window", &window, "300", "300"]);
    screen.tool(&["key", "7"]);
    for _ in 0..2 {
        hold(&screen, "mouse", "2", SHORT);
    }
    std::thread::sleep(REST);
    hold(&screen, "mouse", "2", SHORT);
    let output = child.wait_with_output().expect("ended");
    let (json, told) = result(&output);
    let calls = said(&json, "reading_called");
    let ours: Vec<&String> = calls
        .iter()
        .filter(|call| call.contains(r#""depth_mm":7"#) && call.contains(r#""bleeding":true"#))
        .collect();
    assert_eq!(ours.len(), 1, "{calls:?} {told}");
}
