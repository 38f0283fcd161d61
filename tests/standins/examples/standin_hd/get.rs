//! Reading of parameters, except the doubles.

use crate::errors::{
    INVALID_ENUM, INVALID_HANDLE, INVALID_INPUT_TYPE, INVALID_OPERATION, INVALID_VALUE, raise,
};
use crate::state::{Open, current};
use crate::values::{Value, value};
use std::ffi::{c_char, c_long};
use std::sync::atomic::AtomicU8;

/// Gives the value of a parameter of the current device to `write`, which returns false for a wrong type.
pub fn read(parameter: u32, null: bool, write: impl FnOnce(&Open, Value) -> bool) {
    let Some((hhd, open)) = current() else {
        return raise(INVALID_OPERATION, INVALID_HANDLE);
    };
    if null {
        return raise(INVALID_VALUE, hhd);
    }
    match value(open, parameter) {
        None => raise(INVALID_ENUM, hhd),
        Some(value) => {
            if !write(open, value) {
                raise(INVALID_INPUT_TYPE, hhd);
            }
        }
    }
}

/// Reads a boolean.
///
/// # Safety
/// `out` has room for the parameter.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn hdGetBooleanv(parameter: u32, out: *mut u8) {
    read(parameter, out.is_null(), |_, value| match value {
        Value::Bool(on) => {
            // SAFETY: the caller's promise; `out` is not null.
            unsafe { out.write(on.into()) };
            true
        }
        _ => false,
    });
}

/// Reads an integer.
///
/// # Safety
/// `out` has room for the parameter.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn hdGetIntegerv(parameter: u32, out: *mut i32) {
    read(parameter, out.is_null(), |_, value| match value {
        Value::I32(number) => {
            // SAFETY: the caller's promise; `out` is not null.
            unsafe { out.write(number) };
            true
        }
        _ => false,
    });
}

/// Reads floats.
///
/// # Safety
/// `out` has room for the parameter.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn hdGetFloatv(parameter: u32, out: *mut f32) {
    read(parameter, out.is_null(), |_, value| {
        let (numbers, count) = match value {
            Value::F32(number) => ([f64::from(number); 16], 1),
            Value::F64(numbers, count) => (numbers, count),
            _ => return false,
        };
        for (i, number) in numbers.iter().take(count).enumerate() {
            // SAFETY: the caller's promise; `out` is not null.
            unsafe { out.add(i).write(*number as f32) };
        }
        true
    });
}

/// Reads long integers.
///
/// # Safety
/// `out` has room for the parameter.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn hdGetLongv(parameter: u32, out: *mut c_long) {
    read(parameter, out.is_null(), |_, value| match value {
        Value::Long(numbers) => {
            for (i, number) in numbers.iter().enumerate() {
                // SAFETY: the caller's promise; `out` is not null.
                unsafe { out.add(i).write(*number as c_long) };
            }
            true
        }
        _ => false,
    });
}

/// Text of a parameter of the current device; null after an error. The text lives as long as the device is open.
#[unsafe(no_mangle)]
pub extern "system" fn hdGetString(parameter: u32) -> *const c_char {
    let mut text = std::ptr::null();
    read(parameter, false, |open, value| match value {
        Value::Text(i) => {
            text = open.texts[i].as_ptr().cast::<c_char>();
            const { assert!(size_of::<AtomicU8>() == 1) };
            true
        }
        _ => false,
    });
    text
}
