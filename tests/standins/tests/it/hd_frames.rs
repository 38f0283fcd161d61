//! Frames and the limits of the HD driver.

use crate::support::hd::{FORCE, OUTPUT, fresh};
use crate::support::{rig, wait_until};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU32, Ordering};
use sulcus_standins::setup::DeviceSetup;

#[test]
fn a_tick_has_one_frame_of_a_device_and_frames_nest() {
    let rig = rig(vec![DeviceSetup::touch("Left", "L1")]);
    let (_one, hd) = fresh(&rig);
    let left = hd.open("Left");
    let ticks = AtomicU32::new(0);
    let seen = Mutex::new(Vec::new());
    let running = hd.run(|| {
        if ticks.fetch_add(1, Ordering::AcqRel) == 0 {
            // SAFETY: the handle is open.
            unsafe {
                (hd.begin)(left);
                (hd.begin)(left);
                (hd.end)(left);
                hd.set(FORCE, [0.5, 0.0, 0.0]);
                (hd.end)(left);
                (hd.begin)(left);
                (hd.end)(left);
            }
            *seen.lock().expect("no panic") = hd.errors();
        }
    });
    assert!(wait_until(|| ticks.load(Ordering::Acquire) > 2));
    drop(running);
    assert_eq!(
        *seen.lock().expect("no panic"),
        [(0x401, left), (0x402, left)]
    );
    let log = rig.log().expect("a log");
    assert_eq!(log.frames(0), 1);
    assert_eq!(log.commands(0)[0].1.asked_force, [0.5, 0.0, 0.0]);
}

#[test]
fn a_force_above_the_limit_is_an_error_or_is_clamped() {
    let rig = rig(vec![DeviceSetup::touch("Left", "L1")]);
    let (_one, hd) = fresh(&rig);
    let left = hd.open("Left");
    // SAFETY: a device is current.
    unsafe { (hd.enable)(OUTPUT) };
    hd.frame(left, [10.0, 0.0, 0.0]);
    assert_eq!(hd.errors(), [(0x201, left)]);
    // SAFETY: a device is current.
    unsafe { (hd.enable)(0x4001) };
    hd.frame(left, [10.0, 0.0, 0.0]);
    hd.frame(left, [f64::NAN, 0.0, 0.0]);
    assert_eq!(hd.errors(), [(0x204, left)]);
    let log = rig.log().expect("a log");
    let sent: Vec<_> = log.commands(0).iter().map(|c| c.1.force[0]).collect();
    assert_eq!(sent, [0.0, 3.3, 0.0]);
    assert_eq!(log.commands(0)[0].1.asked_force, [10.0, 0.0, 0.0]);
    assert!(log.largest_asked(0).is_nan());
    assert_eq!(log.largest_force(0), 3.3);
    assert_eq!(log.errors(0), [0x201, 0x204]);
}

#[test]
fn the_ramp_of_the_driver_limits_the_force_after_the_start() {
    let mut device = DeviceSetup::touch("Left", "L1");
    device.traits.ramp = 1e-3;
    let rig = rig(vec![device]);
    let (_one, hd) = fresh(&rig);
    let left = hd.open("Left");
    // SAFETY: a device is current.
    unsafe {
        (hd.enable)(0x4002);
        (hd.enable)(OUTPUT);
    }
    hd.frame(left, [1.0, 0.0, 0.0]);
    let log = rig.log().expect("a log");
    let (_, command) = log.commands(0)[0];
    assert_eq!(command.asked_force[0], 1.0);
    assert!(command.force[0] < 0.1, "{}", command.force[0]);
}

#[test]
fn parameters_have_their_types() {
    let rig = rig(vec![DeviceSetup::touch("Left", "L1")]);
    let (_one, hd) = fresh(&rig);
    let left = hd.open("Left");
    let mut number = 0i32;
    let mut wide = [0; 6];
    let mut small = 0f32;
    let mut on = 7u8;
    let mut double = [0.0; 1];
    // SAFETY: every pointer has room for its parameter.
    unsafe {
        (hd.get_integer)(0x2554, &mut number);
        (hd.get_long)(0x2010, wide.as_mut_ptr());
        (hd.get_float)(0x2552, &mut small);
        (hd.get_boolean)(0x2002, &mut on);
        assert_eq!(hd.errors(), []);
        (hd.get_double)(0x2554, double.as_mut_ptr());
        (hd.get_double)(0x2999, double.as_mut_ptr());
        (hd.get_double)(0x2603, std::ptr::null_mut());
    }
    assert_eq!(hd.errors(), [(0x101, left), (0x100, left), (0x103, left)]);
    assert_eq!((number, on, small), (3, 0, 110.0));
    let [x, .., top] = hd.doubles::<6>(0x2551);
    assert_eq!((x, top), (-80.0, 35.0));
}
