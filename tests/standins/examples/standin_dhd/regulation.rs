//! The functions of libdrd.

use crate::errors;
use crate::open;
use crate::state::{code, connected, opened};
use std::ffi::c_char;
use sulcus_standins::board::{Call, Message};
use sulcus_standins::clock::{self, MS};

/// Opens the device at this place; its id, or -1.
#[unsafe(no_mangle)]
pub extern "system" fn drdOpenID(index: c_char) -> i32 {
    open::dhdOpenID(index)
}

/// True for a calibrated device.
#[unsafe(no_mangle)]
pub extern "system" fn drdIsInitialized(id: c_char) -> bool {
    connected(id).is_ok_and(|(_, slot)| slot.state.load().calibration == 0)
}

/// Moves and calibrates the device, and waits until it is done.
#[unsafe(no_mangle)]
pub extern "system" fn drdAutoInit(id: c_char) -> i32 {
    code(connected(id).map(|(open, slot)| {
        if open.ask(Message::Call(Call::AutoInit, 1.0)) < 0 {
            return -1;
        }
        let end = clock::now_ns() + (open.traits.load().auto_init * 1e6) as u64;
        clock::sleep_until(end);
        while slot.state.load().calibration != 0 || slot.state.load().mode == 0 {
            if !open.is_connected() {
                return open.fail(errors::COMMUNICATION);
            }
            if clock::now_ns() > end + 2000 * MS {
                return open.fail(errors::TIMEOUT);
            }
            clock::sleep_until(clock::now_ns() + MS);
        }
        0
    }))
}

/// Ends the regulation; `force` keeps the force on.
#[unsafe(no_mangle)]
pub extern "system" fn drdStop(force: bool, id: c_char) -> i32 {
    code(connected(id).map(|(open, _)| {
        let value = if force { 1.0 } else { 0.0 };
        open.ask(Message::Call(Call::RegulationStop, value))
    }))
}

/// Closes the device.
#[unsafe(no_mangle)]
pub extern "system" fn drdClose(id: c_char) -> i32 {
    code(opened(id).map(open::close))
}
