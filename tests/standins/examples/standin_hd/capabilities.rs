//! Capabilities of the current device.

use crate::errors::{INVALID_ENUM, INVALID_HANDLE, INVALID_OPERATION, raise};
use crate::state::{Open, current, link};
use std::sync::atomic::Ordering;
use sulcus_standins::board::{Call, Message};
use sulcus_standins::clock;

pub const FORCE_OUTPUT: u32 = 0x4000;
pub const MAX_FORCE_CLAMPING: u32 = 0x4001;
pub const FORCE_RAMPING: u32 = 0x4002;
pub const SOFTWARE_FORCE_LIMIT: u32 = 0x4003;
pub const ONE_FRAME_LIMIT: u32 = 0x4004;

/// Capabilities in the order of their bits.
const ALL: [u32; 7] = [
    FORCE_OUTPUT,
    MAX_FORCE_CLAMPING,
    FORCE_RAMPING,
    SOFTWARE_FORCE_LIMIT,
    ONE_FRAME_LIMIT,
    0x2606,
    0x2607,
];

/// Bits of the capabilities that are on after the opening: the force limit and the limit of one frame per tick.
pub const DEFAULTS: u32 = 0b11000;

fn bit(capability: u32) -> Option<u32> {
    ALL.iter().position(|c| *c == capability).map(|i| 1 << i)
}

impl Open {
    /// True when the capability is on.
    pub fn has(&self, capability: u32) -> bool {
        bit(capability).is_some_and(|bit| self.capabilities.load(Ordering::Acquire) & bit != 0)
    }
}

fn change(capability: u32, on: bool) {
    let Some((hhd, open)) = current() else {
        return raise(INVALID_OPERATION, INVALID_HANDLE);
    };
    let Some(bit) = bit(capability) else {
        return raise(INVALID_ENUM, hhd);
    };
    if on {
        if open.capabilities.fetch_or(bit, Ordering::AcqRel) & bit == 0
            && capability == FORCE_OUTPUT
        {
            open.enabled_at.store(clock::now_ns(), Ordering::Release);
        }
    } else {
        open.capabilities.fetch_and(!bit, Ordering::AcqRel);
    }
    if let Some(link) = link() {
        let call = if on { Call::Enable } else { Call::Disable };
        let number = open.number.load(Ordering::Relaxed);
        link.send(number, Message::Call(call, f64::from(capability)));
    }
}

/// Turns a capability of the current device on.
#[unsafe(no_mangle)]
pub extern "system" fn hdEnable(capability: u32) {
    change(capability, true);
}

/// Turns a capability of the current device off.
#[unsafe(no_mangle)]
pub extern "system" fn hdDisable(capability: u32) {
    change(capability, false);
}

/// 1 when the capability of the current device is on.
#[unsafe(no_mangle)]
pub extern "system" fn hdIsEnabled(capability: u32) -> u8 {
    let Some((hhd, open)) = current() else {
        raise(INVALID_OPERATION, INVALID_HANDLE);
        return 0;
    };
    if bit(capability).is_none() {
        raise(INVALID_ENUM, hhd);
    }
    open.has(capability).into()
}
