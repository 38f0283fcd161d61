//! One test for each cause of a defect that the judge found, or that reading the source showed.

use std::time::Duration;

use sulcus_core::{Pose, Quat, Vec3, Wrench};
use sulcus_haptics::continuous::ContinuousLimit;
use sulcus_haptics::freshness::Silence;
use sulcus_haptics::port::door;
use sulcus_haptics::{
    DoorRules, Guard, HandEnd, HandPort, Limits, Mapping, PassivityParams, SlewLimits, Stage, Trip,
    Unready, Wanted,
};

use sulcus_core::math::exp_rotation;

const MS: u64 = 1_000_000;
const PEAK: f64 = 6.0;

/// A device of 1 kHz, 6 N and 0.5 N/ms without passivity control, whose motors may stay at the peak.
pub fn rules() -> DoorRules {
    let motors = |peak: f64| ContinuousLimit {
        lasting: peak,
        peak,
        time_s: 10.0,
    };
    let guard = Guard {
        mapping: Mapping {
            world_from_base: Quat::identity(),
            origin: Vec3::zeros(),
            scale: 1.0,
            gimbal_from_tool: Pose::identity(),
        },
        has_torque: false,
        silence: Silence::DEVICE,
        blend_ns: 0,
        force: motors(PEAK),
        torque: motors(0.2),
        clutch: 2,
    };
    let limits = Limits {
        force_n: PEAK,
        torque_nm: 0.2,
    };
    let slew = SlewLimits {
        force_n_per_ms: 0.5,
        torque_nm_per_ms: 0.03,
    };
    DoorRules::guarded(limits, slew, PassivityParams::observing(), guard)
}

/// Both ends of a door, and the time of the device.
struct Rig {
    port: HandPort,
    end: HandEnd,
    now_ns: u64,
    x: f64,
}

impl Rig {
    fn new(rules: DoorRules) -> Self {
        let (port, end) = door(rules);
        Self {
            port,
            end,
            now_ns: 0,
            x: 0.0,
        }
    }

    fn change(rules: DoorRules, change: impl FnOnce(&mut Guard)) -> DoorRules {
        let mut rules = rules;
        change(rules.guard.as_mut().expect("a guard"));
        rules
    }

    fn order(&mut self, force: Vec3) {
        self.end.order(&Wanted {
            wrench: Wrench {
                force,
                torque: Vec3::zeros(),
            },
            heard_ns: Some(self.now_ns),
            ..Wanted::NOTHING
        });
    }

    /// Performs a call `ms` later.
    fn call(&mut self, ms: u64, buttons: u16) -> Vec3 {
        self.now_ns += ms * MS;
        self.call_now(buttons)
    }

    fn call_now(&mut self, buttons: u16) -> Vec3 {
        let pose = Pose::new(Vec3::new(self.x, 0.0, 0.0), Quat::identity());
        self.port.exchange(self.now_ns, Ok(&pose), buttons).force
    }

    /// Performs a period of 1 ms with an order of `force`.
    fn feel(&mut self, force: Vec3, buttons: u16) -> Vec3 {
        self.now_ns += MS;
        self.order(force);
        self.call_now(buttons)
    }

    /// A tool in the air, and a press.
    fn started(rules: DoorRules) -> Self {
        let mut rig = Self::new(rules);
        (0..3).for_each(|_| {
            rig.feel(Vec3::zeros(), 0);
        });
        rig.feel(Vec3::zeros(), 1);
        assert_eq!(rig.port.stage(), Stage::Rising);
        rig
    }

    /// The same half a second later, with `force` fully displayed.
    fn live(rules: DoorRules, force: Vec3) -> Self {
        let mut rig = Self::started(rules);
        (0..600).for_each(|_| {
            rig.feel(Vec3::zeros(), 0);
        });
        let felt = (0..50).map(|_| rig.feel(force, 0)).last().expect("a force");
        assert_eq!(rig.port.stage(), Stage::Live);
        assert!((felt - force).norm() < 1e-9, "{felt}");
        rig
    }
}

fn push(newtons: f64) -> Vec3 {
    Vec3::new(newtons, 0.0, 0.0)
}

