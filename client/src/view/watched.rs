//! Device that a window watches.

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use sulcus_connection::device::{DeviceEvent, EventDevice, Glance};
use sulcus_core::{MAX_TOOLS, ToolInput};
use sulcus_haptics::guide::Guide;
use sulcus_haptics::{HandSource, Merger, Shown};
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
    texts: rtrb::Producer<String>,
    /// Number of requests for the start of the force, and of those taken.
    starts: Arc<AtomicU32>,
    started: u32,
}

/// Window's end of a watched device. No function waits.
pub struct Eyes {
    /// State of the newest pass.
    pub glances: Output<Option<Glance>>,
    /// Events of the window, for the recording.
    pub events: rtrb::Producer<DeviceEvent>,
    /// Commands of the student.
    pub commands: rtrb::Producer<Command>,
    /// Messages of an instructor.
    pub texts: rtrb::Consumer<String>,
    /// Number of requests for the start of the force.
    pub starts: Arc<AtomicU32>,
}

impl Watched {
    /// Device with the window's end.
    pub fn new(device: Box<dyn EventDevice>) -> (Self, Eyes) {
        let (glances_in, glances) = triple_buffer(&None);
        let (events_in, events) = rtrb::RingBuffer::new(WAITING);
        let (commands_in, commands) = rtrb::RingBuffer::new(WAITING);
        let (texts, texts_out) = rtrb::RingBuffer::new(WAITING);
        let watched = Self {
            device,
            glances: glances_in,
            events,
            commands,
            texts,
            starts: Arc::default(),
            started: 0,
        };
        let eyes = Eyes {
            glances,
            events: events_in,
            commands: commands_in,
            texts: texts_out,
            starts: watched.starts.clone(),
        };
        (watched, eyes)
    }
}

impl HandSource for Watched {
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

    fn hear(&mut self, text: &str) {
        self.device.hear(text);
        // The ring is full only if the window hangs.
        let _ = self.texts.push(text.to_owned());
    }

    fn threaded(&mut self) -> Option<&mut Merger> {
        let starts = self.starts.load(Ordering::Relaxed);
        let is_new = std::mem::replace(&mut self.started, starts) != starts;
        let merger = self.device.threaded()?;
        if is_new {
            (0..MAX_TOOLS).for_each(|slot| merger.press(slot));
        }
        Some(merger)
    }

    fn guide(&mut self) -> Option<&mut Guide> {
        self.device.guide()
    }
}
