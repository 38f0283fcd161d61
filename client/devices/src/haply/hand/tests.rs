use super::*;
use crate::haply::reply::Array;

const MS: u64 = 1_000_000;

fn hand() -> Hand {
    let text = r#"{"inverse3":[{"device_id":"A","status":{"calibrated":true}}],"verse_grip":[{"device_id":"1"}]}"#;
    let inventory = Inventory::parse(text).unwrap();
    let pair = Pair {
        arm: "A".into(),
        grip: Some((Array::Wired, "1".into())),
        by_order: false,
    };
    Hand::new(pair, &inventory)
}

const ARM: &str =
    r#""inverse3":[{"device_id":"A","state":{"cursor_position":{"x":0.1,"y":0,"z":0}}}]"#;
const GRIP: &str = r#""verse_grip":[{"device_id":"1","state":{"button":true,"orientation":{"w":1,"x":0,"y":0,"z":0}}}]"#;

fn take(hand: &mut Hand, parts: &[&str], ms: u64) {
    let reply = Reply::parse(&format!("{{{}}}", parts.join(","))).unwrap();
    hand.take(&reply, ms * MS);
}

fn event(hand: &mut Hand, device: &str, meaning: Meaning) -> Option<String> {
    hand.event(&Event {
        device: device.into(),
        meaning,
    })
}

#[test]
fn a_pose_needs_arm_and_grip_and_holds_for_twenty_milliseconds() {
    let mut hand = hand();
    assert_eq!(hand.pose(0), Err(Unready::NoPose));
    take(&mut hand, &[ARM], 1);
    assert_eq!(hand.pose(MS), Err(Unready::NoPose));
    take(&mut hand, &[ARM, GRIP], 2);
    assert_eq!(hand.pose(2 * MS).unwrap().position.x, 0.1);
    assert_eq!(hand.buttons(2 * MS), 1);
    // Replies without arrays keep the last known state.
    for ms in 3..22 {
        take(&mut hand, &[], ms);
        assert!(hand.pose(ms * MS).is_ok());
    }
    assert_eq!(hand.pose(22 * MS), Err(Unready::NoPose));
    assert_eq!(hand.buttons(22 * MS), 0);
    assert!(hand.order().arm.is_some());
}

#[test]
fn a_device_that_its_array_lacks_is_absent_and_gets_no_orders() {
    let mut hand = hand();
    take(&mut hand, &[ARM, GRIP], 0);
    for ms in 1..=20 {
        take(&mut hand, &[r#""inverse3":[]"#, GRIP], ms);
    }
    assert!(hand.order().arm.is_some());
    take(&mut hand, &[r#""inverse3":[]"#, GRIP], 21);
    assert_eq!(hand.pose(21 * MS), Err(Unready::Absent));
    assert!(hand.order().arm.is_none() && hand.order().grip.is_some());
    hand.set_force(Vec3::x());
    assert!(hand.order().arm.is_some());
    hand.set_force(Vec3::zeros());
    take(&mut hand, &[ARM, GRIP], 22);
    assert!(hand.pose(22 * MS).is_ok());
    event(&mut hand, "1", Meaning::Disconnected);
    assert_eq!(hand.pose(22 * MS), Err(Unready::Absent));
    assert!(hand.order().grip.is_none());
}

#[test]
fn events_of_other_devices_change_nothing() {
    let mut hand = hand();
    take(&mut hand, &[ARM, GRIP], 0);
    for meaning in [Meaning::Disconnected, Meaning::Asleep] {
        assert_eq!(event(&mut hand, "B", meaning), None);
    }
    let brake = Meaning::Safety {
        cause: "ebrake_triggered".into(),
        holds: true,
    };
    assert_eq!(event(&mut hand, "B", brake.clone()), None);
    assert!(hand.pose(0).is_ok() && !hand.is_refused());
    assert!(
        event(&mut hand, "A", brake)
            .unwrap()
            .contains("ebrake_triggered")
    );
    assert!(hand.is_refused());
    event(&mut hand, "A", Meaning::Released);
    assert!(!hand.is_refused());
}

#[test]
fn a_sleeping_grip_wakes_by_its_status_or_its_motion() {
    let mut hand = hand();
    take(&mut hand, &[ARM, GRIP], 0);
    event(&mut hand, "1", Meaning::Asleep);
    take(&mut hand, &[ARM, GRIP], 1);
    assert_eq!(hand.pose(MS), Err(Unready::NoPose));
    let turned = GRIP.replace("\"x\":0", "\"x\":0.1");
    take(&mut hand, &[ARM, &turned], 2);
    assert!(hand.pose(2 * MS).is_ok());
    let status = |awake: bool| {
        GRIP.replace(
            "\"state\"",
            &format!("\"status\":{{\"awake\":{awake}}},\"state\""),
        )
    };
    take(&mut hand, &[ARM, &status(false)], 3);
    assert_eq!(hand.pose(3 * MS), Err(Unready::NoPose));
    take(&mut hand, &[ARM, GRIP], 4);
    assert_eq!(hand.pose(4 * MS), Err(Unready::NoPose));
    take(&mut hand, &[ARM, &status(true)], 5);
    assert!(hand.pose(5 * MS).is_ok());
}

#[test]
fn an_arm_without_power_keeps_its_pose_and_gets_no_force() {
    let mut hand = hand();
    let status = |name: &str, on: bool| {
        ARM.replace(
            "\"state\"",
            &format!("\"status\":{{\"{name}\":{on}}},\"state\""),
        )
    };
    take(&mut hand, &[&status("power_supply", false), GRIP], 0);
    assert!(hand.pose(0).is_ok() && hand.is_refused());
    take(&mut hand, &[&status("calibrated", false), GRIP], 1);
    assert_eq!(hand.pose(MS), Err(Unready::Uncalibrated));
    take(&mut hand, &[&status("calibrated", true), GRIP], 2);
    take(&mut hand, &[&status("ready", false), GRIP], 3);
    assert_eq!(hand.pose(3 * MS), Err(Unready::NoPose));
}
