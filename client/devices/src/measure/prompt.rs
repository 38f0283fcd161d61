//! Prompts of a measurement to the person, and the answers.

use std::fmt;

use super::plan::Part;

/// Request to the person.
#[derive(Clone, Debug, PartialEq)]
pub enum Prompt {
    /// Hold the handle in the middle of the workspace and press a button of the device. No answer is needed: the press
    /// ends the prompt.
    PressButton,
    /// Let the handle go: the device holds it.
    HoldNothing,
    /// Take the handle, which the device holds no longer after the answer.
    TakeHandle,
    /// Hold the handle lightly.
    HoldLightly,
    /// Hold the handle firmly.
    HoldFirmly,
    /// Put the tip on a scale and leave it there.
    PutOnScale,
    /// Read the scale at a force of so many newtons, and give grams.
    ReadScale {
        /// Force downwards, newtons.
        newtons: f64,
    },
}

impl Prompt {
    /// Whether the prompt waits for an [`Answer`].
    pub fn needs_answer(&self) -> bool {
        !matches!(self, Self::PressButton)
    }

    /// Whether the answer is a reading in grams.
    pub fn needs_grams(&self) -> bool {
        matches!(self, Self::ReadScale { .. })
    }
}

impl fmt::Display for Prompt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::PressButton => f.write_str(
                "Hold the handle in the middle of its workspace, touch nothing with it, and press a button of the \
                 device.",
            ),
            Self::HoldNothing => f.write_str(
                "The device now holds the handle. Let the handle go slowly, and keep your hands away until told.",
            ),
            Self::TakeHandle => f.write_str(
                "Take the handle in your hand. After your answer the device holds it no longer.",
            ),
            Self::HoldLightly => f.write_str(
                "Hold the handle lightly, as you hold a pen. A floor rises under it and carries about 40 g. Keep your \
                 hand where it is. The force ends by itself when the handle shakes.",
            ),
            Self::HoldFirmly => f.write_str(
                "Hold the handle firmly, with the hand on a rest. A floor rises under it and carries about 40 g. Keep \
                 your hand where it is. The force ends by itself when the handle shakes.",
            ),
            Self::PutOnScale => f.write_str(
                "Put a kitchen scale under the device and the tip of the handle on the scale. The handle must stand \
                 upright by itself or be held upright without weight.",
            ),
            Self::ReadScale { newtons } => {
                write!(f, "The device presses down with {newtons} N. Read the scale: grams?")
            }
        }
    }
}

/// Answer of the person.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Answer {
    /// Done as the prompt asks.
    Ready,
    /// Reading of the scale, grams.
    Grams(f64),
    /// Leave the stage out.
    Skip,
    /// End the measurement. Results so far stay.
    Stop,
}

/// Person who answers prompts.
pub trait Ask {
    /// Shows a prompt that needs no answer.
    fn tell(&mut self, prompt: &Prompt);

    /// Shows a prompt and waits for its answer. The device holds its force meanwhile.
    fn ask(&mut self, prompt: &Prompt) -> Answer;

    /// Whether a key was pressed that replaces the device's button, for a device without buttons.
    fn pressed(&mut self) -> bool {
        false
    }
}

/// Progress of a measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Present stage; `None` after the last one.
    pub part: Option<Part>,
    /// Number of finished stages.
    pub finished: usize,
    /// Number of all stages.
    pub all: usize,
    /// Share of the present stage that is done, 0 to 1.
    pub share: f64,
}
