//! Opening of HD devices, and the current device.

use crate::support::hd::{FORCE, NONE, OUTPUT, TORQUE, fresh};
use crate::support::{c_path, rig, rig_of};
use sulcus_standins::Fault;
use sulcus_standins::library;
use sulcus_standins::setup::{DeviceSetup, Setup};

fn two() -> Vec<DeviceSetup> {
    vec![
        DeviceSetup::touch("Left", "L1"),
        DeviceSetup::touch_x("Right", "R1"),
    ]
}

#[test]
fn a_device_opens_by_its_name_once() {
    let rig = rig(two());
    let (_one, hd) = fresh(&rig);
    assert_eq!(hd.open("right"), NONE);
    assert_eq!(hd.errors(), [(0x300, NONE)]);
    let right = hd.open("Right");
    assert_eq!(hd.errors(), []);
    assert_eq!(hd.open("Right"), NONE);
    assert_eq!(hd.errors(), [(0x301, NONE)]);
    // SAFETY: null asks for the first device.
    let left = unsafe { (hd.init)(std::ptr::null()) };
    assert_ne!(left, right);
    let texts = |hhd| {
        // SAFETY: the handle is open.
        unsafe { (hd.make_current)(hhd) };
        (hd.text(0x2501), hd.text(0x2504), hd.text(0x2500))
    };
    assert_eq!(texts(left), ("Touch".into(), "L1".into(), "3.4.0".into()));
    assert_eq!(
        texts(right),
        ("Touch X".into(), "R1".into(), "3.4.0".into())
    );
    assert_eq!(hd.doubles::<1>(0x2603), [7.9]);
    assert_eq!(hd.errors(), []);
    // SAFETY: the handle is open.
    unsafe { (hd.disable_device)(right) };
    assert_ne!(hd.open("Right"), NONE);
}

#[test]
fn a_wrong_version_shows_at_the_opening() {
    let mut setup = Setup::new(two());
    setup.driver.hd_version = "1.0".into();
    let rig = rig_of(setup);
    let (_one, hd) = fresh(&rig);
    hd.open("Left");
    assert_eq!(hd.text(0x2500), "1.0");
}

#[test]
fn a_force_belongs_to_the_current_device_alone() {
    let rig = rig(two());
    let (_one, hd) = fresh(&rig);
    let (left, right) = (hd.open("Left"), hd.open("Right"));
    // SAFETY: the handles are open.
    unsafe {
        assert_eq!((hd.current)(), right);
        (hd.make_current)(left);
        (hd.enable)(OUTPUT);
        assert_eq!((hd.is_enabled)(OUTPUT), 1);
        (hd.begin)(left);
        (hd.begin)(right);
        assert_eq!((hd.is_enabled)(OUTPUT), 0);
        hd.set(FORCE, [0.0, 1.0, 0.0]);
        (hd.end)(right);
        (hd.end)(left);
        // The right device is current and outside of a frame.
        hd.set(FORCE, [0.0, 2.0, 0.0]);
    }
    assert_eq!(hd.errors(), [(0x102, right)]);
    let log = rig.log().expect("a log");
    let of = |device| {
        let commands = log.commands(device);
        assert_eq!(commands.len(), 1);
        (
            commands[0].1.asked_force,
            commands[0].1.enabled,
            commands[0].1.sets,
        )
    };
    assert_eq!(of(0), ([0.0; 3], true, 0));
    assert_eq!(of(1), ([0.0, 1.0, 0.0], false, 1));
    assert_eq!(log.largest_force(1), 0.0);
    assert_eq!(log.errors(1), [0x102]);
}

#[test]
fn torque_reaches_a_device_with_six_motors_alone() {
    let rig = rig(vec![
        DeviceSetup::premium("Premium", "P1"),
        DeviceSetup::touch("Touch", "T1"),
    ]);
    let (_one, hd) = fresh(&rig);
    let (premium, touch) = (hd.open("Premium"), hd.open("Touch"));
    // SAFETY: the handles are open.
    unsafe {
        for hhd in [premium, touch] {
            (hd.make_current)(hhd);
            (hd.enable)(OUTPUT);
            (hd.begin)(hhd);
            hd.set(FORCE, [1.0, 0.0, 0.0]);
            hd.set(TORQUE, [0.0, 50.0, 0.0]);
            (hd.end)(hhd);
        }
    }
    assert_eq!(hd.errors(), [(0x102, touch)]);
    let log = rig.log().expect("a log");
    assert_eq!(log.commands(0)[0].1.torque, [0.0, 0.05, 0.0]);
    assert_eq!(log.largest_torque(0), 0.05);
    assert_eq!(log.commands(1)[0].1.asked_torque, [0.0, 0.05, 0.0]);
    assert_eq!(log.largest_torque(1), 0.0);
    assert_eq!(log.largest_force(1), 1.0);
}

#[test]
fn a_second_load_in_one_process_is_refused() {
    let rig = rig(two());
    let (_one, _hd) = fresh(&rig);
    let directory = tempfile::tempdir().expect("a directory");
    let copy = directory.path().join("libHD.so");
    std::fs::copy(library("standin_hd").expect("built"), &copy).expect("copied");
    let second = crate::support::hd::Hd::load(&copy);
    let board = c_path(&rig.board());
    // SAFETY: the path is a C text.
    assert_eq!(unsafe { (second.reset)(board.as_ptr()) }, 0);
    assert_eq!(second.open("Left"), NONE);
    assert_eq!(second.errors(), [(0x300, NONE)]);
}

#[test]
fn an_opening_fails_with_the_code_that_the_test_sets() {
    let rig = rig(two());
    let (_one, hd) = fresh(&rig);
    rig.fault(0, Fault::OpenError(0x600)).expect("a fault");
    assert_eq!(hd.open("Left"), NONE);
    assert_eq!(hd.errors(), [(0x600, NONE)]);
    rig.fault(0, Fault::OpenError(0)).expect("a fault");
    assert_ne!(hd.open("Left"), NONE);
}

#[test]
fn a_load_after_an_unload_is_refused() {
    type Reset = unsafe extern "system" fn(*const std::ffi::c_char) -> u8;
    let rig = rig(two());
    let board = c_path(&rig.board());
    let directory = tempfile::tempdir().expect("a directory");
    let copy = directory.path().join("libHD.so");
    std::fs::copy(library("standin_hd").expect("built"), &copy).expect("copied");
    let load = || {
        // SAFETY: the stand-in has the function with this signature; no thread of it runs at the unload.
        unsafe {
            let library = libloading::Library::new(&copy).expect("a library");
            let reset = *library.get::<Reset>("standin_reset").expect("a function");
            let linked = reset(board.as_ptr());
            library.close().expect("closed");
            linked
        }
    };
    assert_eq!(load(), 1);
    assert_eq!(load(), 0);
}
