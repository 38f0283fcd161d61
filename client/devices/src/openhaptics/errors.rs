//! Error codes of the library: their classes, and a sentence for each.

use super::sys::ErrorInfo;
use crate::State;

/// What an error means for the run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// The driver refuses force and keeps running: warm motors, force or speed above a limit.
    Force,
    /// The device or the scheduler is lost.
    Lost,
    /// Another error, such as a wrong call.
    Other,
}

impl ErrorInfo {
    /// Class of the error.
    pub fn class(&self) -> Class {
        class(self.code)
    }

    /// Whether a device with this error is usable: the driver refuses no more than force.
    pub fn is_mild(&self) -> bool {
        self.class() == Class::Force
    }
}

/// Class of an error code.
pub fn class(code: u32) -> Class {
    match code {
        0x200..=0x204 => Class::Force,
        0x302..=0x304 | 0x500 | 0x501 => Class::Lost,
        _ => Class::Other,
    }
}

/// State of a device that does not open with this error.
pub fn state(code: u32) -> State {
    match code {
        0x300 | 0x302 => State::NoDevice,
        0x301 => State::InUse,
        _ => State::Error,
    }
}

/// Sentence about a device that does not open: cause and remedy. `text` is the library's own text.
pub fn refusal(name: &str, code: u32, text: &str, library: &str) -> String {
    let shown = if name.is_empty() {
        "the default device"
    } else {
        name
    };
    let remedy = match code {
        0x300 => {
            "check its name in the setup program and its cable, and end other programs that use it"
        }
        0x301 => "another part of this program uses it: end that session first",
        0x302 => "check cable and power, and end other programs that use it",
        0x303 => {
            "unplug it, wait five seconds and plug it in again: a program that was killed leaves it locked"
        }
        0x304 => "unplug it, plug it in again and start the computer anew if the error stays",
        0x600 => {
            return format!(
                "OpenHaptics does not open {shown}: {text} (0x600, {library}): install OpenHaptics 3.4, which needs no \
                 licence file, or set OH_SDK_LICENSE_PATH to the licence of an older version"
            );
        }
        _ => "run the test program of the driver",
    };
    format!("OpenHaptics does not open {shown}: {text} (0x{code:X}): {remedy}")
}

/// Sentence about an error during the run.
pub fn remark(name: &str, code: u32, text: &str) -> String {
    match code {
        0x200 => format!(
            "{name}: the motors are warm and the driver takes the force off: let the device cool, then press a button"
        ),
        0x201..=0x204 => format!(
            "{name}: the driver takes the force off ({text}, 0x{code:X}): move the tool away from tissue, then press a \
             button"
        ),
        _ if class(code) == Class::Lost => format!(
            "{name}: the connection is lost ({text}, 0x{code:X}): plug the device in again; start the program anew if it \
             does not return"
        ),
        _ => format!("{name}: the driver reports {text} (0x{code:X})"),
    }
}

/// Whether a library of this version is supported: 3.0 or newer, or a text without a number.
pub fn is_supported(version: &str) -> bool {
    let digits: String = version
        .chars()
        .skip_while(|c| !c.is_ascii_digit())
        .take_while(char::is_ascii_digit)
        .collect();
    digits.parse::<u32>().map_or(true, |major| major >= 3)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn classes_follow_the_note() {
        for code in [0x200, 0x201, 0x202, 0x203, 0x204] {
            assert_eq!(class(code), Class::Force);
        }
        for code in [0x302, 0x303, 0x304, 0x500, 0x501] {
            assert_eq!(class(code), Class::Lost);
        }
        for code in [0x100, 0x102, 0x205, 0x300, 0x301, 0x400, 0x402, 0x600] {
            assert_eq!(class(code), Class::Other);
        }
    }

    #[test]
    fn a_refusal_names_cause_and_remedy() {
        assert!(refusal("Left", 0x303, "comm config", "libHD.so").contains("plug it in again"));
        let licence = refusal("", 0x600, "invalid license", "/opt/libHD.so");
        assert!(
            licence.contains("/opt/libHD.so") && licence.contains("3.4"),
            "{licence}"
        );
        assert!(licence.contains("the default device"));
    }

    #[test]
    fn versions_from_three_on_are_supported() {
        for version in ["3.4.0", "3.0", "OpenHaptics 3.5", "10.1", "", "unknown"] {
            assert!(is_supported(version), "{version}");
        }
        for version in ["2.0.4", "HDAPI 1.2", "0"] {
            assert!(!is_supported(version), "{version}");
        }
    }

    proptest::proptest! {
        #[test]
        fn no_text_of_a_version_panics(text in "\\PC*") {
            is_supported(&text);
        }
    }
}