#[test]
fn a_clock_that_steps_back_does_not_make_the_last_wrench_young() {
    let mut rig = Rig::live(rules(), push(6.0));
    rig.now_ns -= 500 * MS;
    rig.call_now(0);
    let forces: Vec<_> = (0..20).map(|_| rig.call(1, 0).norm()).collect();
    assert!(
        forces[19] == 0.0 && forces[..4].iter().all(|&force| force == 6.0),
        "{forces:?}"
    );
}

#[test]
fn a_clock_that_stands_still_does_not_keep_the_force_of_a_silent_link() {
    let mut rig = Rig::live(rules(), push(6.0));
    let forces: Vec<_> = (0..20).map(|_| rig.call_now(0).norm()).collect();
    assert!(forces[19] == 0.0, "{forces:?}");
}

#[test]
fn a_clock_that_stands_still_does_not_keep_the_force_of_a_lost_device() {
    let mut rig = Rig::live(rules(), push(6.0));
    let lost: Vec<_> = (0..20)
        .map(|_| {
            rig.port
                .exchange(rig.now_ns, Err(Unready::Absent), 0)
                .force
                .norm()
        })
        .collect();
    assert!(lost[19] == 0.0 && lost[0] > 5.0, "{lost:?}");
}

/// The slew limit alone would leave 5 N after the late call, and 4 N at 20 ms.
#[test]
fn a_call_that_comes_late_in_a_silence_does_not_prolong_the_fall() {
    let mut rig = Rig::live(rules(), push(6.0));
    (0..4).for_each(|_| assert_eq!(rig.call(1, 0).norm(), 6.0));
    let late = rig.call(13, 0).norm();
    assert!(late < 0.5, "{late} N at 17 ms");
    assert_eq!(rig.call(1, 0).norm(), 0.0);
}

/// The displayed force pursues a wanted force of another direction, which falls as fast as the slew limit allows, and
/// never reaches it.
#[test]
fn a_force_that_turns_before_a_silence_is_zero_after_twenty_milliseconds() {
    let mut rig = Rig::live(rules(), push(6.0));
    rig.feel(Vec3::new(-3.0, 5.2, 0.0), 0);
    let forces: Vec<_> = (1..=20).map(|_| rig.call(1, 0).norm()).collect();
    assert!(forces[3] > 2.0 && forces[19] == 0.0, "{forces:?}");
}

#[test]
fn a_press_while_the_former_force_still_falls_starts_nothing() {
    let mut rig = Rig::live(rules(), push(6.0));
    rig.port.exchange(rig.now_ns + MS, Err(Unready::Absent), 0);
    rig.now_ns += MS;
    assert!(rig.feel(Vec3::zeros(), 0).norm() > 4.0);
    assert!(rig.feel(Vec3::zeros(), 1).norm() > 4.0);
    assert_eq!(rig.port.stage(), Stage::Waiting);
    (0..20).for_each(|_| {
        rig.feel(Vec3::zeros(), 0);
    });
    assert_eq!(rig.feel(Vec3::zeros(), 1), Vec3::zeros());
    assert_eq!(rig.port.stage(), Stage::Rising);
}

#[test]
fn a_short_clutch_gives_the_force_back_from_zero() {
    let mut rig = Rig::live(rules(), push(6.0));
    rig.feel(push(6.0), 2);
    let mut before = 6.0;
    while before > 0.0 {
        assert_eq!(rig.port.stage(), Stage::Clutched);
        let force = rig.feel(push(6.0), 0).norm();
        assert!(force < before, "{force}");
        before = force;
    }
    let risen: Vec<_> = (0..10).map(|_| rig.feel(push(6.0), 0).norm()).collect();
    assert!(risen.iter().all(|&force| force < 0.01), "{risen:?}");
}

#[test]
fn a_button_held_while_the_device_is_plugged_in_starts_nothing() {
    let mut rig = Rig::live(rules(), push(1.0));
    for _ in 0..30 {
        rig.now_ns += MS;
        rig.order(Vec3::zeros());
        rig.port.exchange(rig.now_ns, Err(Unready::Absent), 0);
    }
    for _ in 0..30 {
        rig.feel(Vec3::zeros(), 1);
        assert_eq!(rig.port.stage(), Stage::Waiting);
    }
    rig.feel(Vec3::zeros(), 0);
    rig.feel(Vec3::zeros(), 1);
    assert_eq!(rig.port.stage(), Stage::Rising);
}

