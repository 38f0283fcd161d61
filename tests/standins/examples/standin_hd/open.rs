//! Opening and closing of devices, and the current device.

use crate::capabilities::DEFAULTS;
use crate::errors::{self, INVALID_HANDLE, raise};
use crate::scheduler;
use crate::state::{CURRENT, OPEN, Open, connect, current, link, opened};
use std::ffi::{CStr, c_char};
use std::sync::Once;
use std::sync::atomic::Ordering;
use sulcus_standins::board::{Link, Message, NO_DEVICE, Slot};

/// Opens the device of this name, or the first device without a name. Returns its handle.
///
/// # Safety
/// `name` is null or a text with a zero at its end.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn hdInitDevice(name: *const c_char) -> u32 {
    // SAFETY: the caller's promise.
    let name = (!name.is_null()).then(|| unsafe { CStr::from_ptr(name) }.to_bytes());
    match init(name) {
        Ok(hhd) => hhd,
        Err((device, code)) => {
            if let Some(link) = link() {
                link.send(device, Message::Refused(code));
            }
            raise(code, INVALID_HANDLE);
            INVALID_HANDLE
        }
    }
}

fn init(name: Option<&[u8]>) -> Result<u32, (u64, u32)> {
    let link = connect().ok_or((NO_DEVICE, errors::DEVICE_FAULT))?;
    let (number, slot) = find(link, name).ok_or((NO_DEVICE, errors::DEVICE_FAULT))?;
    let refused = |code| Err((number, code));
    if OPEN
        .iter()
        .any(|o| o.is_open.load(Ordering::Acquire) && o.number.load(Ordering::Relaxed) == number)
    {
        return refused(errors::DEVICE_ALREADY_INITIATED);
    }
    let code = slot.open_error.load(Ordering::Acquire);
    if code != 0 {
        return refused(code);
    }
    if slot.plugged.load(Ordering::Acquire) == 0 {
        return refused(errors::COMM_ERROR);
    }
    if slot.locked.load(Ordering::Acquire) != 0 {
        return refused(errors::COMM_CONFIG_ERROR);
    }
    if link.take(slot).is_err() {
        return refused(errors::DEVICE_FAULT);
    }
    let Some(hhd) = OPEN.iter().position(|o| !o.is_open.load(Ordering::Acquire)) else {
        link.release(slot);
        return refused(errors::DEVICE_FAULT);
    };
    link.ask(number, Message::Open);
    fill(&OPEN[hhd], link, number, slot);
    CURRENT.store(hhd as u32, Ordering::Release);
    Ok(hhd as u32)
}

fn find(link: &Link, name: Option<&[u8]>) -> Option<(u64, &'static Slot)> {
    let wanted = |slot: &Slot| {
        slot.family.load(Ordering::Acquire) == 1 && name.is_none_or(|name| slot.name.is(name))
    };
    let number = link.board.slots.iter().position(wanted)? as u64;
    Some((number, link.slot(number)?))
}

fn fill(open: &Open, link: &Link, number: u64, slot: &Slot) {
    let traits = slot.traits.load();
    open.number.store(number, Ordering::Relaxed);
    open.plugs
        .store(slot.plugs.load(Ordering::Acquire), Ordering::Relaxed);
    open.depth.store(0, Ordering::Relaxed);
    open.frames.store(0, Ordering::Relaxed);
    open.tick.store(0, Ordering::Relaxed);
    open.capabilities.store(DEFAULTS, Ordering::Relaxed);
    open.ramp.store(traits.ramp.to_bits(), Ordering::Relaxed);
    open.traits.store(traits);
    let state = slot.state.load();
    open.now.store(state);
    open.before.store(state);
    let texts = [
        slot.model.bytes(),
        slot.serial.bytes(),
        slot.firmware.bytes(),
        slot.driver_version.bytes(),
        slot.vendor.bytes(),
        link.board.driver.hd_version.bytes(),
    ];
    for (to, from) in open.texts.iter().flatten().zip(texts.iter().flatten()) {
        to.store(*from, Ordering::Relaxed);
    }
    open.is_open.store(true, Ordering::Release);
}

/// Closes the device.
#[unsafe(no_mangle)]
pub extern "system" fn hdDisableDevice(hhd: u32) {
    let Some(open) = opened(hhd) else {
        return raise(errors::BAD_HANDLE, hhd);
    };
    close(hhd, open, false);
    let crash =
        link().is_some_and(|link| link.board.driver.crash_on_disable.load(Ordering::Relaxed) != 0);
    if crash {
        // A handler of the client sees the fault first, then the process ends.
        // SAFETY: raising a signal has no precondition.
        unsafe {
            libc::raise(libc::SIGSEGV);
            libc::signal(libc::SIGSEGV, libc::SIG_DFL);
            libc::raise(libc::SIGSEGV);
        }
    }
}

/// Closes an open device; `exit` at the end of the process, when nothing waits for the controller.
pub fn close(hhd: u32, open: &Open, exit: bool) {
    open.is_open.store(false, Ordering::Release);
    let _ = CURRENT.compare_exchange(hhd, INVALID_HANDLE, Ordering::AcqRel, Ordering::Acquire);
    let number = open.number.load(Ordering::Relaxed);
    if let (Some(link), Some(slot)) = (link(), open.slot()) {
        if exit {
            link.send(number, Message::Close(true));
        } else {
            link.ask(number, Message::Close(false));
        }
        link.release(slot);
    }
}

extern "C" fn at_exit() {
    scheduler::ask_to_stop();
    for (hhd, open) in OPEN.iter().enumerate() {
        if open.is_open.load(Ordering::Acquire) {
            close(hhd as u32, open, true);
        }
    }
}

/// Closes open devices at the orderly exit of the process, as a driver does.
pub fn close_at_exit() {
    static ONCE: Once = Once::new();
    // SAFETY: `at_exit` is a function of this library, which a client never unloads.
    ONCE.call_once(|| unsafe {
        libc::atexit(at_exit);
    });
}

/// Makes the device current.
#[unsafe(no_mangle)]
pub extern "system" fn hdMakeCurrentDevice(hhd: u32) {
    match opened(hhd) {
        Some(_) => CURRENT.store(hhd, Ordering::Release),
        None => raise(errors::BAD_HANDLE, hhd),
    }
}

/// Handle of the current device.
#[unsafe(no_mangle)]
pub extern "system" fn hdGetCurrentDevice() -> u32 {
    match current() {
        Some((hhd, _)) => hhd,
        None => {
            raise(errors::INVALID_OPERATION, INVALID_HANDLE);
            INVALID_HANDLE
        }
    }
}

/// Accepts every licence.
#[unsafe(no_mangle)]
pub extern "system" fn hdDeploymentLicense(
    _vendor: *const c_char,
    _application: *const c_char,
    _password: *const c_char,
) -> u8 {
    1
}
