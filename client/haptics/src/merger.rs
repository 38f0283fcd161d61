//! Merger of the hands of several devices: one input per period of the link from devices with clocks of their own.
//!
//! Each hand contributes its newest pose. A pose is at most one period of its device older than the moment of the
//! merge. Poses of both hands belong to different moments, and the age of each is known.

use std::time::Duration;

use sulcus_core::{MAX_TOOLS, ToolInput, Wrench};

use crate::door::Wanted;
use crate::port::{HandEnd, Sample};

/// Age from which the newest pose of a device counts as no pose: the device's thread has stopped.
pub const DEVICE_SILENT: Duration = Duration::from_millis(50);

/// Hands of all devices of a session, by the slots of their tools.
#[derive(Debug, Default)]
pub struct Merger {
    ends: [Option<HandEnd>; MAX_TOOLS],
    presses: [u32; MAX_TOOLS],
}

/// Hand in one period of the link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Merged {
    /// Input of the tool.
    pub tool: ToolInput,
    /// Newest state of the hand at its device.
    pub sample: Sample,
    /// Age of the pose, nanoseconds; `None` without a device or a valid pose.
    pub age_ns: Option<u64>,
}

impl Merged {
    /// Hand of an empty slot.
    pub const NOTHING: Self = Self {
        tool: ToolInput::ABSENT,
        sample: Sample::NOTHING,
        age_ns: None,
    };

    /// Wrench that the device displays now; zero for a device whose thread has stopped.
    pub fn displayed(&self, now_ns: u64) -> Wrench {
        if is_silent(&self.sample, now_ns) {
            Wrench::ZERO
        } else {
            self.sample.displayed
        }
    }
}

impl Merger {
    /// Creates a merger of the ends of both slots. A slot without a device is `None`.
    pub fn new(ends: [Option<HandEnd>; MAX_TOOLS]) -> Self {
        Self {
            ends,
            presses: [0; MAX_TOOLS],
        }
    }

    /// Counts a press of a key that replaces the button of the device in `slot`.
    pub fn press(&mut self, slot: usize) {
        if let Some(presses) = self.presses.get_mut(slot) {
            *presses = presses.wrapping_add(1);
        }
    }

    /// Passes an order to the device of each slot. The count of presses is the merger's own.
    pub fn order(&mut self, wanted: &[Wanted; MAX_TOOLS]) {
        for ((end, wanted), presses) in self.ends.iter_mut().zip(wanted).zip(self.presses) {
            if let Some(end) = end {
                end.order(&Wanted { presses, ..*wanted });
            }
        }
    }

    /// Newest states of both hands at their devices. The buttons stay for [`Merger::read`].
    pub fn samples(&mut self) -> [Sample; MAX_TOOLS] {
        let newest = |end: &mut Option<HandEnd>| end.as_mut().map(HandEnd::sample);
        self.ends
            .each_mut()
            .map(|end| newest(end).unwrap_or(Sample::NOTHING))
    }

    /// Reads the newest state of both hands at `now_ns`, and takes the buttons.
    pub fn read(&mut self, now_ns: u64) -> [Merged; MAX_TOOLS] {
        self.ends.each_mut().map(|end| {
            let Some(end) = end else {
                return Merged::NOTHING;
            };
            let (sample, buttons) = (end.sample(), end.buttons());
            let present = sample.present && !is_silent(&sample, now_ns);
            let tool = if present {
                ToolInput {
                    pose: sample.pose,
                    present: true,
                    buttons,
                    ..ToolInput::ABSENT
                }
            } else {
                ToolInput::ABSENT
            };
            Merged {
                tool,
                sample,
                age_ns: present.then(|| now_ns.saturating_sub(sample.at_ns)),
            }
        })
    }
}

fn is_silent(sample: &Sample, now_ns: u64) -> bool {
    Duration::from_nanos(now_ns.saturating_sub(sample.at_ns)) >= DEVICE_SILENT
}
