//! Calls that change the controller's mode or its settings.

use crate::errors;
use crate::state::{Open, code, connected};
use std::ffi::c_char;
use std::sync::atomic::Ordering;
use sulcus_standins::board::{Call, Message, Slot};

/// Sends a call and waits for the controller.
fn ask(id: c_char, call: Call, value: f64) -> i32 {
    code(connected(id).map(|(open, _)| open.ask(Message::Call(call, value))))
}

/// Sends a call that a device in mode reset refuses.
fn ask_ready(id: c_char, call: Call, value: f64) -> i32 {
    code(connected(id).map(|(open, slot)| {
        if in_reset(slot) {
            open.fail(errors::NOT_READY)
        } else {
            open.ask(Message::Call(call, value))
        }
    }))
}

fn in_reset(slot: &Slot) -> bool {
    slot.state.load().mode == 0
}

/// Turns the force on or off. Without a lit FORCE button the call succeeds and the force stays off.
#[unsafe(no_mangle)]
pub extern "system" fn dhdEnableForce(on: u8, id: c_char) -> i32 {
    ask_ready(id, Call::EnableForce, on.into())
}

/// Takes the force off and brakes.
#[unsafe(no_mangle)]
pub extern "system" fn dhdStop(id: c_char) -> i32 {
    ask(id, Call::Stop, 0.0)
}

/// Turns the brakes on or off.
#[unsafe(no_mangle)]
pub extern "system" fn dhdSetBrakes(on: i32, id: c_char) -> i32 {
    ask_ready(id, Call::Brakes, on.into())
}

/// Turns gravity compensation on or off.
#[unsafe(no_mangle)]
pub extern "system" fn dhdSetGravityCompensation(on: i32, id: c_char) -> i32 {
    ask(id, Call::Gravity, on.into())
}

/// Sets the mass of the handle in kg.
#[unsafe(no_mangle)]
pub extern "system" fn dhdSetEffectorMass(kg: f64, id: c_char) -> i32 {
    code(connected(id).map(|(open, _)| {
        if kg.is_finite() && kg >= 0.0 {
            open.ask(Message::Call(Call::EffectorMass, kg))
        } else {
            open.fail(errors::INVALID)
        }
    }))
}

/// Makes a button of the gripper; a device without a gripper has none.
#[unsafe(no_mangle)]
pub extern "system" fn dhdEmulateButton(on: u8, id: c_char) -> i32 {
    code(connected(id).map(|(open, _)| {
        if has_gripper(open) {
            open.ask(Message::Call(Call::EmulateButton, on.into()))
        } else {
            open.fail(errors::NOT_AVAILABLE)
        }
    }))
}

fn has_gripper(open: &Open) -> bool {
    open.traits.load().gripper != 0.0
}

/// Sets the time guard in us: 0 off, -1 the usual one.
#[unsafe(no_mangle)]
pub extern "system" fn dhdSetTimeGuard(us: i32, id: c_char) -> i32 {
    code(connected(id).map(|(open, _)| {
        let us = match us {
            -1 => open.traits.load().time_guard,
            0.. => f64::from(us),
            _ => return open.fail(errors::INVALID),
        };
        open.guard.store((us * 1e3) as u64, Ordering::Relaxed);
        open.ask(Message::Call(Call::TimeGuard, us))
    }))
}
