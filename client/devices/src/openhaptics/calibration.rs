//! Calibration of a device: one step in each tick until the library reports the end.

use super::sys::{CALIBRATION_NEEDS_MANUAL_INPUT, CALIBRATION_NEEDS_UPDATE, CALIBRATION_OK};

/// Way of calibration: the device calibrates itself.
const AUTO: u32 = 2;
/// Way of calibration: the stylus stands in its well.
const INKWELL: u32 = 4;
/// Way of calibration: the arm is held in its neutral pose.
const ENCODER_RESET: u32 = 1;

/// Number of ticks between two checks of a device that is calibrated.
const CHECK_EVERY: u32 = 100;

/// What a tick does for the calibration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// The device is calibrated.
    Ready,
    /// One call of the update, of this way.
    Update(u32),
    /// The person must act first.
    Wait,
}

/// Calibration of one device.
#[derive(Clone, Debug)]
pub struct Calibration {
    style: u32,
    is_ready: bool,
    ticks: u32,
}

impl Calibration {
    /// Calibration of a device with these ways, one bit each.
    pub fn new(styles: u32) -> Self {
        let style = [AUTO, INKWELL, ENCODER_RESET]
            .into_iter()
            .find(|style| styles & style != 0);
        Self {
            style: style.unwrap_or(AUTO),
            is_ready: false,
            ticks: 0,
        }
    }

    /// Whether this tick must check the state: each tick until the calibration is right, then each hundredth.
    pub fn is_due(&mut self) -> bool {
        self.ticks = (self.ticks + 1) % CHECK_EVERY;
        !self.is_ready || self.ticks == 0
    }

    /// Whether the device is calibrated.
    pub fn is_ready(&self) -> bool {
        self.is_ready
    }

    /// Takes the library's state, and whether the person holds a button.
    pub fn step(&mut self, state: u32, is_pressed: bool) -> Step {
        self.is_ready = state == CALIBRATION_OK;
        match state {
            CALIBRATION_OK => Step::Ready,
            CALIBRATION_NEEDS_UPDATE => Step::Update(self.style),
            // The button tells that the arm is in its neutral pose.
            CALIBRATION_NEEDS_MANUAL_INPUT if is_pressed && self.style == ENCODER_RESET => {
                Step::Update(self.style)
            }
            _ => Step::Wait,
        }
    }
}

/// Sentence to the person about a device in this state, of these ways.
pub fn remark(name: &str, state: u32, styles: u32) -> String {
    let act = match Calibration::new(styles).style {
        INKWELL => "put the stylus into its well",
        ENCODER_RESET => "hold the arm in its neutral pose and press the button of the stylus",
        _ => "move the stylus slowly through its whole workspace",
    };
    if state == CALIBRATION_NEEDS_MANUAL_INPUT {
        format!("{name} is not calibrated and has no force: {act}")
    } else {
        format!("{name} is being calibrated and has no force yet: {act}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn updates_go_on_until_the_library_is_content() {
        let mut calibration = Calibration::new(AUTO | INKWELL);
        for _ in 0..5 {
            assert!(calibration.is_due());
            assert_eq!(calibration.step(0x5001, false), Step::Update(AUTO));
        }
        assert_eq!(calibration.step(0x5000, false), Step::Ready);
        assert!(calibration.is_ready());
        let checks = (0..1000).filter(|_| calibration.is_due()).count();
        assert_eq!(checks, 10);
        assert_eq!(calibration.step(0x5001, false), Step::Update(AUTO));
        assert!(!calibration.is_ready());
    }

    #[test]
    fn an_encoder_reset_waits_for_the_button() {
        let mut calibration = Calibration::new(ENCODER_RESET);
        assert_eq!(calibration.step(0x5002, false), Step::Wait);
        assert_eq!(calibration.step(0x5002, true), Step::Update(ENCODER_RESET));
        let mut inkwell = Calibration::new(INKWELL);
        assert_eq!(inkwell.step(0x5002, true), Step::Wait);
        // A state that the library does not know is no calibration.
        assert_eq!(inkwell.step(0, true), Step::Wait);
        assert!(!inkwell.is_ready());
        assert!(remark("Left", 0x5002, INKWELL).contains("well"));
    }
}
