//! Input of a tick from the arrived data: newest pose, age, staleness, pause, force limit, buttons.

use std::time::Duration;

use sulcus_core::{MAX_TOOLS, RawPose, TickInput, ToolInput};
use sulcus_proto::datagram::WireWrench;
use sulcus_proto::limits;
use sulcus_sessions::record::sample::{DeviceSample, DeviceSamples};

use crate::session::handoff::PoseIn;
use crate::session::levels::InForce;

/// State of the inputs between ticks.
#[derive(Debug)]
pub(crate) struct Inputs {
    /// Number of tools in the scene. Further slots stay absent, whatever a client sends.
    tools: usize,
    /// Time between two ticks, nanoseconds.
    tick_ns: u64,
    pose: Option<PoseIn>,
    gone: bool,
    /// Age of the pose at the last tick, microseconds.
    age_us: u32,
    /// Age of the pose at the first tick that used it, microseconds. `None`: no tick has used it yet.
    wait_us: Option<u32>,
    /// Pause and force limit for the next tick.
    pub in_force: InForce,
    /// Level of detail for the next tick.
    pub detail: u8,
    /// Buttons pressed since the tool's last tick with a hand. Each is input of one tick at least, even if every pose
    /// that held it was lost, and waits for a tick with a hand.
    pressed: [u16; MAX_TOOLS],
}

impl Inputs {
    pub fn new(tools: usize, tick_ns: u64) -> Self {
        Self {
            tools,
            tick_ns,
            pose: None,
            gone: false,
            age_us: 0,
            wait_us: None,
            in_force: InForce::default(),
            detail: 0,
            pressed: [0; MAX_TOOLS],
        }
    }

    /// Takes a newer pose. `None`: the student is gone, and all tools are absent.
    pub fn pose(&mut self, pose: Option<PoseIn>) {
        self.gone = pose.is_none();
        self.pose = pose;
        self.wait_us = None;
    }

    /// Whether the student is gone.
    pub fn gone(&self) -> bool {
        self.gone
    }

    /// Newest pose; `None` before the first one.
    pub fn newest(&self) -> Option<&PoseIn> {
        self.pose.as_ref()
    }

    /// Age of the pose at the first tick that used it, microseconds; 0 before that tick.
    pub fn wait_us(&self) -> u32 {
        self.wait_us.unwrap_or(0)
    }

    /// Samples of the devices behind the input of a tick: of each present tool the newest reading.
    pub fn samples(&self, input: &TickInput) -> DeviceSamples {
        let Some(pose) = &self.pose else {
            return DeviceSamples::default();
        };
        std::array::from_fn(|slot| {
            let reading = &pose.datagram.tools[slot];
            let WireWrench { force, torque } = reading.displayed;
            input.tools[slot].present.then_some(DeviceSample {
                sequence: reading.sequence,
                device_time_ns: reading.device_time_ns,
                age_us: self.age_us,
                displayed: [
                    force[0], force[1], force[2], torque[0], torque[1], torque[2],
                ],
            })
        })
    }

    /// Adds pressed buttons, for each tool.
    pub fn pressed(&mut self, buttons: [u16; MAX_TOOLS]) {
        for (pressed, buttons) in self.pressed.iter_mut().zip(buttons) {
            *pressed |= buttons;
        }
    }

