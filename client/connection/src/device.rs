//! Device whose user makes events for the recording.

use sulcus_core::{MAX_TOOLS, Pose, ToolInput, Wrench};
use sulcus_haptics::guide::Guide;
use sulcus_haptics::{HandSource, Merger, Shown, Stage};
use sulcus_proto::control::Command;
use sulcus_proto::datagram::WireLevels;

/// State of the link and of the hands in one pass of the device's loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glance {
    /// Time of the pass, nanoseconds of [`crate::link::now_ns`].
    pub now_ns: u64,
    /// Tick of the newest wrench.
    pub tick: u64,
    /// Pause and force limit of the newest wrench.
    pub levels: WireLevels,
    /// Share of the force that the watchdog lets pass, 0 to 1.
    pub gate: f64,
    /// Whether the link is being restored.
    pub is_returning: bool,
    /// Time from the measurement of the answered pose to the arrival of the wrench, milliseconds.
    pub age_ms: Option<f64>,
    /// Displayed wrenches, world axes.
    pub displayed: [Wrench; MAX_TOOLS],
    /// Poses of the graphic tools; `None` before the first wrench.
    pub graphics: [Option<Pose>; MAX_TOOLS],
    /// Whether a hand holds the tool.
    pub held: [bool; MAX_TOOLS],
    /// Poses of the ghost's tools; `None` without a ghost.
    pub ghost: [Option<Pose>; MAX_TOOLS],
    /// Stages of devices with threads of their own; `None` for a slot without such a device.
    pub stages: [Option<Stage>; MAX_TOOLS],
}

/// Event of a device's user, for the recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DeviceEvent {
    /// Kind, as in [`sulcus_proto::control::Event::kind`].
    pub kind: &'static str,
    /// Content as JSON.
    pub json: String,
}

/// Device whose user makes events, for example calls of probing depths.
pub trait EventDevice: HandSource {
    /// Returns the events since the previous call of this function. The default returns none.
    fn events(&mut self) -> Vec<DeviceEvent> {
        Vec::new()
    }

    /// Returns the commands of the user since the previous call of this function. The default returns none.
    fn commands(&mut self) -> Vec<Command> {
        Vec::new()
    }

    /// Takes the state of each pass of the loop, for a screen. The default ignores the state.
    fn glance(&mut self, _: &Glance) {}

    /// Takes a message of an instructor for a screen. The default ignores the message.
    fn hear(&mut self, _: &str) {}

    /// Hands of devices with threads of their own, each behind a door at its device. The default is `None`: the loop
    /// reads the hands in step, behind doors of its own.
    fn threaded(&mut self) -> Option<&mut Merger> {
        None
    }

    /// Guide along a recorded path, whose wrench is added before the door. The default is none.
    fn guide(&mut self) -> Option<&mut Guide> {
        None
    }
}

impl HandSource for Box<dyn EventDevice> {
    fn name(&self) -> &str {
        (**self).name()
    }
    fn exchange(&mut self, shown: &Shown) -> [ToolInput; MAX_TOOLS] {
        (**self).exchange(shown)
    }
    fn is_done(&self) -> bool {
        (**self).is_done()
    }
}

impl EventDevice for Box<dyn EventDevice> {
    fn events(&mut self) -> Vec<DeviceEvent> {
        (**self).events()
    }
    fn commands(&mut self) -> Vec<Command> {
        (**self).commands()
    }
    fn glance(&mut self, glance: &Glance) {
        (**self).glance(glance);
    }
    fn hear(&mut self, text: &str) {
        (**self).hear(text);
    }
    fn threaded(&mut self) -> Option<&mut Merger> {
        (**self).threaded()
    }
    fn guide(&mut self) -> Option<&mut Guide> {
        (**self).guide()
    }
}
