//! Hands of a recording: as a device that plays them again, and as the ghost of a guide.

use std::collections::VecDeque;
use std::path::Path;

use anyhow::{Context, bail};
use sulcus_connection::device::{DeviceEvent, EventDevice};
use sulcus_core::{MAX_TOOLS, Pose, Scene, ToolInput};
use sulcus_haptics::guide::Moment;
use sulcus_haptics::{HandSource, Shown, drawn};
use sulcus_program::PathText;
use sulcus_sessions::exercise::events::call::READING_CALLED;
use sulcus_sessions::{Message, Occurrence, Recording};

/// Name of the device that plays a recording again.
pub const NAME: &str = "playback";
/// Longest recording that is played again, ticks: three hours at 1 kHz.
const LONGEST: usize = 3 * 3600 * 1000;

/// Hands and calls of a recording.
pub struct Recorded {
    /// Inputs of the tools, tick by tick, without gaps of the clock.
    pub tools: Vec<[ToolInput; MAX_TOOLS]>,
    /// Data of the called readings, with the tick of each.
    pub calls: Vec<(u64, String)>,
    /// Scene of the recording.
    pub scene: Scene,
    /// Hash of the compiled scene.
    pub scene_hash: [u8; 32],
}

impl Recorded {
    /// Reads a recording.
    ///
    /// # Errors
    /// The file is no recording of this version, or longer than three hours.
    pub fn read(file: &Path) -> anyhow::Result<Self> {
        let recording =
            Recording::open(file).with_context(|| format!("recording {}", file.shown()))?;
        let scene = recording.scene()?;
        let (mut tools, mut calls) = (Vec::new(), Vec::new());
        for message in recording.messages() {
            match message? {
                Message::Row(row) => tools.push(row.input.tools),
                Message::Event(event) => {
                    let occurrence = Occurrence::parse(&event.text);
                    let called = occurrence.filter(|occurrence| occurrence.kind == READING_CALLED);
                    calls.extend(called.map(|call| (call.tick, call.data.to_string())));
                }
                _ => {}
            }
            if tools.len() > LONGEST {
                bail!(
                    "recording {} has more than {LONGEST} ticks, expected at most three hours",
                    file.shown()
                );
            }
        }
        let scene_hash = recording.header().scene_hash();
        Ok(Self {
            tools,
            calls,
            scene,
            scene_hash,
        })
    }

    /// Path of the tools for a guide: one moment for each tick.
    pub fn path(&self) -> Vec<Moment> {
        let pose = |tool: &ToolInput| -> Option<Pose> {
            drawn(&tool.pose).filter(|_| tool.present && !tool.stale)
        };
        self.tools
            .iter()
            .map(|tools| tools.each_ref().map(pose))
            .collect()
    }
}

/// Device that plays the hands of a recording again, with the recorded readings. The wrench has no effect on the hands.
pub struct Playback {
    tools: Vec<[ToolInput; MAX_TOOLS]>,
    calls: VecDeque<(u64, String)>,
    tick: usize,
}

impl Playback {
    /// Device for the hands of a recording.
    pub fn new(recorded: Recorded) -> Self {
        Self {
            tools: recorded.tools,
            calls: recorded.calls.into(),
            tick: 0,
        }
    }
}

impl HandSource for Playback {
    fn name(&self) -> &str {
        NAME
    }

    fn exchange(&mut self, _: &Shown) -> [ToolInput; MAX_TOOLS] {
        let tools = self.tools.get(self.tick).copied();
        self.tick += 1;
        // Age and staleness belong to the recorded link; this link has its own.
        tools.map_or([ToolInput::ABSENT; MAX_TOOLS], |tools| {
            tools.map(|tool| ToolInput {
                stale: false,
                age_ticks: 0,
                ..tool
            })
        })
    }

    fn is_done(&self) -> bool {
        self.tick >= self.tools.len() && self.calls.is_empty()
    }
}

impl EventDevice for Playback {
    fn events(&mut self) -> Vec<DeviceEvent> {
        let mut due = Vec::new();
        while self
            .calls
            .front()
            .is_some_and(|(tick, _)| *tick <= self.tick as u64)
        {
            due.extend(self.calls.pop_front().map(|(_, json)| DeviceEvent {
                kind: READING_CALLED,
                json,
            }));
        }
        due
    }
}

#[cfg(test)]
mod tests {
    use sulcus_core::{RawPose, Wrench};

    use super::*;

    /// The recording of a server has the poses that its ticks used; the device itself leaves none of them out.
    #[test]
    fn each_period_has_the_next_recorded_hand_and_readings_come_at_their_ticks() {
        let at = |tick: u16| {
            let pose = RawPose {
                position: [f32::from(tick) * 1e-4, 0.0, 0.0],
                orientation: [1.0, 0.0, 0.0, 0.0],
            };
            let tool = ToolInput {
                pose,
                present: true,
                stale: tick.is_multiple_of(3),
                age_ticks: tick,
                buttons: tick,
            };
            [tool, ToolInput::ABSENT]
        };
        let called = |tick: u64| (tick, format!("{{\"tick\":{tick}}}"));
        let mut device = Playback {
            tools: (0..500).map(at).collect(),
            calls: [called(3), called(200), called(520)].into(),
            tick: 0,
        };
        let shown = Shown {
            wrenches: [Wrench::ZERO; MAX_TOOLS],
            graphics: [None; MAX_TOOLS],
        };
        let mut heard = Vec::new();
        for tick in 0..530u16 {
            assert!(!device.is_done() || tick > 519, "{tick}");
            let tools = device.exchange(&shown);
            let expected = at(tick)[0];
            if tick < 500 {
                assert_eq!(tools[0].pose, expected.pose);
                assert_eq!(tools[0].buttons, expected.buttons);
                // Age and staleness belong to the recorded link.
                assert_eq!((tools[0].stale, tools[0].age_ticks), (false, 0));
            } else {
                assert_eq!(tools, [ToolInput::ABSENT; MAX_TOOLS]);
            }
            heard.extend(device.events().into_iter().map(|event| (tick, event.json)));
        }
        let text = |tick: u64| called(tick).1;
        assert_eq!(heard, [(2, text(3)), (199, text(200)), (519, text(520))]);
        assert!(device.is_done());
    }
}
