//! Passivity with one degree of freedom: mass and damping of a hand before a spring with a delay.

use std::collections::VecDeque;

use super::*;
use crate::display::Display;
use crate::limits::SlewLimits;

/// Mass of the device, kg, and its own damping, N s/m.
const MASS: f64 = 0.1;
const BARE: f64 = 1.0;
/// Period of the device, s.
const PERIOD: f64 = 1e-3;

/// Pose of a hand at x metres.
fn at(x: f64) -> Pose {
    Pose::new(Vec3::new(x, 0.0, 0.0), sulcus_core::Quat::identity())
}

/// Wrench of a force along x, newtons.
fn push(newtons: f64) -> Wrench {
    Wrench {
        force: Vec3::new(newtons, 0.0, 0.0),
        torque: Vec3::zeros(),
    }
}

struct Run {
    /// Largest distance from the middle in the last second, m.
    swing: f64,
    energy: Energy,
}

/// Five seconds of a mass that leaves the middle of a spring of `stiffness` N/m and `damper` N s/m at 0.15 m/s. The
/// force is `delay` periods late. The motion is along x, or a rotation about y with the same values at the lever.
fn plucked(
    stiffness: f64,
    damper: f64,
    delay: usize,
    turning: bool,
    params: PassivityParams,
) -> Run {
    let lever = params.lever;
    let mut display = Display::new(params, SlewLimits::from(&sulcus_core::Params::default()));
    let pose = |x: f64| {
        if turning {
            let turn = sulcus_core::math::exp_rotation(&Vec3::new(0.0, x / lever, 0.0));
            Pose::new(Vec3::zeros(), turn)
        } else {
            at(x)
        }
    };
    let wrench = |f: f64| Wrench {
        force: Vec3::new(if turning { 0.0 } else { f }, 0.0, 0.0),
        torque: Vec3::new(0.0, if turning { f * lever } else { 0.0 }, 0.0),
    };
    // From rest in the middle: what comes out must have gone in, by a push of the hand.
    let (mut x, mut v, mut last) = (0.0f64, 0.15f64, 0.0f64);
    let mut on_the_way: VecDeque<f64> = std::iter::repeat_n(0.0, delay).collect();
    let mut run = Run {
        swing: 0.0,
        energy: Energy::default(),
    };
    display.moved(Some(&pose(x)), 1);
    for k in 0..5000 {
        let speed = (x - last) / PERIOD;
        on_the_way.push_back(-stiffness * x - damper * speed);
        let arrived = on_the_way.pop_front().expect("one was just put in");
        last = x;
        let felt = display.next(&wrench(arrived), 1.0);
        let force = if turning {
            felt.torque.y / lever
        } else {
            felt.force.x
        };
        for _ in 0..10 {
            let dt = PERIOD / 10.0;
            v = (v + force * dt / MASS) / (1.0 + BARE * dt / MASS);
            x += v * dt;
        }
        display.moved(Some(&pose(x)), 1);
        if k >= 4000 {
            run.swing = fmax(run.swing, x.abs());
        }
    }
    run.energy = display.energy();
    run
}

#[test]
fn a_spring_that_comes_late_drives_the_hand_and_the_controller_ends_it() {
    for turning in [false, true] {
        let without = plucked(500.0, 0.0, 5, turning, PassivityParams::observing());
        assert!(without.energy.most_out > 0.05, "{:?}", without.energy);
        assert!(without.swing > 5e-3, "{} m", without.swing);
        assert_eq!(without.energy.acted, 0);
        let with = plucked(500.0, 0.0, 5, turning, PassivityParams::default());
        assert!(with.energy.most_out < 1e-4, "{:?}", with.energy);
        assert!(with.energy.taken > 1e-4, "{:?}", with.energy);
        assert!(with.swing < 5e-4, "{} m", with.swing);
    }
}

#[test]
fn a_passive_spring_and_damper_is_left_alone() {
    for turning in [false, true] {
        // Held over a period the spring alone would put out k T / 2 = 0.25 N s/m.
        let run = plucked(500.0, 1.0, 0, turning, PassivityParams::default());
        // Below a millinewton the budget is reset, together with the energy in the spring.
        assert!(run.energy.most_out <= 1e-9, "{:?}", run.energy);
        assert_eq!(run.energy.acted, 0);
    }
}

