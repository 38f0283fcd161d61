//! Frames: a state of one moment at the begin, a force command at the end.

use crate::capabilities::{
    FORCE_OUTPUT, FORCE_RAMPING, MAX_FORCE_CLAMPING, ONE_FRAME_LIMIT, SOFTWARE_FORCE_LIMIT,
};
use crate::errors::{self, raise};
use crate::scheduler;
use crate::state::{CURRENT, Open, link, opened};
use std::sync::atomic::Ordering;
use sulcus_standins::board::{Command, Message};
use sulcus_standins::clock;
use sulcus_standins::pose::{V3, clamp, norm, scale};

/// Begins a frame of the device and makes the device current.
#[unsafe(no_mangle)]
pub extern "system" fn hdBeginFrame(hhd: u32) {
    let Some(open) = opened(hhd) else {
        return raise(errors::BAD_HANDLE, hhd);
    };
    CURRENT.store(hhd, Ordering::Release);
    if open.depth.load(Ordering::Relaxed) == 0 {
        let tick = scheduler::tick();
        if tick != 0 && open.has(ONE_FRAME_LIMIT) && open.tick.load(Ordering::Relaxed) == tick {
            return raise(errors::FRAME_ERROR, hhd);
        }
        latch(hhd, open);
    }
    open.depth.fetch_add(1, Ordering::AcqRel);
}

/// Reads the state of the frame, and forgets the force of the last frame.
fn latch(hhd: u32, open: &Open) {
    for word in &open.set {
        word.store(0, Ordering::Relaxed);
    }
    open.sets.store(0, Ordering::Relaxed);
    if !open.is_connected() {
        return raise(errors::COMM_ERROR, hhd);
    }
    let Some(slot) = open.slot() else {
        return;
    };
    open.before.store(open.now.load());
    let state = slot.state.load();
    open.now.store(state);
    if state.warm != 0 {
        raise(errors::WARM_MOTORS, hhd);
    }
}

/// Ends a frame of the device. The end of the outermost frame sends the force.
#[unsafe(no_mangle)]
pub extern "system" fn hdEndFrame(hhd: u32) {
    let Some(open) = opened(hhd) else {
        return raise(errors::BAD_HANDLE, hhd);
    };
    let depth = open.depth.load(Ordering::Relaxed);
    if depth == 0 {
        return raise(errors::ILLEGAL_END, hhd);
    }
    open.depth.store(depth - 1, Ordering::Release);
    if depth == 1 {
        send(hhd, open);
    }
}

fn send(hhd: u32, open: &Open) {
    let (Some(link), Some(slot)) = (link(), open.slot()) else {
        return;
    };
    let injected = slot.error.swap(0, Ordering::AcqRel);
    if injected != 0 {
        raise(injected, hhd);
    }
    let asked_force = open.set_from(0);
    let asked_torque = scale(open.set_from(3), 1e-3);
    let connected = open.is_connected();
    let (force, torque) = if connected {
        limit(hhd, open, asked_force, asked_torque)
    } else {
        ([0.0; 3], [0.0; 3])
    };
    let frame = open.frames.fetch_add(1, Ordering::Relaxed) + 1;
    let tick = scheduler::tick();
    open.tick.store(tick, Ordering::Relaxed);
    for (word, value) in open.last_force.iter().zip(force) {
        word.store(value.to_bits(), Ordering::Relaxed);
    }
    let command = Command {
        frame,
        tick,
        pose_stamp: open.now.load().stamp,
        sets: open.sets.load(Ordering::Relaxed),
        enabled: connected && open.has(FORCE_OUTPUT),
        asked_force,
        asked_torque,
        force,
        torque,
    };
    link.send(
        open.number.load(Ordering::Relaxed),
        Message::Command(command),
    );
}

/// The driver's own limits: finite numbers, largest force and torque, ramp after the force output was enabled.
fn limit(hhd: u32, open: &Open, force: V3, torque: V3) -> (V3, V3) {
    let zero = ([0.0; 3], [0.0; 3]);
    let traits = open.traits.load();
    if !force.iter().chain(&torque).all(|n| n.is_finite()) {
        raise(errors::FORCE_ERROR, hhd);
        return zero;
    }
    let mut force = force;
    if norm(force) > traits.max_force {
        if open.has(MAX_FORCE_CLAMPING) {
            force = clamp(force, traits.max_force);
        } else if open.has(SOFTWARE_FORCE_LIMIT) {
            raise(errors::EXCEEDED_MAX_FORCE, hhd);
            return zero;
        }
    }
    if open.has(FORCE_RAMPING) {
        let on =
            clock::now_ns().saturating_sub(open.enabled_at.load(Ordering::Acquire)) as f64 * 1e-9;
        force = clamp(
            force,
            on * f64::from_bits(open.ramp.load(Ordering::Relaxed)),
        );
    }
    let torque = if traits.output_dof >= 6.0 {
        torque
    } else {
        [0.0; 3]
    };
    (force, clamp(torque, traits.max_torque))
}
