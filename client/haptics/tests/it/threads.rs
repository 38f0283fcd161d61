//! The loop of the link and the device, each in a thread of its own.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use sulcus_core::{Pose, Vec3, Wrench};
use sulcus_haptics::port::door;
use sulcus_haptics::{Stage, Wanted};

use crate::named::rules;

const MS: u64 = 1_000_000;
/// Orders before the panic: the tool touches from one second on.
const TOUCHES: u64 = 1_000;

fn order(ms: u64, now_ns: u64) -> Wanted {
    let force = if ms < TOUCHES { 0.0 } else { 2.0 };
    Wanted {
        wrench: Wrench {
            force: Vec3::new(force, 0.0, 0.0),
            torque: Vec3::zeros(),
        },
        heard_ns: Some(now_ns),
        ..Wanted::NOTHING
    }
}

/// Both threads share a clock that the device's thread moves on by 1 ms a period. The loop panics at a force of 2 N,
/// in the middle of its work; its end of the door is dropped by the unwinding.
#[test]
fn the_force_is_zero_twenty_milliseconds_after_the_loop_panicked() {
    let (mut port, end) = door(rules());
    let (now, died) = (&AtomicU64::new(0), &AtomicU64::new(u64::MAX));
    let forces: Vec<(u64, f64)> = thread::scope(|scope| {
        scope.spawn(|| {
            let mut end = end;
            let result = catch_unwind(AssertUnwindSafe(move || {
                let mut ms = 0;
                loop {
                    let at = now.load(Ordering::Acquire);
                    if at / MS > ms {
                        ms = at / MS;
                        end.order(&order(ms, at));
                        let strong = end.sample().displayed.force.norm() > 1.9;
                        if strong && ms >= 2_500 {
                            // The time of the last order: the unwinding takes longer.
                            died.store(at, Ordering::Release);
                            panic!("the loop dies");
                        }
                    }
                    thread::yield_now();
                }
            }));
            assert!(result.is_err());
        });
        let device = scope.spawn(|| {
            let (mut at, mut forces) = (0, Vec::new());
            let begun = Instant::now();
            while at < died.load(Ordering::Acquire).saturating_add(100 * MS) {
                at += MS;
                now.store(at, Ordering::Release);
                let buttons =
                    u16::from(at / MS > 20 && at / MS < 900 && (at / MS).is_multiple_of(2));
                let wrench = port.exchange(at, Ok(&Pose::identity()), buttons);
                forces.push((at, wrench.force.norm()));
                // The other thread needs time for its order, most of all on a machine with one core.
                thread::sleep(Duration::from_micros(200));
                assert!(
                    begun.elapsed() < Duration::from_secs(120),
                    "no panic: {:?}",
                    port.stage()
                );
            }
            forces
        });
        device.join().expect("the device")
    });
    let died = died.load(Ordering::Acquire);
    let strongest = forces.iter().map(|(_, force)| *force).fold(0.0, f64::max);
    assert!(strongest > 1.9, "{strongest} N");
    let late: Vec<_> = forces
        .iter()
        .filter(|(at, _)| *at >= died + 20 * MS)
        .collect();
    assert!(
        late.len() > 50 && late.iter().all(|(_, force)| *force == 0.0),
        "{late:?}"
    );
    let held = forces.iter().any(|(at, force)| *at > died && *force > 1.9);
    assert!(held, "no force after the last order");
}

/// The same with the clock of the machine, and bounds for a busy machine: the time is that of the call, and a call
/// that comes late finds the force at zero as well.
#[test]
fn the_force_is_zero_twenty_milliseconds_after_the_loop_panicked_by_the_clock_of_the_machine() {
    let (mut port, end) = door(rules());
    let begun = Instant::now();
    let now_ns = move || begun.elapsed().as_nanos() as u64;
    let died = &AtomicU64::new(u64::MAX);
    let (zero_late, strongest) = thread::scope(|scope| {
        scope.spawn(|| {
            let mut end = end;
            let result = catch_unwind(AssertUnwindSafe(move || {
                loop {
                    let at = now_ns();
                    end.order(&order(at / MS, at));
                    if at >= 2_500 * MS {
                        died.store(at, Ordering::Release);
                        panic!("the loop dies");
                    }
                    thread::sleep(Duration::from_micros(700));
                }
            }));
            assert!(result.is_err());
        });
        let device = scope.spawn(|| {
            let (mut late, mut strongest, mut calls) = (true, 0.0_f64, 0_u64);
            loop {
                let at = now_ns();
                calls += 1;
                let buttons = u16::from(at / MS < 900 && calls % 2 == 0);
                let force = port
                    .exchange(at, Ok(&Pose::identity()), buttons)
                    .force
                    .norm();
                strongest = strongest.max(force);
                let died = died.load(Ordering::Acquire);
                late &= at < died.saturating_add(20 * MS) || force == 0.0;
                if at > died.saturating_add(100 * MS) {
                    assert!(!matches!(port.stage(), Stage::Unready(_)));
                    return (late, strongest);
                }
                thread::sleep(Duration::from_micros(900));
            }
        });
        device.join().expect("the device")
    });
    assert!(zero_late, "a force 20 ms after the loop");
    assert!(strongest > 0.5, "{strongest} N");
}
