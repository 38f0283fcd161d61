//! Poses, velocities and buttons.

use crate::errors;
use crate::state::{Open, code, connected};
use std::ffi::c_char;
use std::sync::atomic::{AtomicU32, Ordering};
use sulcus_standins::board::State;
use sulcus_standins::clock;

/// System type of the omega.6 for the right and for the left hand.
const OMEGA_6: [f64; 2] = [34.0, 36.0];

/// Reads the device. Within the time guard of the last reading the result is that reading with code 1.
fn read(id: c_char) -> Result<(&'static Open, State, i32), i32> {
    let (open, slot) = connected(id)?;
    let now = clock::now_ns();
    if now.saturating_sub(open.read_at.load(Ordering::Relaxed)) < open.guard.load(Ordering::Relaxed)
    {
        return Ok((open, open.reading.load(), 1));
    }
    let state = slot.state.load();
    open.reading.store(state);
    open.read_at.store(now, Ordering::Relaxed);
    Ok((open, state, 0))
}

/// Writes three numbers and returns `result`, or the error about a null pointer.
///
/// # Safety
/// Every pointer is null or valid.
unsafe fn write(open: &Open, to: [*mut f64; 3], from: [f64; 3], result: i32) -> i32 {
    if to.iter().any(|p| p.is_null()) {
        return open.fail(errors::NULL_ARGUMENT);
    }
    for (to, from) in to.into_iter().zip(from) {
        // SAFETY: the caller's promise; `to` is not null.
        unsafe { to.write(from) };
    }
    result
}

/// Position in m.
///
/// # Safety
/// Every pointer is null or valid.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn dhdGetPosition(
    x: *mut f64,
    y: *mut f64,
    z: *mut f64,
    id: c_char,
) -> i32 {
    // SAFETY: the caller's promise.
    code(
        read(id)
            .map(|(open, state, result)| unsafe { write(open, [x, y, z], state.position, result) }),
    )
}

/// Position in m and rotation matrix, rows first.
///
/// # Safety
/// Every pointer is null or valid.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn dhdGetPositionAndOrientationFrame(
    x: *mut f64,
    y: *mut f64,
    z: *mut f64,
    r: *mut [[f64; 3]; 3],
    id: c_char,
) -> i32 {
    code(read(id).map(|(open, state, result)| {
        if r.is_null() {
            return open.fail(errors::NULL_ARGUMENT);
        }
        // SAFETY: the caller's promise; `r` is not null.
        unsafe {
            r.write(state.rotation);
            write(open, [x, y, z], state.position, result)
        }
    }))
}

/// Angles of the wrist's joints in rad. The frame of an omega.6 is turned by pi/4 about y against its joints.
///
/// # Safety
/// Every pointer is null or valid.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn dhdGetOrientationRad(
    a: *mut f64,
    b: *mut f64,
    c: *mut f64,
    id: c_char,
) -> i32 {
    code(read(id).map(|(open, state, result)| {
        let [yaw, pitch, roll] = state.gimbal;
        let kind = open.traits.load().system_type;
        let turned = if OMEGA_6.contains(&kind) {
            std::f64::consts::FRAC_PI_4
        } else {
            0.0
        };
        // SAFETY: the caller's promise.
        unsafe { write(open, [a, b, c], [roll, pitch - turned, yaw], result) }
    }))
}

/// A velocity; the first call after the opening has too few positions and is error 7.
fn velocity(id: c_char, calls: fn(&Open) -> &AtomicU32) -> Result<(&'static Open, State), i32> {
    let (open, slot) = connected(id)?;
    let state = slot.state.load();
    if calls(open).fetch_add(1, Ordering::Relaxed) == 0 || state.window < 2 {
        return Err(open.fail(errors::TIMEOUT));
    }
    Ok((open, state))
}

/// Velocity in m/s.
///
/// # Safety
/// Every pointer is null or valid.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn dhdGetLinearVelocity(
    x: *mut f64,
    y: *mut f64,
    z: *mut f64,
    id: c_char,
) -> i32 {
    let read = velocity(id, |open| &open.linear);
    // SAFETY: the caller's promise.
    code(read.map(|(open, state)| unsafe { write(open, [x, y, z], state.velocity, 0) }))
}

/// Angular velocity in rad/s.
///
/// # Safety
/// Every pointer is null or valid.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn dhdGetAngularVelocityRad(
    x: *mut f64,
    y: *mut f64,
    z: *mut f64,
    id: c_char,
) -> i32 {
    let read = velocity(id, |open| &open.angular);
    // SAFETY: the caller's promise.
    code(read.map(|(open, state)| unsafe { write(open, [x, y, z], state.angular, 0) }))
}

/// Accepts a window of 1 to 1000 ms in mode 0; the stand-in keeps its window of 20 ms.
#[unsafe(no_mangle)]
pub extern "system" fn dhdConfigLinearVelocity(ms: i32, mode: i32, id: c_char) -> i32 {
    code(connected(id).map(|(open, _)| {
        if (1..=1000).contains(&ms) && mode == 0 {
            0
        } else {
            open.fail(errors::INVALID)
        }
    }))
}

/// 1 while the button is down.
#[unsafe(no_mangle)]
pub extern "system" fn dhdGetButton(index: i32, id: c_char) -> i32 {
    code(connected(id).map(|(open, slot)| {
        if (0..32).contains(&index) {
            (slot.state.load().buttons >> index & 1) as i32
        } else {
            open.fail(errors::INVALID_INDEX)
        }
    }))
}

/// Bits of the buttons that are down; 0 after an error.
#[unsafe(no_mangle)]
pub extern "system" fn dhdGetButtonMask(id: c_char) -> u32 {
    connected(id).map_or(0, |(_, slot)| slot.state.load().buttons as u32)
}

/// Rate of the force commands in kHz; 0 after an error.
#[unsafe(no_mangle)]
pub extern "system" fn dhdGetComFreq(id: c_char) -> f64 {
    connected(id).map_or(0.0, |(_, slot)| slot.state.load().rate)
}
