//! Errors, one for each thread.

use crate::state;
use std::cell::Cell;
use std::ffi::{CStr, c_char};
use sulcus_standins::board::{Message, NO_DEVICE};

pub const COMMUNICATION: i32 = 2;
pub const NO_DRIVER: i32 = 4;
pub const NO_DEVICE_FOUND: i32 = 5;
pub const NOT_AVAILABLE: i32 = 6;
pub const TIMEOUT: i32 = 7;
pub const EXPERT_MODE_OFF: i32 = 9;
pub const NOT_IMPLEMENTED: i32 = 10;
pub const NOT_READY: i32 = 12;
pub const INVALID_INDEX: i32 = 15;
pub const NULL_ARGUMENT: i32 = 17;
pub const NOT_ENABLED: i32 = 19;
pub const IN_USE: i32 = 20;
pub const INVALID: i32 = 21;

thread_local! {
    static LAST: Cell<i32> = const { Cell::new(0) };
}

/// Notes an error of this thread about the device with this number on the board, and returns -1.
pub fn fail(code: i32, device: u64) -> i32 {
    LAST.set(code);
    if let Some(link) = state::link() {
        link.send(device, Message::Error(code as u32));
    }
    -1
}

/// Notes an error without a device, and returns -1.
pub fn fail_alone(code: i32) -> i32 {
    fail(code, NO_DEVICE)
}

/// Forgets the error of this thread.
pub fn forget() {
    LAST.set(0);
}

/// Last error of this thread.
#[unsafe(no_mangle)]
pub extern "system" fn dhdErrorGetLast() -> i32 {
    LAST.get()
}

/// Text of the last error of this thread.
#[unsafe(no_mangle)]
pub extern "system" fn dhdErrorGetLastStr() -> *const c_char {
    dhdErrorGetStr(LAST.get())
}

/// Text of an error.
#[unsafe(no_mangle)]
pub extern "system" fn dhdErrorGetStr(code: i32) -> *const c_char {
    let text: &CStr = match code {
        0 => c"no error",
        1 => c"error",
        COMMUNICATION => c"communication error",
        3 => c"controller busy",
        NO_DRIVER => c"no driver",
        NO_DEVICE_FOUND => c"no device",
        NOT_AVAILABLE => c"not available",
        TIMEOUT => c"timeout",
        8 => c"geometry error",
        EXPERT_MODE_OFF => c"expert mode is off",
        NOT_IMPLEMENTED => c"not implemented",
        11 => c"out of memory",
        NOT_READY => c"device not ready",
        13 => c"file error",
        14 => c"configuration error",
        INVALID_INDEX => c"invalid index",
        16 => c"deprecated",
        NULL_ARGUMENT => c"null argument",
        18 => c"redundant encoder failed",
        NOT_ENABLED => c"not enabled",
        IN_USE => c"device in use",
        INVALID => c"invalid value",
        22 => c"no regulation",
        _ => c"unknown error",
    };
    text.as_ptr()
}
