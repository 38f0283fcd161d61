//! Force commands.

use crate::errors;
use crate::state::{code, connected};
use std::ffi::c_char;
use std::sync::atomic::Ordering;
use sulcus_standins::board::{Command, Message};
use sulcus_standins::pose::{V3, clamp, norm};

/// Mode numbers of the board: reset and force.
const RESET: u64 = 0;
const FORCE: u64 = 2;

/// Sends a command. 2 tells that the command was larger than the motors are able to follow.
fn command(force: V3, torque: V3, sets: u64, id: c_char) -> i32 {
    code(connected(id).map(|(open, slot)| {
        let traits = open.traits.load();
        let mode = slot.state.load().mode;
        let finite = force.iter().chain(&torque).all(|n| n.is_finite());
        let limit = traits
            .max_force
            .min(f64::from_bits(open.limit.load(Ordering::Relaxed)));
        let (sent_force, sent_torque) = if finite {
            let active = traits.active_wrist != 0.0;
            (
                clamp(force, limit),
                if active {
                    clamp(torque, traits.max_torque)
                } else {
                    [0.0; 3]
                },
            )
        } else {
            ([0.0; 3], [0.0; 3])
        };
        open.send(Message::Command(Command {
            frame: open.commands.fetch_add(1, Ordering::Relaxed) + 1,
            tick: 0,
            pose_stamp: open.reading.load().stamp,
            sets,
            enabled: true,
            asked_force: force,
            asked_torque: torque,
            force: sent_force,
            torque: sent_torque,
        }));
        if !finite {
            return open.fail(errors::INVALID);
        }
        if mode == RESET {
            return open.fail(errors::NOT_READY);
        }
        if mode != FORCE {
            return if traits.strict != 0.0 {
                open.fail(errors::NOT_ENABLED)
            } else {
                0
            };
        }
        let injected = slot.error.swap(0, Ordering::AcqRel);
        if injected != 0 {
            return open.fail(injected as i32);
        }
        let saturated =
            norm(force) > limit || norm(sent_torque) < norm(torque) && traits.active_wrist != 0.0;
        if saturated { 2 } else { 0 }
    }))
}

/// Sets the force in N.
#[unsafe(no_mangle)]
pub extern "system" fn dhdSetForce(fx: f64, fy: f64, fz: f64, id: c_char) -> i32 {
    command([fx, fy, fz], [0.0; 3], 1, id)
}

/// Sets force in N and torque in N m.
#[unsafe(no_mangle)]
pub extern "system" fn dhdSetForceAndTorque(
    fx: f64,
    fy: f64,
    fz: f64,
    tx: f64,
    ty: f64,
    tz: f64,
    id: c_char,
) -> i32 {
    command([fx, fy, fz], [tx, ty, tz], 2, id)
}

/// Sets force in N, torque in N m and the force of the gripper in N. The stand-in has no motor in its gripper.
#[unsafe(no_mangle)]
pub extern "system" fn dhdSetForceAndTorqueAndGripperForce(
    fx: f64,
    fy: f64,
    fz: f64,
    tx: f64,
    ty: f64,
    tz: f64,
    grip: f64,
    id: c_char,
) -> i32 {
    if !grip.is_finite() {
        return code(connected(id).map(|(open, _)| open.fail(errors::INVALID)));
    }
    command([fx, fy, fz], [tx, ty, tz], 3, id)
}

/// Sets a largest force of the client's own in N; a negative number takes it back.
#[unsafe(no_mangle)]
pub extern "system" fn dhdSetMaxForce(newton: f64, id: c_char) -> i32 {
    code(connected(id).map(|(open, _)| {
        let limit = if newton < 0.0 { f64::INFINITY } else { newton };
        open.limit.store(limit.to_bits(), Ordering::Relaxed);
        open.ask(Message::Call(
            sulcus_standins::board::Call::MaxForce,
            newton,
        ))
    }))
}
