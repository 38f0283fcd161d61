//! Device: all opened hands on one connection.

use std::panic::{AssertUnwindSafe, catch_unwind};

use sulcus_haptics::device::{Device, DeviceError, HandInfo, Stop};
use sulcus_haptics::port::HandPort;

use super::address::Address;
use super::connector::Connector;
use super::events::Events;
use super::flow::Flow;
use super::hand::Hand;
use super::run::Run;

/// Opened hands.
pub(super) struct HaplyDevice {
    /// Address of the service, for sentences.
    pub(super) address: Address,
    /// Hands.
    pub(super) infos: Vec<HandInfo>,
    /// States of the hands, in the same order.
    pub(super) hands: Vec<Hand>,
    /// Conversation with the service; `None` after a run.
    pub(super) flow: Option<Flow>,
    /// Period of the messages, nanoseconds.
    pub(super) period_ns: u64,
    /// Thread that connects again.
    pub(super) connector: Connector,
    /// Thread that reads events; `None` for an address without a port for events.
    pub(super) events: Option<Events>,
}

impl Device for HaplyDevice {
    fn info(&self) -> &[HandInfo] {
        &self.infos
    }

    fn run(&mut self, ports: Vec<HandPort>, stop: &Stop) -> Result<(), DeviceError> {
        let (expected, found) = (self.hands.len(), ports.len());
        if expected != found {
            return Err(DeviceError(format!(
                "the Haply device has {found} ports, expected one for each of its {expected} hands"
            )));
        }
        let mut run = Run::new(self, ports);
        let ended = catch_unwind(AssertUnwindSafe(|| run.until(stop)));
        // A port that panicked is not called again: its forces are zero at once.
        let rested = catch_unwind(AssertUnwindSafe(|| run.rest(ended.is_ok())));
        match ended.and(rested) {
            Ok(()) => Ok(()),
            Err(_) => Err(DeviceError(
                "the Haply back-end ended by an error of its own, and the forces are zero: restart the client".into(),
            )),
        }
    }
}
