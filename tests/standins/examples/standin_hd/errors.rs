//! The error stack: newest first, without locks, so that the scheduler's thread never waits for it.

use crate::state;
use std::ffi::{CStr, c_char};
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};
use sulcus_standins::board::{Message, NO_DEVICE};

pub const INVALID_ENUM: u32 = 0x100;
pub const INVALID_VALUE: u32 = 0x101;
pub const INVALID_OPERATION: u32 = 0x102;
pub const INVALID_INPUT_TYPE: u32 = 0x103;
pub const BAD_HANDLE: u32 = 0x104;
pub const WARM_MOTORS: u32 = 0x200;
pub const EXCEEDED_MAX_FORCE: u32 = 0x201;
pub const FORCE_ERROR: u32 = 0x204;
pub const DEVICE_FAULT: u32 = 0x300;
pub const DEVICE_ALREADY_INITIATED: u32 = 0x301;
pub const COMM_ERROR: u32 = 0x302;
pub const COMM_CONFIG_ERROR: u32 = 0x303;
pub const ILLEGAL_END: u32 = 0x401;
pub const FRAME_ERROR: u32 = 0x402;
pub const INVALID_PRIORITY: u32 = 0x500;
pub const SCHEDULER_FULL: u32 = 0x501;

/// Handle of no device.
pub const INVALID_HANDLE: u32 = 0xFFFF_FFFF;

/// Errors that the stack holds; a full stack drops new errors.
const DEPTH: usize = 64;

/// End of a chain of entries.
const END: u32 = u32::MAX;

/// An error as `hdGetError` returns it, by value.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HDErrorInfo {
    /// Code of the error.
    pub error_code: u32,
    /// Code of the driver's own.
    pub internal_error_code: i32,
    /// Handle of the device.
    pub hhd: u32,
}

struct Entry {
    code: AtomicU32,
    hhd: AtomicU32,
    next: AtomicU32,
}

/// Heads of the chains of used and of free entries: a count of changes above, the entry's number below.
static USED: AtomicU64 = AtomicU64::new(END as u64);
static FREE: AtomicU64 = AtomicU64::new(END as u64);
/// Entries that were never used.
static FRESH: AtomicU32 = AtomicU32::new(0);
static ENTRIES: [Entry; DEPTH] = [const {
    Entry {
        code: AtomicU32::new(0),
        hhd: AtomicU32::new(0),
        next: AtomicU32::new(END),
    }
}; DEPTH];

fn put(chain: &AtomicU64, entry: u32) {
    let mut head = chain.load(Ordering::Acquire);
    loop {
        ENTRIES[entry as usize]
            .next
            .store(head as u32, Ordering::Relaxed);
        let new = ((head >> 32).wrapping_add(1) << 32) | u64::from(entry);
        match chain.compare_exchange_weak(head, new, Ordering::AcqRel, Ordering::Acquire) {
            Ok(_) => return,
            Err(newer) => head = newer,
        }
    }
}

fn take(chain: &AtomicU64) -> Option<u32> {
    let mut head = chain.load(Ordering::Acquire);
    loop {
        let entry = head as u32;
        if entry == END {
            return None;
        }
        let next = ENTRIES[entry as usize].next.load(Ordering::Relaxed);
        let new = ((head >> 32).wrapping_add(1) << 32) | u64::from(next);
        match chain.compare_exchange_weak(head, new, Ordering::AcqRel, Ordering::Acquire) {
            Ok(_) => return Some(entry),
            Err(newer) => head = newer,
        }
    }
}

/// Puts an error on the stack and tells the controller.
pub fn raise(code: u32, hhd: u32) {
    let device = state::opened(hhd).map_or(NO_DEVICE, |d| d.number.load(Ordering::Relaxed));
    if let Some(link) = state::link() {
        link.send(device, Message::Error(code));
    }
    let fresh = || {
        FRESH
            .fetch_update(Ordering::AcqRel, Ordering::Acquire, |n| {
                (n < DEPTH as u32).then_some(n + 1)
            })
            .ok()
    };
    if let Some(entry) = take(&FREE).or_else(fresh) {
        ENTRIES[entry as usize].code.store(code, Ordering::Relaxed);
        ENTRIES[entry as usize].hhd.store(hhd, Ordering::Relaxed);
        put(&USED, entry);
    }
}

/// Takes the newest error; code 0 for an empty stack.
#[unsafe(no_mangle)]
pub extern "system" fn hdGetError() -> HDErrorInfo {
    let Some(entry) = take(&USED) else {
        return HDErrorInfo {
            error_code: 0,
            internal_error_code: 0,
            hhd: INVALID_HANDLE,
        };
    };
    let code = ENTRIES[entry as usize].code.load(Ordering::Relaxed);
    let hhd = ENTRIES[entry as usize].hhd.load(Ordering::Relaxed);
    put(&FREE, entry);
    HDErrorInfo {
        error_code: code,
        internal_error_code: -(code as i32),
        hhd,
    }
}

/// Text of an error code.
#[unsafe(no_mangle)]
pub extern "system" fn hdGetErrorString(code: u32) -> *const c_char {
    let text: &CStr = match code {
        0 => c"no error",
        INVALID_ENUM => c"invalid parameter or capability",
        INVALID_VALUE => c"invalid value",
        INVALID_OPERATION => c"invalid operation",
        INVALID_INPUT_TYPE => c"parameter of another type",
        BAD_HANDLE => c"bad device handle",
        WARM_MOTORS => c"warm motors",
        EXCEEDED_MAX_FORCE => c"force above the limit",
        0x202 => c"force impulse above the limit",
        0x203 => c"velocity above the limit",
        FORCE_ERROR => c"force error",
        DEVICE_FAULT => c"device fault",
        DEVICE_ALREADY_INITIATED => c"device already initiated",
        COMM_ERROR => c"communication error",
        COMM_CONFIG_ERROR => c"communication configuration error",
        0x304 => c"timer error",
        0x400 => c"illegal begin of a frame",
        ILLEGAL_END => c"illegal end of a frame",
        FRAME_ERROR => c"frame error",
        INVALID_PRIORITY => c"invalid priority",
        SCHEDULER_FULL => c"scheduler full",
        0x600 => c"invalid license",
        _ => c"unknown error",
    };
    text.as_ptr()
}
