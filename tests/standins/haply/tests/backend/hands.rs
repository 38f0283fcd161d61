//! Poses, buttons and axes.

use sulcus_core::math::{log_rotation, norm};
use sulcus_core::{Quat, Vec3};
use sulcus_haptics::hands::drawn;
use sulcus_haptics::{Stage, Unready};
use sulcus_standin_haply::{Buttons, GripArray, GripOptions, Motion, Options, Turn};

use crate::rig::Rig;

fn still() -> crate::rig::Plan {
    Box::new(|_, _| Vec3::zeros())
}

#[test]
fn an_arm_without_a_grip_has_three_axes() {
    let mut options = Options {
        grips: Vec::new(),
        ..Options::default()
    };
    options.arms[0].motion = Motion::Rest {
        at: [0.01, 0.12, 0.2],
    };
    let mut rig = Rig::start(&options, &["049D"], still());
    assert_eq!(
        (
            rig.infos[0].motion_dof,
            rig.infos[0].force_axes,
            rig.infos[0].torque_axes
        ),
        (3, 3, 0)
    );
    rig.wait_live();
    let pose = drawn(&rig.seen(0).sample.pose).unwrap();
    assert!(
        norm(&(pose.position - Vec3::new(0.01, 0.2, -0.12))) < 1e-6,
        "{pose:?}"
    );
    assert_eq!(pose.orientation, Quat::identity());
    assert_eq!(rig.end(), Ok(()));
}

#[test]
fn buttons_of_the_grip_start_the_force() {
    let mut options = Options::default();
    options.grips[0].arrays = vec![GripArray::Wired, GripArray::Wireless];
    options.arms[0].motion = Motion::Sinusoid {
        centre: [0.0, 0.1, 0.1],
        amplitude: [0.03, 0.0, 0.0],
        hz: 1.0,
    };
    let mut rig = Rig::start(&options, &["049D"], still());
    rig.press(false);
    rig.wait("pose", || !matches!(rig.stage(0), Stage::Unready(_)));
    rig.sleep(100);
    let set = |a, b, c| {
        rig.service
            .set_buttons("61576", Buttons { a, b, c, hall: 1 })
            .unwrap()
    };
    set(false, true, true);
    rig.wait("buttons", || rig.seen(0).buttons == 0b110);
    set(true, false, false);
    rig.wait("buttons", || rig.seen(0).buttons == 0b111);
    rig.wait_live();
    assert_eq!(rig.end(), Ok(()));
    assert_eq!(rig.service.log().unwrap().violations(), []);
}

/// The grip measures at 50 Hz, and the pose turns in every period.
#[test]
fn the_orientation_turns_smoothly_between_two_measurements() {
    let mut options = Options::default();
    options.grips[0] = GripOptions {
        turn: Turn::Spin {
            axis: [0.0, 0.0, 1.0],
            rad_per_s: 2.0,
        },
        ..GripOptions::wireless("61576")
    };
    let mut rig = Rig::start(&options, &["049D"], still());
    rig.wait_live();
    rig.record();
    rig.sleep(1000);
    assert_eq!(rig.end(), Ok(()));
    let poses = rig.seen(0).poses;
    assert!(poses.len() > 300, "{}", poses.len());
    let (mut moved, mut all) = (0, 0);
    for pair in poses.windows(2) {
        let [Some(a), Some(b)] = [&pair[0], &pair[1]].map(|sample| drawn(&sample.pose)) else {
            continue;
        };
        if !pair[0].present || !pair[1].present {
            continue;
        }
        let turned = log_rotation(&(b.orientation * a.orientation.inverse()));
        let seconds = (pair[1].at_ns - pair[0].at_ns) as f64 * 1e-9;
        // A turn about the axis up, y of the base, at 2 rad/s; a late measurement shows as a faster turn.
        assert!(turned.x.abs() < 1e-4 && turned.z.abs() < 1e-4, "{turned:?}");
        assert!(
            turned.y < 2.0 * 3.0 * seconds + 1e-3 && turned.y > -1e-3,
            "{turned:?} in {seconds} s"
        );
        all += 1;
        moved += u32::from(turned.y > 0.5 * 2.0 * seconds);
    }
    assert!(moved * 10 > all * 8, "{moved} of {all}");
}

#[test]
fn a_sleeping_grip_keeps_the_force_away_until_it_wakes() {
    let mut options = Options::default();
    options.grips[0].awake = false;
    let mut rig = Rig::start(&options, &["049D"], still());
    rig.sleep(200);
    assert_eq!(rig.stage(0), Stage::Unready(Unready::NoPose));
    rig.service
        .fault(sulcus_standin_haply::Fault::Wake {
            device: "61576".into(),
        })
        .unwrap();
    rig.wait_live();
    assert_eq!(rig.end(), Ok(()));
}
