//! Hands of haptic devices with threads of their own, as one device of a session.

use std::sync::mpsc::Sender;
use std::thread::JoinHandle;

use sulcus_core::{MAX_TOOLS, ToolInput};
use sulcus_haptics::device::{Device, DeviceError, Stop};
use sulcus_haptics::door::Counts;
use sulcus_haptics::{DoorRules, HandPort, HandSource, Merger, Shown, Stage, port};
use sulcus_link::schedule::{exact_timers, fifo};
use sulcus_proto::device::DEVICE_EVENT;

use crate::device::{DeviceEvent, EventDevice, Glance};

/// SCHED_FIFO priority of a device's thread, above that of the loop of the link.
const PRIORITY: i32 = 46;
/// Time between two events of counters, nanoseconds.
const COUNTERS_NS: u64 = 5_000_000_000;

/// Device for some slots of a session.
pub struct Part {
    /// Device.
    pub device: Box<dyn Device>,
    /// Slot of the tool and rules of the door, for each hand of the device in the order of [`Device::info`].
    pub hands: Vec<(usize, DoorRules)>,
}

/// All haptic devices of a session. A drop ends their threads, with the forces at zero.
pub struct DeviceHands {
    name: String,
    merger: Merger,
    /// Identity of the device in each slot, `library:serial`.
    identities: [Option<String>; MAX_TOOLS],
    told: [Option<Told>; MAX_TOOLS],
    /// Takes a line for the person at each change of a stage.
    lines: Option<Sender<String>>,
    waiting: Vec<DeviceEvent>,
    stop: Stop,
    threads: Vec<JoinHandle<()>>,
}

/// State of a hand in its newest event.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Told {
    stage: Stage,
    counts: (u64, u64, u64),
    at_ns: u64,
}

impl DeviceHands {
    /// Starts the threads of all devices. `name` is the name for the server's log. `lines` takes a line for the person
    /// at each change of a stage; the loop never waits for it.
    ///
    /// # Errors
    /// The system has no thread, or a slot is given twice or does not exist.
    pub fn begin(
        name: String,
        parts: Vec<Part>,
        lines: Option<Sender<String>>,
    ) -> Result<Self, DeviceError> {
        let mut ends = [const { None }; MAX_TOOLS];
        let mut identities = [const { None }; MAX_TOOLS];
        let stop = Stop::new();
        let mut hands = Self {
            name,
            merger: Merger::default(),
            identities: [const { None }; MAX_TOOLS],
            told: [None; MAX_TOOLS],
            lines,
            waiting: Vec::new(),
            stop: stop.clone(),
            threads: Vec::new(),
        };
        for part in parts {
            let mut ports = Vec::new();
            for ((slot, rules), info) in part.hands.into_iter().zip(part.device.info()) {
                let free = ends.get(slot).is_some_and(Option::is_none);
                if !free {
                    return Err(DeviceError(format!(
                        "tool {slot} has two devices or does not exist, expected one device for each tool"
                    )));
                }
                let (port, end) = port::door(rules);
                ports.push(port);
                ends[slot] = Some(end);
                identities[slot] = Some(identity(info.library, &info.serial));
            }
            hands.threads.push(spawn(part.device, ports, stop.clone())?);
        }
        hands.merger = Merger::new(ends);
        hands.identities = identities;
        Ok(hands)
    }

    /// Prepares an event for each hand whose stage or counters changed. A session has a few of them.
    fn follow(&mut self, now_ns: u64) {
        let samples = self.merger.samples();
        for (slot, sample) in samples.iter().enumerate() {
            let Some(identity) = &self.identities[slot] else {
                continue;
            };
            let Counts {
                trips,
                dropped,
                limited,
                most_dropped_nm,
                ..
            } = sample.counts;
            let told = Told {
                stage: sample.stage,
                counts: (trips, dropped, limited),
                at_ns: now_ns,
            };
            let is_due = self.told[slot].is_none_or(|before| {
                let waited = now_ns.saturating_sub(before.at_ns) >= COUNTERS_NS;
                before.stage != told.stage || before.counts != told.counts && waited
            });
            if is_due {
                let before = self.told[slot].replace(told).map(|before| before.stage);
                if let Some(lines) = self.lines.as_ref().filter(|_| before != Some(told.stage)) {
                    // Refused if nobody reads the lines any more.
                    let _ = lines.send(format!("{identity}: {}", told.stage));
                }
                let json = format!(
                    "{{\"tool\":{slot},\"device\":\"{identity}\",\"stage\":\"{}\",\"trips\":{trips},\
                     \"dropped_torque_periods\":{dropped},\"most_dropped_torque_mnm\":{:.3},\"limited_periods\":{limited}}}",
                    told.stage.name(),
                    most_dropped_nm * 1e3,
                );
                let kind = DEVICE_EVENT;
                self.waiting.push(DeviceEvent { kind, json });
            }
        }
    }
}

impl HandSource for DeviceHands {
    fn name(&self) -> &str {
        &self.name
    }

    /// The loop reads threaded devices through [`EventDevice::threaded`]. No hand is present here, and no wrench
    /// passes.
    fn exchange(&mut self, _: &Shown) -> [ToolInput; MAX_TOOLS] {
        [ToolInput::ABSENT; MAX_TOOLS]
    }
}

impl EventDevice for DeviceHands {
    fn events(&mut self) -> Vec<DeviceEvent> {
        std::mem::take(&mut self.waiting)
    }

    fn glance(&mut self, glance: &Glance) {
        self.follow(glance.now_ns);
    }

    fn threaded(&mut self) -> Option<&mut Merger> {
        Some(&mut self.merger)
    }
}

impl Drop for DeviceHands {
    fn drop(&mut self) {
        self.stop.ask();
        for thread in self.threads.drain(..) {
            if thread.join().is_err() {
                tracing::warn!("the thread of a haptic device panicked");
            }
        }
    }
}

/// Identity of a device in events. Characters of a serial number that would need an escape in JSON are left out.
fn identity(library: &str, serial: &str) -> String {
    let plain = |c: &char| c.is_ascii_graphic() && !['"', '\\'].contains(c);
    let serial: String = serial.chars().filter(plain).collect();
    format!("{library}:{serial}")
}

/// Starts the thread of a device.
fn spawn(
    mut device: Box<dyn Device>,
    ports: Vec<HandPort>,
    stop: Stop,
) -> Result<JoinHandle<()>, DeviceError> {
    let run = move || {
        exact_timers();
        if let Err(error) = fifo(PRIORITY) {
            tracing::debug!("no real-time scheduling for a haptic device: {error}");
        }
        if let Err(error) = device.run(ports, &stop) {
            tracing::warn!("a haptic device has ended: {error}; the session goes on without it");
        }
    };
    std::thread::Builder::new()
        .name("sulcus-haptic".into())
        .spawn(run)
        .map_err(|error| DeviceError(format!("no thread for a haptic device: {error}")))
}
