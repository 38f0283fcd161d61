//! The binary interface of the HDAPI stand-in.

use crate::support::hd::{ErrorInfo, NAMES, NONE, fresh};
use crate::support::{rig, sleep_ms};
use libloading::Library;
use std::ffi::{CStr, c_void};
use std::sync::Mutex;
use sulcus_standins::library;
use sulcus_standins::pose::Pose;
use sulcus_standins::setup::{DeviceSetup, Hand};

#[test]
fn the_library_has_the_36_names_of_the_vendor() {
    // SAFETY: loading the stand-in runs no code; the names are looked up only.
    unsafe {
        let library_of = |name: &str| Library::new(library(name).expect("built")).expect("loaded");
        let (whole, missing, empty) = (
            library_of("standin_hd"),
            library_of("standin_hd_missing"),
            library_of("standin_empty"),
        );
        let has = |library: &Library, name: &str| library.get::<*const c_void>(name).is_ok();
        let names: Vec<_> = NAMES.iter().filter(|n| n.starts_with("hd")).collect();
        assert_eq!(names.len(), 36);
        for name in names {
            assert!(has(&whole, name), "{name}");
            assert_eq!(has(&missing, name), *name != "hdGetDoublev", "{name}");
            assert!(!has(&empty, name), "{name}");
        }
        std::mem::forget((whole, missing, empty));
    }
}

#[test]
fn errors_come_by_value_newest_first_with_their_device() {
    assert_eq!(size_of::<ErrorInfo>(), 12);
    let rig = rig(vec![
        DeviceSetup::touch("Left", "L1"),
        DeviceSetup::touch("Right", "R1"),
    ]);
    let (_one, hd) = fresh(&rig);
    let (left, right) = (hd.open("Left"), hd.open("Right"));
    // SAFETY: the functions accept any handle.
    unsafe {
        (hd.end)(left);
        (hd.make_current)(77);
        (hd.enable)(0x9999);
        let before = [0x5555_5555_5555_5555u64; 2];
        let info = (hd.error)();
        let after = [0x5555_5555_5555_5555u64; 2];
        assert_eq!((info.code, info.hhd), (0x100, right));
        assert!(info.internal < 0);
        assert_eq!(before, after);
        assert_eq!(hd.errors(), [(0x104, 77), (0x401, left)]);
        assert_eq!((hd.error)().code, 0);
        let text = CStr::from_ptr((hd.error_string)(0x104));
        assert!(!text.is_empty());
    }
}

#[test]
fn the_transform_has_its_columns_first_and_is_not_exactly_orthonormal() {
    let mut device = DeviceSetup::touch("Left", "L1");
    device.angle_step = 0.0;
    let pose = Pose::at([0.01, -0.02, 0.033]).turned([1.0, 2.0, -0.5], 0.9);
    let rig = rig(vec![device.with_hand(Hand::rest(pose))]);
    let (_one, hd) = fresh(&rig);
    let hhd = hd.open("Left");
    hd.frame(hhd, [0.0; 3]);
    let t = hd.doubles::<16>(0x2052);
    let r = pose.matrix();
    let mut deviation = 0.0f64;
    for column in 0..3 {
        for row in 0..3 {
            let difference = (t[4 * column + row] - r[row][column]).abs();
            assert!(
                difference < 3e-3,
                "column {column}, row {row}: {difference}"
            );
            deviation = deviation.max(difference);
        }
        assert!((t[12 + column] - pose.position[column] * 1e3).abs() < 0.06);
        assert_eq!(t[4 * column + 3], 0.0);
    }
    assert_eq!(t[15], 1.0);
    assert!(deviation > 2e-4, "{deviation}");
}

/// Numbers of the callbacks in the order of their calls.
static CALLS: Mutex<Vec<usize>> = Mutex::new(Vec::new());

unsafe extern "system" fn three_times(user: *mut c_void) -> u32 {
    let mut calls = CALLS.lock().expect("no panic");
    calls.push(user.addr());
    u32::from(calls.iter().filter(|c| **c == user.addr()).count() < 3)
}

#[test]
fn handles_are_wide_and_priorities_order_the_callbacks() {
    let rig = rig(vec![DeviceSetup::touch("Left", "L1")]);
    let (_one, hd) = fresh(&rig);
    // SAFETY: the callback reads its argument as a number.
    unsafe {
        let low = (hd.schedule)(three_times, std::ptr::without_provenance_mut(1), 1);
        let high = (hd.schedule)(three_times, std::ptr::without_provenance_mut(2), 65535);
        assert!(low > u64::from(u32::MAX) && high > low);
        assert_eq!((hd.wait)(low, 0), 1);
        (hd.start)();
        assert_eq!((hd.wait)(low, 1), 0);
        (hd.stop)();
        assert_eq!(*CALLS.lock().expect("no panic"), [2, 1, 2, 1, 2, 1]);
        (hd.unschedule)(low);
    }
    assert_eq!(hd.errors(), [(0x101, NONE)]);
    sleep_ms(1);
}
