//! Arms and grips in the messages.

use std::collections::BTreeSet;
use std::f64::consts::PI;
use std::time::{Duration, Instant};

use serde_json::json;
use sulcus_standin_haply::{
    ArmKind, ArmOptions, Buttons, Fault, GripArray, GripOptions, Handedness, Options, Service, Turn,
};

use crate::client::{Client, GRIP, probe};

#[test]
fn arms_of_every_type_with_their_side() {
    let kinds = [
        ArmKind::Inverse3,
        ArmKind::Inverse3x,
        ArmKind::Minverse,
        ArmKind::Other("inverse9".into()),
    ];
    let arm = |(index, kind): (usize, ArmKind)| {
        let side = if index % 2 == 0 {
            Handedness::Left
        } else {
            Handedness::Right
        };
        ArmOptions {
            kind,
            ..ArmOptions::new(&format!("A{index}"), side)
        }
    };
    let arms = kinds.into_iter().enumerate().map(arm).collect();
    let unknown_arrays = vec!["quill".into()];
    let service = Service::start(Options {
        arms,
        unknown_arrays,
        ..Options::default()
    })
    .unwrap();
    let (mut client, inventory) = Client::connect(&service);
    let arms = inventory["inverse3"].as_array().unwrap();
    let told: Vec<_> = arms
        .iter()
        .map(|arm| {
            (
                arm["config"]["type"].clone(),
                arm["config"]["handedness"].clone(),
            )
        })
        .collect();
    let pairs = [
        ("inverse3", "left"),
        ("inverse3x", "right"),
        ("minverse", "left"),
        ("inverse9", "right"),
    ];
    assert_eq!(told, pairs.map(|(kind, side)| (json!(kind), json!(side))));
    assert_eq!(arms[2]["config"]["device_info"]["device_type"], 6);
    assert_eq!(client.ask(probe())["quill"][0]["device_id"], "F00D");
}

#[test]
fn one_id_in_two_arrays() {
    let grip = GripOptions {
        arrays: vec![GripArray::Wired, GripArray::Wireless],
        ..GripOptions::wireless("7")
    };
    let service = Service::start(Options {
        grips: vec![grip, GripOptions::wired("8")],
        ..Options::default()
    })
    .unwrap();
    let (mut client, _) = Client::connect(&service);
    service
        .set_buttons(
            "7",
            Buttons {
                a: true,
                c: true,
                hall: 3,
                ..Buttons::default()
            },
        )
        .unwrap();
    let reply = client
        .ask(json!({"verse_grip": [{"device_id": "8", "commands": {"probe_orientation": {}}}]}));
    assert_eq!(reply["verse_grip"][0]["device_id"], "7");
    assert_eq!(reply["verse_grip"][0]["state"]["button"], true);
    assert_eq!(reply["verse_grip"][1]["device_id"], "8");
    assert_eq!(reply["verse_grip"][1]["state"]["button"], false);
    let wireless = &reply["wireless_verse_grip"][0];
    assert_eq!(wireless["device_id"], "7");
    assert_eq!(
        wireless["state"]["buttons"],
        json!({"a": true, "b": false, "c": true})
    );
    assert_eq!(wireless["state"]["hall"], 3);
    assert_eq!(service.log().unwrap().violations(), vec![]);
}

#[test]
fn the_rotation_of_a_grip_comes_slower_than_the_replies() {
    let service = Service::start(Options::default()).unwrap();
    let (mut client, _) = Client::connect(&service);
    service
        .set_turn(
            GRIP,
            Turn::Spin {
                axis: [0.0, 0.0, 1.0],
                rad_per_s: PI,
            },
        )
        .unwrap();
    let start = Instant::now();
    let (mut replies, mut seen) = (0, BTreeSet::new());
    while start.elapsed() < Duration::from_millis(400) {
        let reply = client.ask(probe());
        replies += 1;
        let orientation = &reply["wireless_verse_grip"][0]["state"]["orientation"];
        let part = |letter: &str| orientation[letter].as_f64().unwrap();
        let norm = ["w", "x", "y", "z"]
            .map(part)
            .iter()
            .map(|value| value * value)
            .sum::<f64>();
        assert!((norm - 1.0).abs() < 1e-9);
        seen.insert(orientation.to_string());
    }
    // 0.4 s hold 20 new rotations; the machine may add a pause at the end.
    let most = (start.elapsed().as_secs_f64() * 50.0) as usize + 2;
    assert!(
        replies > 2 * seen.len(),
        "{replies} replies, {} rotations",
        seen.len()
    );
    assert!(
        seen.len() >= 3 && seen.len() <= most,
        "{} rotations",
        seen.len()
    );
}

#[test]
fn a_sleeping_grip_stands_still() {
    let service = Service::start(Options::default()).unwrap();
    let (mut client, _) = Client::connect(&service);
    service
        .fault(Fault::Sleep {
            device: GRIP.into(),
        })
        .unwrap();
    service
        .set_buttons(
            GRIP,
            Buttons {
                a: true,
                ..Buttons::default()
            },
        )
        .unwrap();
    let reply = client.ask(probe());
    assert_eq!(reply["wireless_verse_grip"][0]["status"]["awake"], false);
    assert_eq!(
        reply["wireless_verse_grip"][0]["state"]["buttons"]["a"],
        false
    );
    service
        .fault(Fault::Wake {
            device: GRIP.into(),
        })
        .unwrap();
    let reply = client.ask(probe());
    assert_eq!(reply["wireless_verse_grip"][0]["status"]["awake"], true);
    assert_eq!(
        reply["wireless_verse_grip"][0]["state"]["buttons"]["a"],
        true
    );
    assert_eq!(service.log().unwrap().events("device-sleep"), 1);
}
