//! Device that a window watches.

use sulcus_connection::device::{DeviceEvent, EventDevice, Glance};
use sulcus_core::{MAX_TOOLS, ToolInput};
use sulcus_haptics::{Device, Shown};
use sulcus_proto::control::Command;
use triple_buffer::{Input, Output, triple_buffer};

/// Number of events and of commands that wait for the next pass of the device's loop. A person makes a few in a second.
const WAITING: usize = 256;

/// Device with a window: the loop leaves its state for the window, and takes the window's events.
pub struct Watched {
    device: Box<dyn EventDevice>,
    glances: Input<Option<Glance>>,
    events: rtrb::Consumer<DeviceEvent>,
    commands: rtrb::Consumer<Command>,
}

/// Window's end of a watched device. No function waits.
pub struct Eyes {
    /// State of the newest pass.
    pub glances: Output<Option<Glance>>,
    /// Events of the window, for the recording.
    pub events: rtrb::Producer<DeviceEvent>,
    /// Commands of the student.
    pub commands: rtrb::Producer<Command>,
}

impl Watched {
    /// Device with the window's end.
    pub fn new(device: Box<dyn EventDevice>) -> (Self, Eyes) {
        let (glances_in, glances) = triple_buffer(&None);
        let (events_in, events) = rtrb::RingBuffer::new(WAITING);
        let (commands_in, commands) = rtrb::RingBuffer::new(WAITING);
        let watched = Self {
            device,
            glances: glances_in,
            events,
            commands,
        };
        let eyes = Eyes {
            glances,
            events: events_in,
            commands: commands_in,
        };
        (watched, eyes)
    }
}

impl Device for Watched {
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

impl EventDevice for Watched {
    fn events(&mut self) -> Vec<DeviceEvent> {
        let mut events = self.device.events();
        events.extend(std::iter::from_fn(|| self.events.pop().ok()));
        events
    }

    fn commands(&mut self) -> Vec<Command> {
        let mut commands = self.device.commands();
        commands.extend(std::iter::from_fn(|| self.commands.pop().ok()));
        commands
    }

    fn glance(&mut self, glance: &Glance) {
        self.device.glance(glance);
        self.glances.write(Some(*glance));
    }
}
