//! What a device is, and its status.

use crate::errors::{self, fail_alone};
use crate::open::number_of;
use crate::state::{code, connect, connected, opened};
use std::ffi::c_char;
use std::sync::atomic::Ordering;
use sulcus_standins::board::Traits;

/// Name of the device's model; null after an error.
#[unsafe(no_mangle)]
pub extern "system" fn dhdGetSystemName(id: c_char) -> *const c_char {
    opened(id).map_or(std::ptr::null(), |open| open.name.as_ptr().cast())
}

/// Type of the device.
#[unsafe(no_mangle)]
pub extern "system" fn dhdGetSystemType(id: c_char) -> i32 {
    code(opened(id).map(|open| open.traits.load().system_type as i32))
}

/// Serial number of the device.
///
/// # Safety
/// `serial` is null or valid.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn dhdGetSerialNumber(serial: *mut u16, id: c_char) -> i32 {
    code(connected(id).map(|(open, slot)| {
        if serial.is_null() {
            return open.fail(errors::NULL_ARGUMENT);
        }
        // SAFETY: the caller's promise; `serial` is not null.
        unsafe { serial.write(number_of(slot).unwrap_or(0) as u16) };
        0
    }))
}

/// Version of the SDK.
///
/// # Safety
/// Every argument is null or valid.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn dhdGetSDKVersion(a: *mut i32, b: *mut i32, c: *mut i32, d: *mut i32) {
    let Some(link) = connect() else {
        fail_alone(errors::NO_DRIVER);
        return;
    };
    for (to, from) in [a, b, c, d].into_iter().zip(&link.board.driver.dhd_version) {
        if !to.is_null() {
            // SAFETY: the caller's promise; `to` is not null.
            unsafe { to.write(from.load(Ordering::Relaxed) as i32) };
        }
    }
}

/// Status of the device: 17 numbers.
///
/// # Safety
/// `status` is null or valid.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn dhdGetStatus(status: *mut [i32; 17], id: c_char) -> i32 {
    let (open, slot) = match opened(id).map(|open| (open, open.slot())) {
        Ok((open, Some(slot))) => (open, slot),
        Ok((open, None)) => return open.fail(errors::COMMUNICATION),
        Err(code) => return code,
    };
    if status.is_null() {
        return open.fail(errors::NULL_ARGUMENT);
    }
    let (state, traits) = (slot.state.load(), open.traits.load());
    let connected = open.is_connected();
    let is = |mode: u64| i32::from(state.mode == mode);
    let wrist = i32::from(traits.wrist != 0.0);
    let values = [
        1,
        connected.into(),
        connected.into(),
        is(0),
        is(1),
        is(2),
        is(3),
        i32::from(state.mode == 2 && traits.active_wrist != 0.0),
        wrist,
        i32::from(!connected),
        state.gravity as i32,
        i32::from(open.guard.load(Ordering::Relaxed) != 0),
        wrist * i32::from(state.mode != 0),
        0,
        state.cause as i32,
        0,
        i32::from(state.mode != 0),
    ];
    // SAFETY: the caller's promise; `status` is not null.
    unsafe { status.write(values) };
    0
}

fn has(id: c_char, property: impl Fn(&Traits) -> f64) -> bool {
    opened(id).is_ok_and(|open| property(&open.traits.load()) != 0.0)
}

/// True for a left-handed device.
#[unsafe(no_mangle)]
pub extern "system" fn dhdIsLeftHanded(id: c_char) -> bool {
    has(id, |t| t.left)
}

/// True for a device with a base.
#[unsafe(no_mangle)]
pub extern "system" fn dhdHasBase(id: c_char) -> bool {
    has(id, |_| 1.0)
}

/// True for a device with a wrist.
#[unsafe(no_mangle)]
pub extern "system" fn dhdHasWrist(id: c_char) -> bool {
    has(id, |t| t.wrist)
}

/// True for a device with motors in its wrist.
#[unsafe(no_mangle)]
pub extern "system" fn dhdHasActiveWrist(id: c_char) -> bool {
    has(id, |t| t.active_wrist)
}

/// True for a device with a gripper.
#[unsafe(no_mangle)]
pub extern "system" fn dhdHasGripper(id: c_char) -> bool {
    has(id, |t| t.gripper)
}

/// True for a device with a motor in its gripper.
#[unsafe(no_mangle)]
pub extern "system" fn dhdHasActiveGripper(id: c_char) -> bool {
    has(id, |t| t.active_gripper)
}