#[test]
fn presses_counted_from_the_beginning_again_start_nothing() {
    let mut rig = Rig::new(rules());
    let mut stage_of = |presses: u32| {
        rig.now_ns += MS;
        rig.end.order(&Wanted {
            heard_ns: Some(rig.now_ns),
            presses,
            ..Wanted::NOTHING
        });
        rig.call_now(0);
        rig.port.stage()
    };
    assert_eq!(stage_of(5), Stage::Waiting);
    assert_eq!(stage_of(5), Stage::Waiting);
    assert_eq!(stage_of(0), Stage::Waiting);
    assert_eq!(stage_of(1), Stage::Rising);
}

#[test]
fn an_old_wrench_of_a_free_tool_does_not_say_that_the_tool_is_free() {
    let mut rig = Rig::new(rules());
    rig.feel(Vec3::zeros(), 0);
    rig.feel(Vec3::zeros(), 0);
    (0..20).for_each(|_| {
        rig.call(1, 0);
    });
    rig.call(1, 1);
    assert_eq!(rig.port.stage(), Stage::Touching);
}

#[test]
fn a_clock_that_steps_forward_does_not_hasten_the_rise() {
    let mut rig = Rig::started(rules());
    rig.now_ns += 400 * MS;
    let forces: Vec<_> = (0..20).map(|_| rig.feel(push(6.0), 0).norm()).collect();
    // 21 ms of 500 ms, and 2 ms for the step.
    assert!(forces.iter().all(|&force| force < 0.05), "{forces:?}");
}

/// An order each 0.9 ms on a blend of 1 ms: each blend begins at the former one.
#[test]
fn a_wrench_that_is_not_finite_leaves_no_trace_in_the_interpolation() {
    let rules = Rig::change(rules(), |guard| guard.blend_ns = MS);
    let mut rig = Rig::live(rules, push(3.0));
    let mut period = |force: Vec3| {
        rig.now_ns += 900_000;
        rig.order(force);
        rig.call_now(0).norm()
    };
    period(Vec3::repeat(f64::NAN));
    let forces: Vec<_> = (0..20).map(|_| period(push(3.0))).collect();
    assert!(forces[19] > 2.9, "{forces:?}");
}

/// The heat of 300 ms at the peak counts, not that of the longest step of a fall.
#[test]
fn a_force_that_was_held_through_a_stall_has_heated_the_motors() {
    let rules = Rig::change(rules(), |guard| {
        guard.force = ContinuousLimit {
            lasting: 1.0,
            peak: PEAK,
            time_s: 10.0,
        };
    });
    let mut rig = Rig::live(rules, push(6.0));
    rig.now_ns += 299 * MS;
    let force = (0..40)
        .map(|_| rig.feel(push(6.0), 0).norm())
        .last()
        .expect("a force");
    // 36 N^2 for 0.35 s of 10 s are more than the continuous force may heat.
    assert!(force <= 1.01, "{force} N");
}

/// Twenty times the continuous force: a fall of the limit from 70 % of the heat on would come too late.
#[test]
fn a_peak_far_above_the_continuous_force_does_not_overheat_within_a_period() {
    let limit = ContinuousLimit {
        lasting: 0.3,
        peak: PEAK,
        time_s: 0.5,
    };
    let rules = Rig::change(rules(), |guard| guard.force = limit);
    for period_ms in [1, 2, 10, 20] {
        let mut rig = Rig::live(rules.clone(), push(0.2));
        // 50 ms at 0.2 N.
        let mut mean = 0.04 * (1.0 - (-0.05 / limit.time_s).exp());
        for _ in 0..500 {
            rig.now_ns += (period_ms - 1) * MS;
            let force = rig.feel(push(6.0), 0).norm();
            let keeps = (-(period_ms as f64) * 1e-3 / limit.time_s).exp();
            mean = force * force + (mean - force * force) * keeps;
            assert!(mean <= 0.09 * 1.01, "{mean} N^2 at {period_ms} ms");
        }
    }
}

