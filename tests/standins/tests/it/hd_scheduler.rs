//! The HD scheduler: its rate, its stalls, its threads.

use crate::support::hd::{OUTPUT, fresh};
use crate::support::{rig, rig_of, sleep_ms, wait_until};
use std::collections::BTreeSet;
use std::ffi::c_void;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;
use sulcus_standins::Fault;
use sulcus_standins::board::Call;
use sulcus_standins::log::{Cause, Event};
use sulcus_standins::setup::{DeviceSetup, Setup};

const LONG: Duration = Duration::from_secs(5);

#[test]
fn a_stall_lets_the_watchdog_cut_the_motors_until_the_next_command() {
    let rig = rig(vec![DeviceSetup::touch("Left", "L1")]);
    let (_one, hd) = fresh(&rig);
    let left = hd.open("Left");
    // SAFETY: a device is current.
    unsafe { (hd.enable)(OUTPUT) };
    let running = hd.run(|| hd.frame(left, [1.0, 0.0, 0.0]));
    rig.wait_log(LONG, |log| log.frames(0) > 5).expect("a log");
    rig.fault(0, Fault::Stall(60)).expect("a fault");
    let stalled = |event: &Event| {
        matches!(
            event,
            Event::Call {
                call: Call::Stall,
                ..
            }
        )
    };
    // The stall is in the log before the command that ends it.
    let (log, done) = rig
        .wait_log(LONG, |log| {
            log.entries.iter().any(|e| stalled(&e.event))
                && log.intervals(0).iter().any(|i| *i >= 55_000_000)
        })
        .expect("a log");
    assert!(done);
    drop(running);
    let fired = log.watchdogs(0).len();
    assert!(fired >= 1);
    let cut = Event::Motors {
        force: [0.0; 3],
        torque: [0.0; 3],
        cause: Cause::Watchdog,
    };
    let off = log.times(0, |e| *e == cut);
    assert_eq!(off.len(), fired);
    for at in off {
        let last = log
            .commands(0)
            .iter()
            .rev()
            .find(|c| c.0 < at)
            .expect("a command")
            .0;
        let waited = at - last;
        assert!((20_000_000..21_000_000).contains(&waited), "{waited} ns");
    }
    assert!(wait_until(
        || rig.log().expect("a log").watchdogs(0).len() > fired
    ));
}

#[test]
fn one_thread_serves_all_callbacks_and_synchronous_ones_wait() {
    static THREADS: Mutex<BTreeSet<String>> = Mutex::new(BTreeSet::new());
    unsafe extern "system" fn note(_: *mut c_void) -> u32 {
        let id = format!("{:?}", std::thread::current().id());
        THREADS.lock().expect("no panic").insert(id);
        0
    }
    let rig = rig(vec![DeviceSetup::touch("Left", "L1")]);
    let (_one, hd) = fresh(&rig);
    hd.open("Left");
    // SAFETY: the callback ignores its argument.
    unsafe {
        (hd.schedule_and_wait)(note, std::ptr::null_mut(), 32767);
        assert_eq!(hd.errors().len(), 1, "the scheduler is off");
        (hd.start)();
        (hd.start)();
        assert_eq!(hd.errors().len(), 1, "the scheduler runs already");
        for _ in 0..3 {
            (hd.schedule_and_wait)(note, std::ptr::null_mut(), 32767);
        }
        (hd.stop)();
    }
    assert_eq!(THREADS.lock().expect("no panic").len(), 1);
    assert_eq!(hd.errors(), []);
}

#[test]
fn the_rate_is_one_of_the_drivers_and_may_be_slower_in_truth() {
    let mut setup = Setup::new(vec![DeviceSetup::touch("Left", "L1")]);
    setup.driver.rates = vec![500, 1000];
    let rig = rig_of(setup);
    let (_one, hd) = fresh(&rig);
    let left = hd.open("Left");
    // SAFETY: any rate is an argument.
    unsafe {
        (hd.rate)(700);
        assert_eq!(hd.errors().len(), 1);
        (hd.rate)(500);
    }
    assert_eq!(hd.errors(), []);
    rig.fault(0, Fault::Rate(100)).expect("a fault");
    let shown = AtomicU32::new(0);
    let running = hd.run(|| {
        hd.frame(left, [0.0; 3]);
        let mut hz = 0;
        // SAFETY: the pointer has room for the parameter.
        unsafe { (hd.get_integer)(0x2601, &mut hz) };
        shown.store(hz as u32, Ordering::Relaxed);
    });
    rig.wait_log(LONG, |log| log.frames(0) >= 20)
        .expect("a log");
    drop(running);
    let mut hz = 0;
    // SAFETY: the pointer has room for the parameter.
    unsafe { (hd.get_integer)(0x2600, &mut hz) };
    assert_eq!(hz, 500);
    let mut intervals = rig.log().expect("a log").intervals(0);
    intervals.sort_unstable();
    let middle = intervals[intervals.len() / 2];
    assert!((7_000_000..14_000_000).contains(&middle), "{middle} ns");
    assert!(shown.load(Ordering::Relaxed) < 300);
}

#[test]
fn jitter_spreads_the_ticks() {
    let rig = rig(vec![DeviceSetup::touch("Left", "L1")]);
    let (_one, hd) = fresh(&rig);
    let left = hd.open("Left");
    rig.fault(0, Fault::Jitter(900)).expect("a fault");
    let running = hd.run(|| hd.frame(left, [0.0; 3]));
    rig.wait_log(LONG, |log| log.frames(0) >= 300)
        .expect("a log");
    drop(running);
    let intervals = rig.log().expect("a log").intervals(0);
    let far = intervals
        .iter()
        .filter(|i| i.abs_diff(1_000_000) > 200_000)
        .count();
    assert!(far > intervals.len() / 5, "{far} of {}", intervals.len());
    sleep_ms(1);
}
