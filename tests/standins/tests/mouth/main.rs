//! A session in the whole mouth with the devices of two vendors, at 1 kHz and at 4 kHz.
//!
//! The probe is in the hand of an omega.6, the mirror in that of a Touch. Each hand presses on a tooth of its own, in
//! turn and together. The log of the controller boxes has the force of every frame. The recording of the server has the
//! force that the simulation computed. [`judge`] compares both, frame by frame.
//!
//! A driver's library is loaded once in a process. The session therefore runs in a process of its own, the example
//! `mouth_session`.
#![cfg(target_os = "linux")]

mod hands;
mod judge;
mod long;
#[path = "../../examples/mouth_session/messages.rs"]
mod messages;

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::Mutex;

use sulcus_sessions::replay::{ReplayOptions, replay};
use sulcus_sessions::{Message, Recording};
use sulcus_standins::board::Family;
use sulcus_standins::{Rig, example, library};

use hands::{BOXES, PROBE, TOUCH};
use judge::{Judged, Series, judge};
use messages::{MARK, Performed, Said};

/// Sessions run one after another.
static ALONE: Mutex<()> = Mutex::new(());

/// Compares so many seconds of a session, frame by frame.
fn compared(seconds: u64) {
    let _alone = ALONE
        .lock()
        .unwrap_or_else(std::sync::PoisonError::into_inner);
    let program = Path::new(env!("CARGO_BIN_EXE_standin-controller"));
    let rig = Rig::start_at(program, hands::at_rest()).expect("the controller starts");
    let home = tempfile::tempdir().expect("a folder");
    let performed = perform(&rig, home.path(), seconds);
    let log = rig.log().expect("a log");
    assert_eq!(log.flaws(rig.setup()), Vec::<String>::new());
    let recording = Recording::open(&performed.recording).expect("a recording");
    let report = replay(&recording, &ReplayOptions::default(), &mut |_| {}).expect("a replay");
    assert!(report.identical && report.gradable, "{report:?}");
    let computed = computed(&recording, &performed);

    let mut frames = 0;
    for (tool, of_box) in BOXES.iter().enumerate() {
        let judged = judge(&log, of_box, &computed, tool);
        eprintln!(
            "{}: {judged:?}, pose age {:?} us",
            of_box.name, performed.pose_age_us[tool]
        );
        holds(&judged, seconds);
        frames += judged.frames;
        // Age that the door adds to a pose: at most the period of the device.
        let age_us = performed.pose_age_us[tool].p50;
        assert!(age_us <= of_box.period_us, "{}: {age_us} us", of_box.name);
    }
    assert!(frames >= 4 * 1000 * seconds, "{frames} frames");
    assert_eq!(performed.threads, 2, "threads of the devices");
    assert_eq!(
        performed.allocations, 0,
        "allocations in the threads of the devices"
    );
    assert_eq!(performed.trips, 0);
}

/// Asserts that a hand felt its own force, and nothing of the other hand's.
fn holds(judged: &Judged, seconds: u64) {
    assert_eq!(
        judged.strange, 0,
        "forces without a contact of this hand: {judged:?}"
    );
    assert_eq!(
        judged.stronger, 0,
        "forces above the simulation's: {judged:?}"
    );
    assert_eq!(judged.aside, 0, "forces in another direction: {judged:?}");
    // Neither count may be empty: a quarter of the time one hand presses alone.
    assert!(judged.crossed >= 100 * seconds, "{judged:?}");
    assert!(judged.pressed >= 100 * seconds, "{judged:?}");
    assert!(judged.whole * 2 >= judged.pressed, "{judged:?}");
}

/// Runs the session in its process. The hands begin to press when both devices have their whole force.
fn perform(rig: &Rig, home: &Path, seconds: u64) -> Performed {
    let (key, board) = rig.environment();
    for device in rig
        .setup()
        .devices
        .iter()
        .filter(|device| device.family == Family::Hd)
    {
        std::fs::create_dir_all(home.join("config")).expect("a folder");
        let file = home.join("config").join(format!("{}.config", device.name));
        let text = format!("ModelType=OMNI\nDeviceSerialNumber={}\n", device.serial);
        std::fs::write(file, text).expect("a file");
    }
    let mut child = Command::new(example("mouth_session").expect("built"))
        .arg(home)
        .arg(seconds.to_string())
        .env(key, board)
        .env("GTDD_HOME", home)
        .env("SULCUS_HD_LIBRARY", library("standin_hd").expect("built"))
        .env("SULCUS_DHD_LIBRARY", library("standin_dhd").expect("built"))
        .env_remove("SULCUS_HD_KEEP_DEVICE")
        .env_remove("SULCUS_DHD_AUTO_INIT")
        .stdout(Stdio::piped())
        .spawn()
        .expect("the session starts");
    let output = BufReader::new(child.stdout.take().expect("a pipe"));
    let mut drops = None;
    let mut performed = None;
    for line in output.lines() {
        let line = line.expect("a line");
        let Some(said) = line.strip_prefix(MARK) else {
            continue;
        };
        match serde_json::from_str(said).expect("a message") {
            Said::Placed(found) => drops = Some(found),
            Said::Live => {
                let drops: [f64; 2] = drops.expect("places before the devices");
                for (of_box, motion) in BOXES.iter().zip(hands::pressing(&drops, seconds)) {
                    rig.hand(of_box.device, motion).expect("a device");
                }
            }
            Said::Performed(said) => performed = Some(said),
        }
    }
    assert!(child.wait().expect("an end").success());
    performed.expect("a session")
}

/// Force of each tool over time, as the simulation computed it.
fn computed(recording: &Recording, performed: &Performed) -> [Series; 2] {
    let mut forces = Vec::new();
    for message in recording.messages() {
        if let Ok(Message::Row(row)) = message {
            let of = |tool: usize| {
                let [x, y, z, ..] = row.wrench[tool];
                [f64::from(x), f64::from(y), f64::from(z)]
            };
            forces.push((row.tick, [of(PROBE), of(TOUCH)]));
        }
    }
    let mut series: [Series; 2] = Default::default();
    for &(at_ns, tick) in &performed.heard {
        if let Ok(found) = forces.binary_search_by_key(&tick, |&(tick, _)| tick) {
            for tool in [PROBE, TOUCH] {
                series[tool].push(at_ns, forces[found].1[tool]);
            }
        }
    }
    series
}

#[test]
fn two_devices_feel_each_its_own_force_in_the_whole_mouth() {
    compared(8);
}
