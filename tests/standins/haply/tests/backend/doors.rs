//! Rules of the doors, and the loop that drives their other ends.

use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use sulcus_core::{Pose, Quat, Vec3, Wrench};
use sulcus_haptics::continuous::ContinuousLimit;
use sulcus_haptics::device::HandInfo;
use sulcus_haptics::door::{DoorRules, Guard, Wanted};
use sulcus_haptics::freshness::Silence;
use sulcus_haptics::port::HandEnd;
use sulcus_haptics::{Limits, Mapping, PassivityParams, SlewLimits, Stage};
use sulcus_standin_haply::now_ns;

use crate::rig::{PEAK_N, Plan, SLEW, Shared};

/// Rules without a controller: the service gets the orders as they are.
pub fn rules(info: &HandInfo) -> DoorRules {
    let lasting = |peak| ContinuousLimit {
        lasting: peak,
        peak,
        time_s: 10.0,
    };
    let passivity = PassivityParams {
        period_s: info.period_ns as f64 * 1e-9,
        ..PassivityParams::observing()
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
        force: lasting(PEAK_N),
        torque: lasting(1.0),
        clutch: 0,
    };
    let limits = Limits {
        force_n: PEAK_N,
        torque_nm: 1.0,
    };
    let slew = SlewLimits {
        force_n_per_ms: SLEW,
        torque_nm_per_ms: 0.1,
    };
    DoorRules::guarded(limits, slew, passivity, guard)
}

/// Drives the ends until the rig ends: an order each millisecond.
pub fn link(shared: &Shared, mut ends: Vec<HandEnd>, plan: &Plan) {
    let mut presses = vec![(0, 0); ends.len()];
    let is = |flag: &AtomicBool| flag.load(Ordering::Acquire);
    while !is(&shared.end) {
        let now = now_ns();
        let mut seen = shared.seen.lock().unwrap();
        for (hand, end) in ends.iter_mut().enumerate() {
            let sample = end.sample();
            let seen = &mut seen[hand];
            if seen
                .stages
                .last()
                .is_none_or(|(_, stage)| *stage != sample.stage)
            {
                seen.stages.push((now, sample.stage));
            }
            if is(&shared.records) && seen.sample.sequence != sample.sequence {
                seen.poses.push(sample);
            }
            seen.sample = sample;
            seen.buttons |= end.buttons();
            let has_force = matches!(sample.stage, Stage::Rising | Stage::Live);
            let waits = matches!(sample.stage, Stage::Waiting | Stage::Tripped(_));
            let (count, pressed_ns) = &mut presses[hand];
            if waits && is(&shared.presses) && now > *pressed_ns + 20_000_000 {
                (*count, *pressed_ns) = (*count + 1, now);
            }
            if !is(&shared.silent) {
                let force = if has_force {
                    plan(hand, now as f64 * 1e-9)
                } else {
                    Vec3::zeros()
                };
                end.order(&Wanted {
                    wrench: Wrench {
                        force,
                        torque: Vec3::zeros(),
                    },
                    heard_ns: Some(now),
                    presses: *count,
                    ..Wanted::NOTHING
                });
                shared.ordered_ns.store(now, Ordering::Release);
            }
        }
        drop(seen);
        thread::sleep(Duration::from_micros(900));
    }
}