#[test]
fn damping_is_bounded() {
    for most in [1.0, 10.0, 30.0] {
        let params = PassivityParams {
            max_damping: most,
            ..PassivityParams::default()
        };
        let mut passivity = Passivity::new(params);
        let push = push(3.0);
        let mut x = 0.0;
        for speed in [0.0, 1.0, 0.3, 0.1, 0.03, 0.01] {
            x += speed * PERIOD;
            passivity.moved(Some(&at(x)), 1);
            let kept = push.force * passivity.share;
            let felt = passivity.damped(&push, 1.0);
            let damping = norm(&(kept - felt.force)) / fmax(speed, 1e-9);
            assert!(damping <= most * (1.0 + 1e-9), "{damping} of {most}");
            assert!(damping > 0.0 || speed == 0.0);
            passivity.hold(&felt, &push);
        }
    }
    let mut passivity = Passivity::new(PassivityParams::default());
    passivity.moved(Some(&Pose::identity()), 1);
    let push = push(2.0);
    passivity.hold(&push, &push);
    // 2 mm in a millisecond under 2 N: 4 mJ came out of nothing.
    passivity.moved(Some(&at(2e-3)), 1);
    assert!((passivity.energy().most_out - 4e-3).abs() < 1e-12);
    let felt = passivity.damped(&push, 1.0).force.x;
    assert!(
        (felt + 2.0).abs() < 1e-12,
        "as much as was wanted, the other way: {felt}"
    );
    let felt = passivity.damped(&Wrench::ZERO, 1.0).force.x;
    assert!((felt + 1.0).abs() < 1e-12, "the limit of force: {felt}");
    assert_eq!(passivity.damped(&push, 0.0), push);
}

#[test]
fn a_hand_that_is_pushed_along_slowly_is_let_go_of_until_it_has_paid() {
    let mut passivity = Passivity::new(PassivityParams::default());
    let push = Wrench {
        torque: Vec3::new(0.0, 0.1, 0.0),
        ..push(3.0)
    };
    let mut x = 0.0;
    let mut go = |passivity: &mut Passivity, speed: f64, ticks: u32| {
        let mut felt = Wrench::ZERO;
        for _ in 0..ticks {
            x += speed * PERIOD;
            passivity.moved(Some(&at(x)), 1);
            felt = passivity.damped(&push, 1.0);
            passivity.hold(&felt, &push);
        }
        felt
    };
    // 3 N along 30 mm/s are 18 mJ in 0.2 s; 30 N s/m take a third of it.
    let felt = go(&mut passivity, 0.03, 200);
    assert!(
        passivity.energy().most_out < 5e-4,
        "{:?}",
        passivity.energy()
    );
    assert!(
        norm(&felt.force) < 0.1 && norm(&felt.torque) < 0.05,
        "{felt:?}"
    );
    // Pushed back in it pays, and the contact is as firm as before.
    let felt = go(&mut passivity, -0.03, 300);
    assert_eq!(felt, push);
    assert!(passivity.energy().most_out < 5e-4);
}

#[test]
fn what_a_contact_took_in_does_not_pay_for_the_next() {
    let mut passivity = Passivity::new(PassivityParams::default());
    passivity.moved(Some(&at(0.0)), 1);
    passivity.hold(&push(-1.0), &push(-1.0));
    passivity.moved(Some(&at(1e-3)), 1);
    assert_eq!(
        passivity.damped(&push(0.5), 1.0),
        push(0.5),
        "a millijoule is there"
    );
    for _ in 0..100 {
        passivity.hold(&Wrench::ZERO, &Wrench::ZERO);
        passivity.moved(Some(&at(1e-3)), 1);
    }
    passivity.hold(&push(0.1), &push(0.1));
    passivity.moved(Some(&at(1.1e-3)), 1);
    assert_ne!(passivity.damped(&push(0.1), 1.0), push(0.1));
    assert!(passivity.energy().most_out > 9e-6);
}

#[test]
fn what_is_not_a_number_is_refused() {
    assert_eq!(PassivityParams::default().validate(), Ok(()));
    assert_eq!(PassivityParams::observing().validate(), Ok(()));
    let bad = PassivityParams {
        lever: f64::NAN,
        ..PassivityParams::default()
    };
    let said = bad.validate().expect_err("no lever").to_string();
    assert!(said.contains("lever"), "{said}");
}
