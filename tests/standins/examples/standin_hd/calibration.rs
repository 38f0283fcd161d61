//! Calibration of the current device.

use crate::errors::{COMM_ERROR, INVALID_HANDLE, INVALID_OPERATION, INVALID_VALUE, raise};
use crate::state::{current, link};
use std::sync::atomic::Ordering;
use sulcus_standins::board::{Call, Message};

/// State of the calibration: 0x5000 right, 0x5001 needs an update, 0x5002 needs manual input.
#[unsafe(no_mangle)]
pub extern "system" fn hdCheckCalibration() -> u32 {
    let Some((hhd, open)) = current() else {
        raise(INVALID_OPERATION, INVALID_HANDLE);
        return 0;
    };
    match open.slot() {
        Some(slot) if open.is_connected() => 0x5000 + slot.state.load().calibration as u32,
        _ => {
            raise(COMM_ERROR, hhd);
            0x5002
        }
    }
}

/// Calibration styles of the device.
#[unsafe(no_mangle)]
pub extern "system" fn hdCheckCalibrationStyle() -> u32 {
    match current() {
        Some((_, open)) => open.traits.load().calibration_style as u32,
        None => {
            raise(INVALID_OPERATION, INVALID_HANDLE);
            0
        }
    }
}

/// Updates the calibration once. The result shows a tick later.
#[unsafe(no_mangle)]
pub extern "system" fn hdUpdateCalibration(style: u32) {
    let Some((hhd, open)) = current() else {
        return raise(INVALID_OPERATION, INVALID_HANDLE);
    };
    let styles = open.traits.load().calibration_style as u32;
    if !style.is_power_of_two() || style & styles == 0 {
        return raise(INVALID_VALUE, hhd);
    }
    if let Some(link) = link() {
        let call = Message::Call(Call::UpdateCalibration, f64::from(style));
        link.send(open.number.load(Ordering::Relaxed), call);
    }
}

/// Text for the user about the calibration; the stand-in has none. The vendor's arguments are not known.
#[unsafe(no_mangle)]
pub extern "system" fn hdUpdateCalibrationMessage() {}

/// Scales gimbal angles in the vendor's library; the stand-in does nothing. The vendor's arguments are not known.
#[unsafe(no_mangle)]
pub extern "system" fn hdScaleGimbalAngles() {}
