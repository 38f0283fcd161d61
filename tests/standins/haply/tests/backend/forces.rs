//! Forces of two hands, and the end of the orders.

use std::f64::consts::TAU;

use sulcus_core::Vec3;
use sulcus_standin_haply::{Fault, Options};

use crate::capture::warnings;
use crate::judged::judge_forces;
use crate::rig::Rig;

/// Force of the first hand, to the right, and of the second hand, downward; newtons.
fn size(hand: usize, t_s: f64) -> f64 {
    match hand {
        0 => 0.7 + 0.4 * (TAU * 0.7 * t_s).sin(),
        _ => 0.5 + 0.3 * (TAU * 1.1 * t_s).sin(),
    }
}

fn plan(hand: usize, t_s: f64) -> Vec3 {
    match hand {
        0 => Vec3::new(size(0, t_s), 0.0, 0.0),
        _ => Vec3::new(0.0, -size(1, t_s), 0.0),
    }
}

/// Whether a force at `t_ns` is the ordered one of the last 25 ms.
fn is_ordered(hand: usize, t_ns: u64, newtons: f64) -> bool {
    (0..=25)
        .any(|ms| (size(hand, t_ns as f64 * 1e-9 - f64::from(ms) * 1e-3) - newtons).abs() < 0.01)
}

/// Cross-check of the forces of two hands in the log of the service, over 20 000 messages.
#[test]
fn each_of_two_hands_gets_its_own_force() {
    let options = Options {
        watchdog_ms: 200.0,
        ..Options::pair()
    };
    let arms = ["049D+61576", "04A1+61577"];
    let mut rig = Rig::start(&options, &arms, Box::new(plan));
    assert_eq!(rig.infos.len(), 2);
    rig.wait_live();
    let first = rig.service.messages();
    for _ in 0..600 {
        if rig.service.messages() - first > 24_000 {
            break;
        }
        rig.sleep(100);
    }
    rig.press(false);
    assert_eq!(rig.end(), Ok(()));
    let stages = [rig.seen(0).stages, rig.seen(1).stages];
    let log = rig.service.log().unwrap();
    assert_eq!(log.violations(), []);
    let (mut checked, mut ordered) = (0, [0, 0]);
    for (hand, arm) in ["049D", "04A1"].into_iter().enumerate() {
        for sent in log.forces(arm) {
            let [x, y, z] = sent.force.unwrap();
            let (own, others) = if hand == 0 { (x, [y, z]) } else { (-z, [x, y]) };
            // No message ever has a part of the other hand's force.
            assert_eq!(others, [0.0; 2], "{sent:?}");
            assert!((0.0..1.2).contains(&own), "{sent:?}");
            assert_eq!(sent.displayed, [x, y, z]);
            checked += 1;
            ordered[hand] += u32::from(is_ordered(hand, sent.t_ns, own));
        }
        judge_forces(&log, arm, 0, &stages);
    }
    let [a, b] = ordered;
    println!(
        "{checked} forces, as ordered {a} and {b}, period {} us",
        rig.infos[0].period_ns / 1000
    );
    assert!(checked >= 40_000, "{checked}");
    assert!(a > 18_000 && b > 18_000, "{ordered:?} {stages:?}");
}

#[test]
fn the_force_is_zero_within_twenty_milliseconds_of_the_last_order() {
    let mut rig = Rig::start(
        &Options::default(),
        &["049D"],
        Box::new(|_, _| Vec3::new(1.5, 0.0, 1.5)),
    );
    for _ in 0..5 {
        rig.wait_live();
        rig.sleep(100);
        let last_ns = rig.silence(true);
        rig.sleep(150);
        let quiet_ns = rig
            .service
            .log()
            .unwrap()
            .quiet_after_ns("049D", last_ns, 0.0);
        println!("quiet after {} us", quiet_ns / 1000);
        assert!(quiet_ns <= 25_000_000, "{quiet_ns} ns");
        rig.silence(false);
        rig.sleep(700);
    }
    assert_eq!(rig.end(), Ok(()));
    let log = rig.service.log().unwrap();
    judge_forces(&log, "049D", 0, &"silence");
    assert!(log.largest_force("049D") > 2.0);
}

#[test]
fn a_foreign_force_takes_the_own_one_away_with_one_warning() {
    let foreign = |begin: &dyn Fn(&Rig), end: &dyn Fn(&Rig)| {
        let mut rig = Rig::start(
            &Options::default(),
            &["049D"],
            Box::new(|_, _| Vec3::new(0.4, 0.0, 0.0)),
        );
        rig.wait_live();
        begin(&rig);
        rig.wait("trip", || rig.stage(0).name() == "tripped_driver");
        rig.sleep(300);
        end(&rig);
        rig.wait_live();
        assert_eq!(rig.end(), Ok(()));
        let all = warnings();
        assert_eq!(all.len(), 1, "{all:?}");
        assert!(
            all[0].contains("N of another program or setting acts at the arm"),
            "{all:?}"
        );
    };
    foreign(
        &|rig| {
            rig.service
                .set_second_source("049D", [0.0, 0.2, 0.0])
                .unwrap()
        },
        &|rig| rig.service.set_second_source("049D", [0.0; 3]).unwrap(),
    );
    foreign(
        &|rig| rig.service.fault(Fault::ForceScale { value: 2.0 }).unwrap(),
        &|rig| rig.service.fault(Fault::ForceScale { value: 1.0 }).unwrap(),
    );
}

/// A foreign force before the first own one keeps the own force away.
#[test]
fn no_force_begins_beside_a_foreign_one() {
    let mut rig = Rig::start(
        &Options::default(),
        &["049D"],
        Box::new(|_, _| Vec3::new(0.4, 0.0, 0.0)),
    );
    rig.press(false);
    rig.wait("pose", || {
        rig.stage(0).name() == "waiting" || rig.stage(0).name() == "live"
    });
    rig.service
        .set_second_source("049D", [0.0, 0.0, 0.1])
        .unwrap();
    rig.wait("trip", || rig.stage(0).name() == "tripped_driver");
    rig.press(true);
    let before = rig.service.log().unwrap().entries.len();
    rig.sleep(300);
    assert_eq!(rig.end(), Ok(()));
    let log = rig.service.log().unwrap();
    let late = sulcus_standin_haply::Log {
        entries: log.entries[before..].to_vec(),
    };
    assert!(late.messages() > 100);
    assert_eq!(late.largest_force("049D"), 0.0);
}
