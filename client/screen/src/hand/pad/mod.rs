//! Gamepad: events of the kernel become states of sticks and presses of buttons.
//!
//! Numbers of events, axes and buttons are those of Linux (`input-event-codes.h`, `Documentation/input/gamepad.rst`):
//!
//! | part | numbers |
//! |---|---|
//! | left stick | axes 0 and 1 |
//! | right stick | axes 3 and 4; without them axes 2 and 5 |
//! | left and right trigger | axes 2 and 5 beside a right stick at 3 and 4; else axes 21 and 20; else buttons 312 and 313 |
//! | right side: lower, right, upper, left | buttons 304, 305, 307, 308 |
//! | shoulders: left, right | buttons 310, 311 |
//! | select, start, left stick, right stick | buttons 314, 315, 317, 318 |
//!
//! Drivers of some gamepads give the buttons X and Y the numbers of each other's place.

mod button;
#[cfg(all(feature = "gamepad", target_os = "linux"))]
mod device;

pub use button::PadButton;
#[cfg(all(feature = "gamepad", target_os = "linux"))]
pub use device::Pads;

use super::sticks::Sticks;

/// Kinds of the kernel's events: end of a group, button, axis.
const GROUP: u16 = 0;
const BUTTON: u16 = 1;
const AXIS: u16 = 3;
/// Number of axes of the kernel.
const AXES: usize = 64;
/// Numbers of the triggers as buttons.
const TRIGGER_BUTTONS: [u16; 2] = [312, 313];

/// Axis of a device: its number, present value, and range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PadAxis {
    /// Number of the axis.
    pub number: u16,
    /// Present value.
    pub value: i32,
    /// Least and greatest value.
    pub range: [i32; 2],
}

/// Event of a gamepad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PadEvent {
    /// New state of sticks, triggers and shoulder buttons.
    Sticks(Sticks),
    /// Press, true, or release of a button.
    Button(PadButton, bool),
}

/// State of a gamepad.
#[derive(Clone, Debug, PartialEq)]
pub struct Pad {
    /// Least and greatest value of each axis; `None` for an axis that the device has not.
    ranges: [Option<[i32; 2]>; AXES],
    values: [i32; AXES],
    shoulders: [bool; 2],
    /// Triggers of a device whose triggers are buttons.
    triggers: [bool; 2],
    /// State of the last event.
    told: Sticks,
}

impl Pad {
    /// Gamepad with the axes of a device.
    pub fn new(axes: impl IntoIterator<Item = PadAxis>) -> Self {
        let mut pad = Self {
            ranges: [None; AXES],
            values: [0; AXES],
            shoulders: [false; 2],
            triggers: [false; 2],
            told: Sticks::default(),
        };
        for axis in axes {
            let number = usize::from(axis.number);
            if let Some(range) = pad.ranges.get_mut(number) {
                *range = Some(axis.range);
                pad.values[number] = axis.value;
            }
        }
        pad
    }

    /// Takes in an event of the kernel: its kind, number and value. Adds events of the gamepad to `events`; the state
    /// of the sticks at the end of a group. An unknown number changes nothing.
    pub fn feed(&mut self, kind: u16, number: u16, value: i32, events: &mut Vec<PadEvent>) {
        match kind {
            AXIS => {
                if let Some(known) = self.values.get_mut(usize::from(number)) {
                    *known = value;
                }
            }
            BUTTON => self.press(number, value, events),
            GROUP if number == 0 => {
                let sticks = self.sticks();
                if sticks != self.told {
                    self.told = sticks;
                    events.push(PadEvent::Sticks(sticks));
                }
            }
            _ => {}
        }
    }

    fn press(&mut self, number: u16, value: i32, events: &mut Vec<PadEvent>) {
        // 2 is the repetition of a held key.
        let is_down = match value {
            0 => false,
            1 => true,
            _ => return,
        };
        if let Some(k) = TRIGGER_BUTTONS.iter().position(|k| *k == number) {
            self.triggers[k] = is_down;
        }
        let Some(button) = PadButton::of_kernel(number) else {
            return;
        };
        match button {
            PadButton::LeftShoulder => self.shoulders[0] = is_down,
            PadButton::RightShoulder => self.shoulders[1] = is_down,
            _ => {}
        }
        events.push(PadEvent::Button(button, is_down));
    }

    /// State of sticks, triggers and shoulder buttons.
    fn sticks(&self) -> Sticks {
        let has = |number: usize| self.ranges[number].is_some();
        // Axes downwards are positive in the kernel.
        let stick = |x: usize, y: usize| [self.centred(x), -self.centred(y)];
        let has_right = has(3) && has(4);
        let right = if has_right { [3, 4] } else { [2, 5] };
        let analog = [[2, 5], [21, 20]].into_iter().enumerate();
        let mut analog = analog.filter(|(k, [l, r])| has(*l) && has(*r) && (has_right || *k > 0));
        let triggers = match analog.next() {
            Some((_, axes)) => axes.map(|axis| self.pulled(axis)),
            None => self.triggers.map(|down| f64::from(u8::from(down))),
        };
        Sticks {
            left: stick(0, 1),
            right: stick(right[0], right[1]),
            triggers,
            shoulders: self.shoulders,
        }
    }

    /// Share of the deflection from the middle of the range, -1 to 1; 0 for an axis that the device has not.
    fn centred(&self, number: usize) -> f64 {
        2.0 * self.share(number).unwrap_or(0.5) - 1.0
    }

    /// Share of the range from its least value on, 0 to 1; 0 for an axis that the device has not.
    fn pulled(&self, number: usize) -> f64 {
        self.share(number).unwrap_or(0.0)
    }

    fn share(&self, number: usize) -> Option<f64> {
        let [low, high] = self.ranges[number]?.map(f64::from);
        let value = f64::from(self.values[number]);
        (high > low).then(|| ((value - low) / (high - low)).clamp(0.0, 1.0))
    }
}

#[cfg(test)]
mod tests;
