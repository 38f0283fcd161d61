//! Setting of parameters: force and torque of the current device's frame.

use crate::errors::{INVALID_ENUM, INVALID_HANDLE, INVALID_OPERATION, INVALID_VALUE, raise};
use crate::state::current;
use std::ffi::c_long;
use std::sync::atomic::Ordering;

/// Sets a parameter of the current device; `number` returns the numbers of the value.
fn set(parameter: u32, null: bool, number: impl Fn(usize) -> f64) {
    let Some((hhd, open)) = current() else {
        return raise(INVALID_OPERATION, INVALID_HANDLE);
    };
    if null {
        return raise(INVALID_VALUE, hhd);
    }
    let first = match parameter {
        0x2700 => 0,
        0x2701 => 3,
        0x2608 => return open.ramp.store(number(0).to_bits(), Ordering::Relaxed),
        0x2606 | 0x2607 => return,
        _ => return raise(INVALID_ENUM, hhd),
    };
    if open.depth.load(Ordering::Relaxed) == 0 {
        return raise(INVALID_OPERATION, hhd);
    }
    if first == 3 && open.traits.load().output_dof < 6.0 {
        // The log shows the torque that the client asked of a device without torque.
        raise(INVALID_OPERATION, hhd);
    }
    for i in 0..3 {
        open.set[first + i].store(number(i).to_bits(), Ordering::Relaxed);
    }
    open.sets.fetch_add(1, Ordering::Relaxed);
}

/// Sets doubles.
///
/// # Safety
/// `value` holds the numbers of the parameter.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn hdSetDoublev(parameter: u32, value: *const f64) {
    // SAFETY: the caller's promise; a null pointer is not read.
    set(parameter, value.is_null(), |i| unsafe {
        value.add(i).read()
    });
}

/// Sets floats.
///
/// # Safety
/// `value` holds the numbers of the parameter.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn hdSetFloatv(parameter: u32, value: *const f32) {
    // SAFETY: the caller's promise; a null pointer is not read.
    set(parameter, value.is_null(), |i| {
        f64::from(unsafe { value.add(i).read() })
    });
}

fn no_such() {
    match current() {
        Some((hhd, _)) => raise(INVALID_ENUM, hhd),
        None => raise(INVALID_OPERATION, INVALID_HANDLE),
    }
}

/// No parameter of booleans can be set.
#[unsafe(no_mangle)]
pub extern "system" fn hdSetBooleanv(_parameter: u32, _value: *const u8) {
    no_such();
}

/// No parameter of integers can be set.
#[unsafe(no_mangle)]
pub extern "system" fn hdSetIntegerv(_parameter: u32, _value: *const i32) {
    no_such();
}

/// No parameter of long integers can be set.
#[unsafe(no_mangle)]
pub extern "system" fn hdSetLongv(_parameter: u32, _value: *const c_long) {
    no_such();
}
