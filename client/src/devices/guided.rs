//! Device with a ghost and its guide.

use sulcus_connection::device::{DeviceEvent, EventDevice, Glance};
use sulcus_core::{MAX_TOOLS, ToolInput, Vec3};
use sulcus_haptics::guide::{Guide, GuideParams};
use sulcus_haptics::{HandSource, Merger, Shown};
use sulcus_proto::control::Command;

use super::recorded::Recorded;

/// Kind of the event that names the ghost in the recording.
pub const GHOST: &str = "ghost";

/// Device beside a ghost.
pub struct Guided {
    device: Box<dyn EventDevice>,
    guide: Guide,
    said: Option<DeviceEvent>,
}

impl Guided {
    /// Device beside the ghost of `recorded`. `most_n` is the largest force of the guide, newtons; 0: the ghost is seen
    /// and not felt.
    pub fn new(device: Box<dyn EventDevice>, recorded: &Recorded, most_n: f64) -> Self {
        let tips = std::array::from_fn(|t| {
            let tool = recorded.scene.tools.get(t);
            tool.map_or(Vec3::zeros(), |tool| tool.tip)
        });
        let params = GuideParams {
            most_n,
            ..GuideParams::default()
        };
        Self {
            device,
            guide: Guide::new(params, recorded.path(), recorded.scene.tick_s(), tips),
            said: Some(DeviceEvent {
                kind: GHOST,
                json: format!("{{\"most_n\":{most_n}}}"),
            }),
        }
    }
}

impl HandSource for Guided {
    fn name(&self) -> &str {
        self.device.name()
    }
    fn exchange(&mut self, shown: &Shown) -> [ToolInput; MAX_TOOLS] {
        self.device.exchange(shown)
    }
    fn is_done(&self) -> bool {
        self.device.is_done()
    }
}

impl EventDevice for Guided {
    fn events(&mut self) -> Vec<DeviceEvent> {
        let mut events = self.device.events();
        events.extend(self.said.take());
        events
    }
    fn commands(&mut self) -> Vec<Command> {
        self.device.commands()
    }
    fn glance(&mut self, glance: &Glance) {
        self.device.glance(glance);
    }
    fn hear(&mut self, text: &str) {
        self.device.hear(text);
    }
    fn threaded(&mut self) -> Option<&mut Merger> {
        self.device.threaded()
    }
    fn guide(&mut self) -> Option<&mut Guide> {
        Some(&mut self.guide)
    }
}
