//! Pedal, hand, finger rest, the patient's head, and the voice, by keys of a virtual display.

use std::os::unix::fs::PermissionsExt;
use std::time::Duration;

use serde_json::Value;
use sulcus_support::Resource;

use crate::display::{self, VirtualDisplay};
use crate::running::Running;
use crate::{PROBING, demo, events, ready, recorded, result, said, until};

/// Least length of a long press: thrice the border. A pedal counts at least half the time between the pictures with
/// press and release.
const HELD: Duration = Duration::from_millis(1500);

/// Pedal on a display: commands of xdotool for a press and for a release.
struct Pedal<'a> {
    screen: &'a VirtualDisplay,
    down: [&'static str; 2],
    up: [&'static str; 2],
}

impl Pedal<'_> {
    /// Makes short presses, then long ones, in one group. Events between two long pauses reach the program at one time:
    /// a press and its release are then a short press, and no pause within the group counts.
    fn group(&self, program: &mut Running, short: usize, long: usize) {
        let mut steps = [self.down, self.up].concat().repeat(short);
        for _ in 0..long {
            steps.extend(self.down);
            program.at_once(self.screen, &steps);
            // The program takes keys in their order: the press was taken when the view is chosen.
            self.screen.tool(&["key", "F1"]);
            program.hears("window act    View(Overview)");
            std::thread::sleep(HELD);
            steps = self.up.to_vec();
        }
        program.at_once(self.screen, &steps);
    }
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
    let mut program = Running::start(
        demo(folder.path(), PROBING, &more)
            .env("DISPLAY", screen.name())
            .env("PATH", format!("{}:{path}", folder.path().display())),
    );
    ready(&screen, &mut program);
    let heard = || std::fs::read_to_string(&spoken).unwrap_or_default();
    until("voice", || heard().ends_with('\n').then_some(()));
    let pedal = Pedal {
        screen: &screen,
        down: ["keydown", "F8"],
        up: ["keyup", "F8"],
    };
    // Three presses and a long one: 3 mm, confirmed.
    pedal.group(&mut program, 3, 1);
    program.hears("window act    Reading(Count(3))");
    program.hears("window act    Reading(Next)");
    // Bleeding by three long presses, and one that confirms: without a depth nothing is confirmed.
    pedal.group(&mut program, 0, 3);
    program.hears("window act    Reading(Bleeding)");
    pedal.group(&mut program, 0, 1);
    program.hears("window act    Reading(Next)");
    screen.tool(&["key", "shift+Right", "shift+Up", "Right"]);
    // An event that the session has not taken yet would end with the window.
    recorded(folder.path(), |recording| {
        let screens = events(recording, "screen").join(" ");
        screens.matches("head_turn_deg").count() == 2
    });
    screen.tool(&["key", "F10"]);
    let output = program.ended();
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
    assert_eq!(told.matches("window act    Head(").count(), 2, "{told}");
    let path = json["recording"].as_str().expect("a recording");
    let recording = crate::recording(&json);
    let info = sulcus_sessions::info(std::path::Path::new(path), &recording).expect("sound");
    let line = "student    probe in the left hand, finger rest: tooth";
    assert!(info.to_string().contains(line), "{info}");
    let spoken = heard();
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
    let mut program =
        Running::start(demo(folder.path(), PROBING, &more).env("DISPLAY", screen.name()));
    let window = ready(&screen, &mut program);
    screen.tool(&["mousemove", "--window", &window, "300", "300"]);
    let pedal = Pedal {
        screen: &screen,
        down: ["mousedown", "2"],
        up: ["mouseup", "2"],
    };
    screen.tool(&["key", "7"]);
    program.hears("window act    Reading(Digit(7))");
    pedal.group(&mut program, 2, 0);
    program.hears("window act    Reading(Bleeding)");
    pedal.group(&mut program, 1, 0);
    program.hears("window act    Reading(Next)");
    recorded(folder.path(), |recording| {
        !events(recording, "reading_called").is_empty()
    });
    program.interrupt();
    let (json, told) = result(&program.ended());
    let calls = said(&json, "reading_called");
    let is_ours = calls.len() == 1
        && calls[0].contains(r#""depth_mm":7"#)
        && calls[0].contains(r#""bleeding":true"#);
    assert!(is_ours, "{calls:?} {told}");
}
