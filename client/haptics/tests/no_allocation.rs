//! Neither end of a port allocates after its creation: a callback of a vendor's library must not wait for memory.

#[path = "../../../server/core/tests/counting/mod.rs"]
mod counting;

use counting::calls;
use sulcus_core::{Pose, Quat, Vec3, Wrench};
use sulcus_haptics::continuous::ContinuousLimit;
use sulcus_haptics::freshness::Silence;
use sulcus_haptics::port::door;
use sulcus_haptics::{
    DoorRules, Guard, Limits, Mapping, PassivityParams, SlewLimits, Stage, Trip, Unready, Wanted,
};

fn rules() -> DoorRules {
    let motors = |lasting: f64, peak: f64| ContinuousLimit {
        lasting,
        peak,
        time_s: 2.0,
    };
    let guard = Guard {
        mapping: Mapping {
            world_from_base: Mapping::seat(11.0),
            origin: Vec3::zeros(),
            scale: 1.5,
            gimbal_from_tool: Pose::new(Vec3::new(0.0, 0.01, -0.05), Quat::identity()),
        },
        has_torque: true,
        silence: Silence::DEVICE,
        blend_ns: 1_000_000,
        force: motors(0.88, 3.3),
        torque: motors(0.05, 0.2),
        clutch: 2,
    };
    let limits = Limits {
        force_n: 3.3,
        torque_nm: 0.2,
    };
    let slew = SlewLimits {
        force_n_per_ms: 0.5,
        torque_nm_per_ms: 0.03,
    };
    DoorRules::guarded(limits, slew, PassivityParams::default(), guard)
}

#[test]
fn exchange_order_sample_and_buttons_never_allocate() {
    let before = calls();
    std::hint::black_box(Box::new(1));
    assert_ne!(calls(), before, "the counter counts");
    let (mut port, mut end) = door(rules());
    let mut stages = [false; 5];
    let mut strongest = 0.0_f64;
    let before = calls();
    for ms in 0..6_000_u64 {
        let now_ns = ms * 1_000_000;
        // Silence, an invalid wrench, a lost device, an invalid pose, a jump, a clutch: every branch of the door.
        if !(3_000..3_100).contains(&ms) {
            let force = if ms < 1_000 {
                0.0
            } else {
                (ms as f64 * 0.02).sin() * 5.0
            };
            let bad = if ms % 500 == 499 { f64::NAN } else { 0.1 };
            end.order(&Wanted {
                wrench: Wrench {
                    force: Vec3::new(force, 0.0, 0.0),
                    torque: Vec3::new(0.0, force * bad, 0.0),
                },
                guide: Wrench::ZERO,
                heard_ns: Some(now_ns),
                leaving: ms > 5_900,
                paused: (3_000..3_200).contains(&ms),
                presses: (ms / 700) as u32,
            });
        }
        let x = (ms as f64 * 0.05).sin() * 5e-3;
        let x = if ms == 4_000 {
            f64::NAN
        } else if ms == 2_500 {
            0.1
        } else {
            x
        };
        let pose = Pose::new(Vec3::new(x, 0.0, 0.0), Quat::identity());
        let lost = (2_000..2_050).contains(&ms);
        let buttons = u16::from(ms % 7 == 0) | if ms % 900 > 850 { 2 } else { 0 };
        if ms == 5_000 {
            port.trip(Trip::Driver);
        }
        let shown = if lost {
            Err(Unready::Absent)
        } else {
            Ok(&pose)
        };
        strongest = strongest.max(port.exchange(now_ns, shown, buttons).force.norm());
        let sample = end.sample();
        std::hint::black_box((sample, end.buttons()));
        match sample.stage {
            Stage::Unready(_) => stages[0] = true,
            Stage::Rising => stages[1] = true,
            Stage::Live => stages[2] = true,
            Stage::Clutched => stages[3] = true,
            Stage::Tripped(_) => stages[4] = true,
            Stage::Touching | Stage::Waiting => {}
        }
    }
    let after = calls();
    assert_eq!(stages, [true; 5]);
    assert!(strongest > 0.5, "{strongest} N");
    assert_eq!(after - before, 0, "calls of the allocator");
}