/// A hand pushed along by 3 N, then 20 ms without a call, then air: the damping force is up to 1 N against the hand.
#[test]
fn damping_after_a_late_call_is_no_blow() {
    let damped = DoorRules {
        slew: SlewLimits {
            force_n_per_ms: 0.1,
            torque_nm_per_ms: 0.01,
        },
        passivity: PassivityParams {
            take_up: 1e-3,
            ..PassivityParams::default()
        },
        ..rules()
    };
    let mut rig = Rig::live(damped, push(1.0));
    let mut before = rig.feel(push(1.0), 0);
    for _ in 0..20 {
        rig.x += 0.4e-3;
        before = rig.feel(push(1.0), 0);
    }
    rig.x += 4e-3;
    rig.now_ns += 19 * MS;
    let after = rig.feel(Vec3::zeros(), 0);
    assert!(before.x < 1.0, "no damping: {before}");
    assert!(after.x >= -0.2 - 1e-9, "{before} to {after}");
}

#[test]
fn a_huge_finite_pose_is_invalid_and_leaves_no_trace() {
    for far in [1e3, 1e160, f64::MAX] {
        let mut rig = Rig::live(rules(), push(3.0));
        // Two periods, so that no jump within 2.2 ms is found.
        rig.now_ns += 2 * MS;
        rig.x = far;
        rig.feel(push(3.0), 0);
        assert_eq!(rig.port.stage(), Stage::Tripped(Trip::NotFinite));
        rig.x = 0.0;
        (0..30).for_each(|_| {
            rig.feel(Vec3::zeros(), 0);
        });
        rig.feel(Vec3::zeros(), 1);
        (0..700).for_each(|_| {
            rig.feel(push(3.0), 0);
        });
        // The kick is found as before.
        for _ in 0..40 {
            rig.x += 2e-3;
            rig.feel(push(3.0), 0);
        }
        assert_eq!(rig.port.stage(), Stage::Tripped(Trip::Speed), "{far:e}");
    }
}

#[test]
fn the_largest_time_is_a_time() {
    let mut rig = Rig::new(rules());
    for now_ns in [0, u64::MAX, 0, u64::MAX, u64::MAX - 1, 1] {
        rig.now_ns = now_ns;
        rig.order(push(3.0));
        assert_eq!(rig.call_now(1), Vec3::zeros());
    }
}

#[test]
fn a_limit_that_is_not_a_number_or_negative_lets_no_force_pass() {
    for bad in [f64::NAN, -3.0] {
        let mut rules = rules();
        rules.limits.force_n = bad;
        let mut rig = Rig::started(rules);
        for _ in 0..800 {
            assert_eq!(rig.feel(push(3.0), 0).norm(), 0.0, "{bad}");
        }
        assert_eq!(rig.port.stage(), Stage::Live);
    }
}

/// Identity: the force at the device is that of the simulation, turned. Its length has no scale.
#[test]
fn scale_and_handle_change_no_force() {
    for scale in [0.1, 1.0, 5.0] {
        let seat = exp_rotation(&Vec3::new(0.3, -1.0, 2.0));
        let rules = Rig::change(rules(), |guard| {
            guard.mapping.scale = scale;
            guard.mapping.world_from_base = seat;
            guard.mapping.gimbal_from_tool.position = Vec3::new(0.1, 0.2, -0.1);
        });
        let mut rig = Rig::started(rules);
        (0..600).for_each(|_| {
            rig.feel(Vec3::zeros(), 0);
        });
        let felt = (0..50)
            .map(|_| rig.feel(push(3.0), 0))
            .last()
            .expect("a force");
        assert!((seat * felt - push(3.0)).norm() < 1e-9, "{felt}");
    }
}

#[test]
fn a_blend_is_the_period_of_the_link_for_a_faster_device_alone() {
    let [fast, slow] = [250, 1000].map(Duration::from_micros);
    assert_eq!(
        (Guard::blend(fast, slow), Guard::blend(slow, slow)),
        (MS, 0)
    );
}
