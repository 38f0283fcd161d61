//! Couplings of a session by the student's device: told, recorded, replayed, kept on a return.
#![allow(clippy::unwrap_used)]

use std::time::{Duration, Instant};

use sulcus_connection::link::{Link, LinkConfig, LinkError};
use sulcus_core::Coupling;
use sulcus_proto::control::{DeviceCoupling, DeviceInfo};
use sulcus_proto::station::Phase;
use sulcus_sessions::{Recording, ReplayOptions, replay};

use crate::common::{Station, force_up, press, press_on, rows_and_events, scene};

/// A stylus without torque that displays at most `n_per_m`.
fn stylus(n_per_m: f32) -> DeviceInfo {
    DeviceInfo {
        library: "openhaptics".into(),
        serial: "0042".into(),
        model_hash: "0b".repeat(32),
        figures: "measured".into(),
        delay_us: 900,
        max_force_n: 3.3,
        friction_n: 0.26,
        motion_axes: 6,
        force_axes: 3,
        coupling: Some(DeviceCoupling {
            n_per_m,
            nm_per_rad: 0.0,
        }),
        ..DeviceInfo::named("stylus")
    }
}

fn with(station: &Station, devices: Vec<DeviceInfo>) -> LinkConfig {
    LinkConfig {
        devices,
        ..station.config()
    }
}

/// Number of poses over which a force is steady. A ramp after a late pose changes the force by half in this time.
const STEADY: usize = 300;

/// A session by `device`: the couplings that the hello tells, the steady force of 1 mm, and the recording.
fn session(device: DeviceInfo) -> ((f64, f64), f32, Recording) {
    let station = Station::new();
    let mut link = Link::connect(with(&station, vec![device])).unwrap();
    let tool = &link.hello().tools[0];
    let told = (tool.stiffness_n_per_m, tool.stiffness_nm_per_rad);
    link.start();
    let (mut force, mut last) = (0.0, Vec::new());
    press(&mut link, |link, k| {
        force = force_up(link);
        last.push(force);
        let last = &last[last.len().saturating_sub(STEADY)..];
        let [least, most] = [f32::min, f32::max].map(|of| last.iter().copied().fold(force, of));
        k > 1500 && least > 0.05 && most - least < 0.01 * most
    });
    let summary = link.finish().unwrap();
    assert!(summary.complete, "{summary:?}");
    let recording = Recording::open(&station.recording(&summary.recording)).unwrap();
    (told, force, recording)
}

#[test]
fn a_session_runs_with_the_softer_coupling_of_scene_and_device() {
    let (told, soft, recording) = session(stylus(250.0));
    assert_eq!(told, (250.0, 0.5));
    let coupling = Coupling {
        n_per_m: 250.0,
        nm_per_rad: 0.5,
    };
    let header = recording.header();
    assert_eq!(header.couplings, [coupling]);
    // The scene of the file is that of the station.
    assert_eq!(header.scene, scene().to_bytes().unwrap());
    assert_eq!(recording.scene().unwrap().couplings(), [coupling]);
    let device = &header.devices[0];
    assert_eq!(header.devices.len(), 1);
    assert_eq!((&*device.library, &*device.serial), ("openhaptics", "0042"));
    assert_eq!((device.friction_n, device.force_axes), (0.26, 3));
    assert_eq!(device.coupling.map(|most| most.n_per_m), Some(250.0));
    let report = replay(&recording, &ReplayOptions::default(), &mut |_| ()).unwrap();
    assert!(report.identical && report.gradable, "{report:?}");

    let (told, stiff, recording) = session(stylus(4000.0));
    assert_eq!(told, (500.0, 0.5));
    assert!(recording.header().couplings.is_empty());
    let report = replay(&recording, &ReplayOptions::default(), &mut |_| ()).unwrap();
    assert!(report.identical && report.gradable, "{report:?}");
    // Half of the stiffness gives about half of the force at the same pose.
    assert!(
        (0.4..0.6).contains(&(soft / stiff)),
        "{soft} N and {stiff} N"
    );
}

#[test]
fn a_return_keeps_the_coupling_and_a_weaker_device_is_refused() {
    let station = Station::new();
    let mut link = Link::connect(with(&station, vec![stylus(400.0)])).unwrap();
    link.start();
    press(&mut link, |link, _| force_up(link) > 0.1);
    drop(link);
    let patience = Instant::now() + Duration::from_secs(60);
    while station.server().status()[0].phase != Phase::Waiting {
        assert!(Instant::now() < patience, "waited in vain for the gap");
        std::thread::sleep(Duration::from_millis(5));
    }
    let error = Link::connect(with(&station, vec![stylus(300.0)])).err();
    match error {
        Some(LinkError::Refused(text)) => assert!(
            text.contains("400 N/m") && text.contains("`stylus` displays at most 300 N/m"),
            "{text}"
        ),
        other => panic!("{other:?}"),
    }
    // The session still waits, and a stiffer device gets the coupling of its beginning.
    let mut link = Link::connect(with(&station, vec![stylus(2000.0)])).unwrap();
    assert!(link.hello().resumed);
    assert_eq!(link.hello().tools[0].stiffness_n_per_m, 400.0);
    press_on(&mut link, |link| force_up(link) > 0.1);
    let summary = link.finish().unwrap();
    let recording = Recording::open(&station.recording(&summary.recording)).unwrap();
    assert_eq!(recording.header().couplings[0].n_per_m, 400.0);
    // The recording names the device of the return.
    let (_, events) = rows_and_events(&recording);
    let mut changed = events.iter().filter(|said| said.kind == "devices_changed");
    let device = &changed.next().unwrap().data["devices"][0];
    assert_eq!(device["coupling"]["n_per_m"], 2000.0);
    assert!(changed.next().is_none());
    let report = replay(&recording, &ReplayOptions::default(), &mut |_| ()).unwrap();
    assert!(report.identical && report.gradable, "{report:?}");
}

#[test]
fn a_device_with_an_invalid_field_is_refused_by_tool_and_field() {
    let station = Station::new();
    let refused = |devices| match Link::connect(with(&station, devices)).err() {
        Some(LinkError::Refused(text)) => text,
        other => panic!("{other:?}"),
    };
    let text = refused(vec![stylus(400.0), stylus(0.0)]);
    assert!(
        text.contains("device of tool 1: coupling n_per_m is 0, expected 1 to 100000"),
        "{text}"
    );
    let text = refused(vec![DeviceInfo {
        friction_n: -1.0,
        ..stylus(400.0)
    }]);
    assert!(
        text.contains("device of tool 0: friction_n is -1"),
        "{text}"
    );
    // A third device cannot be sent at all.
    assert!(Link::connect(with(&station, vec![stylus(400.0); 3])).is_err());
}
