//! Errors, modes and force-off causes of the library, with a sentence for each.

use super::api::Code;
use super::sys;
use crate::State;

/// Meaning of an error in a period.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// The device is not connected any more.
    Lost,
    /// The device is connected and gives no pose or takes no force now.
    Passing,
}

impl Code {
    /// Class of the error in a period.
    pub fn class(self) -> Class {
        match self.0 {
            2 | 4 | 5 | 6 | 15 => Class::Lost,
            _ => Class::Passing,
        }
    }

    /// State of a device that does not open with this error.
    pub fn state(self) -> State {
        match self.0 {
            5 | 6 | 15 => State::NoDevice,
            20 => State::InUse,
            12 => State::Asleep,
            _ => State::Error,
        }
    }
}

/// Sentence about a device that does not open: cause and remedy. `text` is the library's own text.
pub fn refusal(title: &str, code: Code, text: &str) -> String {
    let remedy = match code.0 {
        2 | 3 | 7 => "check cable and power, unplug it and plug it in again",
        4 => {
            "install the USB driver; on Linux allow the access by a udev rule for the vendor 1451, or 0403:cb48 for a Falcon"
        }
        5 | 6 | 15 => "connect it and switch it on",
        12 => "switch it on and wait until it has started",
        20 => "another program uses it: end that program first",
        _ => "run the test program of the SDK",
    };
    format!(
        "Force Dimension SDK does not open {title}: {text} (error {}): {remedy}",
        code.0
    )
}

/// Mode of the controller, by its status.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Mode {
    /// The motors follow commands.
    Force = 0,
    /// The person turned the force off at the base.
    Button = 1,
    /// The handle was too fast.
    Velocity = 2,
    /// No command came in time.
    Watchdog = 3,
    /// The force is off for another reason.
    Off = 4,
    /// The dead man's switch is open.
    DeadMan = 6,
    /// The device must be calibrated.
    Reset = 7,
    /// The device has no power.
    NoPower = 8,
    /// The device is not connected.
    Lost = 9,
}

/// Returns the mode of a status.
pub fn mode(status: &[i32; sys::STATUS]) -> Mode {
    let is = |place: usize| status[place] != 0;
    let cause = status[sys::STATUS_FORCE_OFF_CAUSE];
    // A device that was plugged in again shows the cause of its loss until it has force.
    if !is(sys::STATUS_CONNECTED) {
        return Mode::Lost;
    }
    if !is(sys::STATUS_POWER) {
        return Mode::NoPower;
    }
    if is(sys::STATUS_RESET) {
        return Mode::Reset;
    }
    if is(sys::STATUS_FORCE) && !is(sys::STATUS_BRAKE) {
        return Mode::Force;
    }
    match cause {
        1 => Mode::Button,
        2 => Mode::Velocity,
        3 => Mode::Watchdog,
        6 => Mode::DeadMan,
        _ => Mode::Off,
    }
}

impl Mode {
    /// Mode of its number.
    pub fn of(number: u32) -> Self {
        [
            Self::Button,
            Self::Velocity,
            Self::Watchdog,
            Self::Off,
            Self::DeadMan,
            Self::Reset,
            Self::NoPower,
            Self::Lost,
        ]
        .into_iter()
        .find(|mode| *mode as u32 == number)
        .unwrap_or(Self::Force)
    }

    /// Sentence about the mode; `None` for a device with force.
    pub fn remark(self, title: &str) -> Option<String> {
        let text = match self {
            Self::Force | Self::Lost => return None,
            Self::Button => {
                "the force is off: press the FORCE button of the base, then a button of the handle"
            }
            Self::Velocity => {
                "the force is off after a fast motion: press the FORCE button of the base, then a button of the handle"
            }
            Self::Watchdog => {
                "the force is off because commands came late: press a button of the handle; end other programs if it \
                 happens again"
            }
            Self::Off => {
                "the force is off: press the FORCE button of the base, then a button of the handle"
            }
            Self::DeadMan => {
                "the force is off: hold the dead man's switch, then press a button of the handle"
            }
            Self::Reset => {
                "the device is not calibrated: put the handle into the calibration pole, or set SULCUS_DHD_AUTO_INIT=1 \
                 and let go of the handle at the start, because the device then moves by itself"
            }
            Self::NoPower => "the device has no power: connect its power supply and switch it on",
        };
        Some(format!("{title}: {text}"))
    }
}

/// Whether a library of this version is supported: 3.0 or newer.
pub fn is_supported(version: [i32; 4]) -> bool {
    version[0] >= 3
}

#[cfg(test)]
mod tests {
    use super::*;

    fn status(set: &[(usize, i32)]) -> [i32; sys::STATUS] {
        let mut status = [0; sys::STATUS];
        (status[sys::STATUS_POWER], status[sys::STATUS_CONNECTED]) = (1, 1);
        for (place, value) in set {
            status[*place] = *value;
        }
        status
    }

    #[test]
    fn modes_follow_the_status() {
        assert_eq!(mode(&status(&[(5, 1)])), Mode::Force);
        assert_eq!(mode(&status(&[(6, 1), (14, 3)])), Mode::Watchdog);
        assert_eq!(mode(&status(&[(6, 1), (14, 2)])), Mode::Velocity);
        assert_eq!(mode(&status(&[(4, 1), (14, 1)])), Mode::Button);
        assert_eq!(mode(&status(&[(4, 1)])), Mode::Off);
        assert_eq!(mode(&status(&[(3, 1)])), Mode::Reset);
        assert_eq!(mode(&status(&[(0, 0)])), Mode::NoPower);
        assert_eq!(mode(&status(&[(1, 0), (5, 1)])), Mode::Lost);
        assert_eq!(mode(&status(&[(6, 1), (14, 5)])), Mode::Off);
        for number in 0..12 {
            let mode = Mode::of(number);
            assert!(mode as u32 == number || mode == Mode::Force, "{number}");
        }
    }

    #[test]
    fn remarks_name_the_remedy() {
        assert!(
            Mode::Button
                .remark("a")
                .is_some_and(|text| text.contains("FORCE button"))
        );
        assert!(
            Mode::Reset
                .remark("a")
                .is_some_and(|text| text.contains("calibration pole"))
        );
        assert_eq!(Mode::Force.remark("a"), None);
        assert!(refusal("omega.6 17", Code(20), "device in use").contains("another program"));
        assert_eq!(Code(20).state(), State::InUse);
        assert_eq!(
            (Code(2).class(), Code(7).class()),
            (Class::Lost, Class::Passing)
        );
        assert!(is_supported([3, 17, 5, 0]) && !is_supported([2, 9, 0, 0]));
    }
}
