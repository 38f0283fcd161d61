//! Calls of the expert mode.

use crate::errors;
use crate::state::{code, connect, connected};
use std::ffi::c_char;
use std::sync::atomic::{AtomicBool, Ordering};
use sulcus_standins::board::{Call, Message, NO_DEVICE};

static EXPERT: AtomicBool = AtomicBool::new(false);

/// Turns the expert mode on.
#[unsafe(no_mangle)]
pub extern "system" fn dhdEnableExpertMode() -> i32 {
    EXPERT.store(true, Ordering::Release);
    if let Some(link) = connect() {
        link.send(NO_DEVICE, Message::Call(Call::ExpertMode, 1.0));
    }
    0
}

/// Turns the expert mode off after a reset.
pub fn reset() {
    EXPERT.store(false, Ordering::Release);
}

fn ask(id: c_char, call: Call, value: f64) -> i32 {
    code(connected(id).map(|(open, _)| {
        if EXPERT.load(Ordering::Acquire) {
            open.ask(Message::Call(call, value))
        } else {
            open.fail(errors::EXPERT_MODE_OFF)
        }
    }))
}

/// Sets the time of the hardware watchdog in steps of 125 us; 0 turns it off.
#[unsafe(no_mangle)]
pub extern "system" fn dhdSetWatchdog(steps: u8, id: c_char) -> i32 {
    ask(id, Call::Watchdog, steps.into())
}

/// Logs a velocity threshold; its unit depends on the model, so the stand-in does not act on it.
#[unsafe(no_mangle)]
pub extern "system" fn dhdSetVelocityThreshold(value: u32, id: c_char) -> i32 {
    ask(id, Call::VelocityThreshold, value.into())
}
