//! State of the service: devices, connections, faults in wait, and the log.

mod answer;
mod faults;
mod grips;
mod json;
mod orders;
mod pending;
mod reply;
mod settings;

use std::collections::BTreeMap;
use std::io;
use std::path::Path;
use std::sync::mpsc::{Receiver, Sender, channel};

use serde_json::json;

use crate::clock::now_ns;
use crate::device::{Arm, ArmView, Forces, Grip};
use crate::log::{EndReason, IdleCause, Violation, What, Writer};
use crate::options::{Options, Replies};
use crate::version::Version;

pub(crate) use answer::Answer;
use pending::Pending;

/// State of the service.
#[derive(Debug)]
pub(crate) struct World {
    version: Version,
    arms: Vec<Arm>,
    grips: Vec<Grip>,
    unknown_arrays: Vec<String>,
    replies: Replies,
    bare_settings: bool,
    forces: Forces,
    links: BTreeMap<u64, Link>,
    last_link: u64,
    messages: u64,
    pending: Pending,
    listeners: Vec<Sender<String>>,
    report_ns: Option<(u64, u64)>,
    log: Writer,
}

/// A simulation connection.
#[derive(Debug, Default)]
struct Link {
    messages: u64,
    profile: bool,
    close: bool,
    /// Count of connections of each device whose config the client knows, by id.
    known: BTreeMap<String, u64>,
}

impl World {
    /// State at the start; the log is appended to a file.
    pub(crate) fn new(options: &Options, log: &Path) -> io::Result<Self> {
        let now = now_ns();
        Ok(Self {
            version: options.version,
            arms: options.arms.iter().map(|arm| Arm::new(arm, now)).collect(),
            grips: options
                .grips
                .iter()
                .map(|grip| Grip::new(grip, now))
                .collect(),
            unknown_arrays: options.unknown_arrays.clone(),
            replies: options.replies.clone(),
            bare_settings: options.bare_settings,
            forces: Forces {
                scale: options.force_scale,
                peak_n: options.peak_force_n,
                watchdog_ns: (options.watchdog_ms.max(0.0) * 1e6) as u64,
            },
            links: BTreeMap::new(),
            last_link: 0,
            messages: 0,
            pending: Pending::default(),
            listeners: Vec::new(),
            report_ns: options
                .rate_report_ms
                .map(|ms| (ms.max(1) * 1_000_000, now)),
            log: Writer::open(log)?,
        })
    }

    /// Writes the first entry of the log.
    pub(crate) fn started(&mut self, port: u16, events_port: u16) {
        let version = self.version;
        self.log.add(
            now_ns(),
            What::Started {
                version,
                port,
                events_port,
            },
        );
        self.log.flush();
    }

    /// Writes the last entry of the log.
    pub(crate) fn stopped(&mut self) {
        self.log.add(now_ns(), What::Stopped);
        self.log.flush();
    }

    /// Moves every device to now; the time of now.
    pub(crate) fn advance(&mut self) -> u64 {
        let now = now_ns();
        for arm in &mut self.arms {
            if let Some(t_ns) = arm.advance(now, self.forces) {
                let what = What::Idle {
                    device: arm.id.clone(),
                    cause: IdleCause::Watchdog,
                    last_command_ns: arm.last_command_ns(),
                };
                self.log.add(t_ns, what);
            }
        }
        for grip in &mut self.grips {
            grip.advance(now);
        }
        now
    }

    /// One step of the thread that watches the arms: idle states, reports, and the log to its file.
    pub(crate) fn watch(&mut self) {
        let now = self.advance();
        if let Some((period, last)) = self.report_ns
            && now >= last + period
        {
            self.report_ns = Some((period, now));
            self.event("system-rate-report", "info", "", json!({}));
        }
        self.log.flush();
    }

    /// A simulation connection stands; its number and the inventory.
    pub(crate) fn connect(&mut self) -> (u64, Answer) {
        let now = self.advance();
        self.last_link += 1;
        let number = self.last_link;
        self.links.insert(number, Link::default());
        self.log.add(now, What::Connected { connection: number });
        (number, self.answer(number, true))
    }

    /// A simulation connection ended; its commands hold until the watchdog of each arm.
    pub(crate) fn disconnect(&mut self, number: u64, reason: EndReason) {
        let now = self.advance();
        let messages = self.links.remove(&number).map_or(0, |link| link.messages);
        self.log.add(
            now,
            What::Ended {
                connection: number,
                reason,
                messages,
            },
        );
        self.log.flush();
    }

    /// A connection of the channel of events stands; its queue of events.
    pub(crate) fn listen(&mut self) -> Receiver<String> {
        let (sender, receiver) = channel();
        self.listeners.push(sender);
        self.log.add(now_ns(), What::EventsConnected);
        receiver
    }

    /// A connection of the channel of events ended.
    pub(crate) fn unlisten(&mut self) {
        self.log.add(now_ns(), What::EventsEnded);
    }

    /// Writes a broken rule to the log.
    pub(crate) fn violation(&mut self, connection: u64, rule: Violation, detail: &str) {
        let number = self.links.get(&connection).map_or(0, |link| link.messages);
        let what = What::Violation {
            connection,
            number,
            rule,
            detail: detail.into(),
        };
        self.log.add(now_ns(), what);
    }

    /// Sends an event to every connection of the channel of events.
    pub(crate) fn event(&mut self, name: &str, level: &str, device: &str, data: serde_json::Value) {
        let category = name.split('-').next().unwrap_or_default();
        let mut data = data;
        if let (Some(map), false) = (data.as_object_mut(), device.is_empty()) {
            map.insert("device_id".into(), device.into());
        }
        let message = format!("{name} {device}");
        let event = json!({
            "name": name, "category": category, "level": level, "data": data, "message": message.trim_end(),
        });
        let text = event.to_string();
        self.listeners
            .retain(|listener| listener.send(text.clone()).is_ok());
        let listeners = self.listeners.len();
        self.log.add(
            now_ns(),
            What::Event {
                name: name.into(),
                device: device.into(),
                listeners,
            },
        );
    }

    /// An arm as it is now.
    pub(crate) fn view(&mut self, id: &str) -> Option<ArmView> {
        self.advance();
        self.arms
            .iter()
            .find(|arm| arm.id == id)
            .map(|arm| arm.view(self.forces))
    }

    /// Number of messages of every connection.
    pub(crate) fn messages(&self) -> u64 {
        self.messages
    }

    /// Hands what is buffered of the log to the system.
    pub(crate) fn flush(&mut self) {
        self.log.flush();
    }
}
