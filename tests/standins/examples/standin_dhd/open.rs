//! Opening and closing of devices.

use crate::errors::{self, fail, fail_alone};
use crate::state::{DEFAULT, OPEN, Open, code, connect, link, opened, signed};
use std::ffi::c_char;
use std::sync::atomic::Ordering;
use sulcus_standins::board::{Link, Message, NO_DEVICE, Slot};

/// Devices that are plugged in, in the order of the board.
fn devices(link: &Link) -> impl Iterator<Item = (u64, &'static Slot)> {
    link.board
        .slots
        .iter()
        .zip(0..)
        .filter_map(|(slot, number)| {
            let here = slot.family.load(Ordering::Acquire) == 2
                && slot.plugged.load(Ordering::Acquire) != 0;
            here.then_some((number, slot))
        })
}

/// Number of devices that are plugged in.
#[unsafe(no_mangle)]
pub extern "system" fn dhdGetDeviceCount() -> i32 {
    connect().map_or(0, |link| devices(link).count() as i32)
}

/// Number of devices that no process has open.
#[unsafe(no_mangle)]
pub extern "system" fn dhdGetAvailableCount() -> i32 {
    let free = |slot: &Slot| slot.owner.load(Ordering::Acquire) == 0;
    connect().map_or(0, |link| {
        devices(link).filter(|(_, slot)| free(slot)).count() as i32
    })
}

/// Opens the first device that `wanted` accepts; it gets its place among the devices. `missing` is the error for none.
pub fn open(missing: i32, wanted: impl Fn(usize, &Slot) -> bool) -> i32 {
    let Some(link) = connect() else {
        return fail_alone(errors::NO_DRIVER);
    };
    let found = devices(link)
        .enumerate()
        .find(|(i, (_, slot))| wanted(*i, slot));
    let Some((_, (number, slot))) = found else {
        link.send(NO_DEVICE, Message::Refused(missing as u32));
        return fail_alone(missing);
    };
    let refused = |code: i32| {
        link.send(number, Message::Refused(code as u32));
        fail(code, number)
    };
    let injected = slot.open_error.load(Ordering::Acquire);
    if injected != 0 {
        return refused(injected as i32);
    }
    if link.take(slot).is_err() {
        return refused(errors::IN_USE);
    }
    let Some(id) = OPEN.iter().position(|o| !o.is_open.load(Ordering::Acquire)) else {
        link.release(slot);
        return refused(errors::NOT_AVAILABLE);
    };
    link.ask(number, Message::Open);
    fill(&OPEN[id], number, slot);
    DEFAULT.store(id as i32, Ordering::Release);
    id as i32
}

fn fill(open: &Open, number: u64, slot: &Slot) {
    let traits = slot.traits.load();
    open.number.store(number, Ordering::Relaxed);
    open.plugs
        .store(slot.plugs.load(Ordering::Acquire), Ordering::Relaxed);
    open.commands.store(0, Ordering::Relaxed);
    open.read_at.store(0, Ordering::Relaxed);
    open.linear.store(0, Ordering::Relaxed);
    open.angular.store(0, Ordering::Relaxed);
    open.guard
        .store((traits.time_guard * 1e3) as u64, Ordering::Relaxed);
    open.limit.store(f64::INFINITY.to_bits(), Ordering::Relaxed);
    open.traits.store(traits);
    open.reading.store(slot.state.load());
    for (to, from) in open.name.iter().zip(slot.model.bytes()) {
        to.store(from, Ordering::Relaxed);
    }
    open.is_open.store(true, Ordering::Release);
}

/// Opens the first free device; its id, or -1.
#[unsafe(no_mangle)]
pub extern "system" fn dhdOpen() -> i32 {
    let missing = if dhdGetDeviceCount() > 0 {
        errors::IN_USE
    } else {
        errors::NO_DEVICE_FOUND
    };
    open(missing, |_, slot| slot.owner.load(Ordering::Acquire) == 0)
}

/// Opens the device at this place; its id, or -1.
#[unsafe(no_mangle)]
pub extern "system" fn dhdOpenID(index: c_char) -> i32 {
    let index = signed(index);
    open(errors::INVALID_INDEX, |i, _| i as i32 == index)
}

/// Opens the device with this serial number; its id, or -1.
#[unsafe(no_mangle)]
pub extern "system" fn dhdOpenSerial(serial: i32) -> i32 {
    open(errors::NO_DEVICE_FOUND, |_, slot| {
        number_of(slot) == Some(serial)
    })
}

/// Opens the first free device of this type; its id, or -1.
#[unsafe(no_mangle)]
pub extern "system" fn dhdOpenType(kind: i32) -> i32 {
    open(errors::NO_DEVICE_FOUND, |_, slot| {
        slot.traits.load().system_type as i32 == kind && slot.owner.load(Ordering::Acquire) == 0
    })
}

/// Serial number of a device as a number.
pub fn number_of(slot: &Slot) -> Option<i32> {
    let bytes = slot.serial.bytes();
    let length = bytes.iter().position(|b| *b == 0).unwrap_or(64);
    std::str::from_utf8(&bytes[..length]).ok()?.parse().ok()
}

/// Closes the device. Another open device becomes the default device.
#[unsafe(no_mangle)]
pub extern "system" fn dhdClose(id: c_char) -> i32 {
    code(opened(id).map(close))
}

/// Closes an open device.
pub fn close(open: &'static Open) -> i32 {
    let result = if open.is_connected() {
        open.ask(Message::Close(false))
    } else {
        0
    };
    open.is_open.store(false, Ordering::Release);
    if let (Some(link), Some(slot)) = (link(), open.slot()) {
        link.release(slot);
    }
    let default = DEFAULT.load(Ordering::Acquire);
    if usize::try_from(default).is_ok_and(|i| std::ptr::eq(&OPEN[i], open)) {
        let other = OPEN.iter().position(|o| o.is_open.load(Ordering::Acquire));
        DEFAULT.store(other.map_or(-1, |i| i as i32), Ordering::Release);
    }
    result
}