    /// Input of the tick that begins at `now_ns` of the server's monotonic clock, after `skipped` missed grid points.
    /// Without a pose all tools are absent.
    pub fn take(&mut self, now_ns: u64, skipped: u16) -> TickInput {
        let mut input = TickInput {
            paused: self.in_force.paused(),
            force_limit_n: self.in_force.force_limit_n(),
            skipped,
            detail: self.detail,
            ..TickInput::IDLE
        };
        let Some(pose) = &self.pose else { return input };
        // The pose may have arrived after `now_ns` was read.
        let age_ns = now_ns.saturating_sub(pose.arrived_ns);
        self.age_us = u32::try_from(age_ns / 1000).unwrap_or(u32::MAX);
        self.wait_us.get_or_insert(self.age_us);
        let stale = Duration::from_nanos(age_ns) >= limits::POSE_STALE;
        let age_ticks = u16::try_from(age_ns / self.tick_ns).unwrap_or(u16::MAX);
        for (slot, tool) in pose.datagram.tools.iter().take(self.tools).enumerate() {
            if tool.present {
                input.tools[slot] = ToolInput {
                    pose: RawPose {
                        position: tool.pose.position,
                        orientation: tool.pose.orientation,
                    },
                    present: true,
                    stale,
                    age_ticks,
                    buttons: tool.buttons | std::mem::take(&mut self.pressed[slot]),
                };
            }
        }
        input
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sulcus_proto::PoseDatagram;

    const TICK_NS: u64 = 1_000_000;

    fn pose(arrived_ns: u64, present: [bool; 2]) -> PoseIn {
        let mut datagram = PoseDatagram::default();
        for (tool, present) in datagram.tools.iter_mut().zip(present) {
            tool.present = present;
            tool.pose.position = [0.1, 0.2, 0.3];
        }
        PoseIn {
            datagram,
            arrived_ns,
        }
    }

    #[test]
    fn no_pose_is_no_tool() {
        assert_eq!(Inputs::new(2, TICK_NS).take(5, 0), TickInput::IDLE);
    }

    #[test]
    fn a_pose_ages_and_goes_stale_after_fifty_ticks() {
        let mut inputs = Inputs::new(1, TICK_NS);
        inputs.pose(Some(pose(10 * TICK_NS, [true, false])));
        let ages: Vec<_> = [9, 10, 11, 59, 60, 100_000]
            .map(|tick| inputs.take(tick * TICK_NS, 0).tools[0])
            .map(|tool| (tool.age_ticks, tool.stale))
            .into();
        assert_eq!(
            ages,
            [
                (0, false),
                (0, false),
                (1, false),
                (49, false),
                (50, true),
                (u16::MAX, true)
            ]
        );
        inputs.pose(Some(pose(100_000 * TICK_NS, [true, false])));
        assert!(!inputs.take(100_000 * TICK_NS, 0).tools[0].stale);
    }

    /// At a lower rate of the wrenches, most ticks that are sent use a pose for the second time.
    #[test]
    fn the_wait_of_a_pose_is_that_of_its_first_tick() {
        let mut inputs = Inputs::new(1, TICK_NS);
        for (arrived, waits) in [(TICK_NS / 4, 750), (4 * TICK_NS + TICK_NS / 2, 500)] {
            inputs.pose(Some(pose(arrived, [true, false])));
            let first = (arrived / TICK_NS + 1) * TICK_NS;
            for later in 0..3 {
                inputs.take(first + later * TICK_NS, 0);
                assert_eq!(inputs.wait_us(), waits);
            }
        }
    }

    #[test]
    fn a_sample_is_what_the_device_said_and_how_old_it_was() {
        let mut inputs = Inputs::new(2, TICK_NS);
        let mut newest = pose(10 * TICK_NS, [true, false]);
        newest.datagram.tools[0].sequence = 7;
        newest.datagram.tools[0].device_time_ns = 8;
        newest.datagram.tools[0].displayed.torque[2] = 0.5;
        inputs.pose(Some(newest));
        let input = inputs.take(12 * TICK_NS + 500_000, 0);
        let [Some(sample), None] = inputs.samples(&input) else {
            panic!("one tool")
        };
        assert_eq!((sample.sequence, sample.device_time_ns), (7, 8));
        assert_eq!((sample.age_us, sample.displayed[5]), (2500, 0.5));
        inputs.pose(None);
        let input = inputs.take(13 * TICK_NS, 0);
        assert_eq!(inputs.samples(&input), [None, None]);
    }

    #[test]
    fn a_student_who_is_gone_holds_no_tool() {
        let mut inputs = Inputs::new(1, TICK_NS);
        inputs.pose(Some(pose(0, [true, false])));
        assert!(inputs.take(0, 0).tools[0].present && !inputs.gone());
        inputs.pose(None);
        assert!(inputs.gone());
        assert_eq!(inputs.take(0, 0), TickInput::IDLE);
    }

    #[test]
    fn slots_without_hand_or_without_tool_are_absent() {
        let mut inputs = Inputs::new(1, TICK_NS);
        inputs.pose(Some(pose(0, [false, true])));
        assert_eq!(
            inputs.take(0, 3),
            TickInput {
                skipped: 3,
                ..TickInput::IDLE
            }
        );
    }

    #[test]
    fn a_press_is_seen_for_one_tick_even_when_no_pose_holds_it() {
        let mut inputs = Inputs::new(1, TICK_NS);
        inputs.pose(Some(pose(0, [true, false])));
        inputs.pressed([8, 1]);
        assert_eq!(inputs.take(0, 0).tools[0].buttons, 8);
        assert_eq!(inputs.take(0, 0).tools[0].buttons, 0);
    }

    #[test]
    fn a_press_waits_for_a_pose_and_a_hand() {
        let mut inputs = Inputs::new(1, TICK_NS);
        inputs.pressed([8, 0]);
        assert_eq!(inputs.take(0, 0), TickInput::IDLE);
        inputs.pose(Some(pose(0, [false, false])));
        assert_eq!(inputs.take(0, 0), TickInput::IDLE);
        inputs.pose(Some(pose(0, [true, false])));
        assert_eq!(inputs.take(0, 0).tools[0].buttons, 8);
        assert_eq!(inputs.take(0, 0).tools[0].buttons, 0);
    }

    #[test]
    fn levels_are_input_of_every_tick_from_the_first_on() {
        let mut inputs = Inputs::new(1, TICK_NS);
        inputs.in_force.station.paused = true;
        inputs.in_force.station.force_limit_n = 1.5;
        for _ in 0..2 {
            let input = inputs.take(0, 0);
            assert!(input.paused);
            assert_eq!(input.force_limit_n, 1.5);
        }
        inputs.in_force.station.paused = false;
        assert!(!inputs.take(0, 0).paused);
    }
}
