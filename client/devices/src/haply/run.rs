//! Run: one message with the forces of all hands, one reply with their poses, once per period.

mod again;
mod rest;

use sulcus_haptics::device::Stop;
use sulcus_haptics::port::HandPort;
use sulcus_haptics::{Trip, Unready};
use sulcus_link::clock::{monotonic_ns, sleep_until};

use super::back_off::BackOff;
use super::device::HaplyDevice;
use super::flow::Flow;
use super::message::message;
use super::reply::Reply;

/// Period without a steady connection, nanoseconds.
const ALONE_NS: u64 = 1_000_000;

/// Run of a device.
pub(super) struct Run<'a> {
    device: &'a mut HaplyDevice,
    ports: Vec<HandPort>,
    back_off: BackOff,
    /// Time of the next attempt to connect.
    retry_ns: u64,
    warned: Warned,
    /// Number of messages, and their first and last time.
    messages: u64,
    between_ns: Option<(u64, u64)>,
    rested: bool,
}

/// Sentences that have been logged.
#[derive(Default)]
struct Warned {
    silent: bool,
    different: Vec<bool>,
    refused: String,
}

impl<'a> Run<'a> {
    /// Run of `device` with a port for each hand.
    pub(super) fn new(device: &'a mut HaplyDevice, ports: Vec<HandPort>) -> Self {
        let warned = Warned {
            different: vec![false; ports.len()],
            ..Warned::default()
        };
        Self {
            device,
            ports,
            back_off: BackOff::new(),
            retry_ns: 0,
            warned,
            messages: 0,
            between_ns: None,
            rested: false,
        }
    }

    /// Runs until `stop` is asked.
    pub(super) fn until(&mut self, stop: &Stop) {
        let mut next_ns = monotonic_ns();
        while !stop.is_asked() {
            sleep_until(next_ns);
            let at_ns = self.tick();
            let steady = self.device.flow.as_ref().is_some_and(Flow::is_steady);
            let period_ns = if steady {
                self.device.period_ns
            } else {
                ALONE_NS
            };
            // A late period moves the later ones. The rest of half a period lets a doubled reply arrive and be dropped.
            next_ns = (next_ns + period_ns).max(at_ns + period_ns / 2);
        }
    }

    /// Performs one period, and returns its time.
    fn tick(&mut self) -> u64 {
        self.listen();
        self.follow_events();
        if self.device.flow.is_none() {
            self.connect();
        }
        let now_ns = monotonic_ns();
        self.exchange(now_ns, None);
        self.send(now_ns);
        now_ns
    }

    /// Takes the newest reply.
    fn listen(&mut self) {
        let Some(flow) = &mut self.device.flow else {
            return;
        };
        let was_steady = flow.is_steady();
        let heard = flow.listen();
        if was_steady && !flow.is_steady() && !std::mem::replace(&mut self.warned.silent, true) {
            tracing::warn!(
                "the Haply service at {} gave no reply for 20 ms: the force is zero until a button is pressed",
                self.device.address
            );
        }
        match heard {
            Ok(Some(text)) => {
                let now_ns = monotonic_ns();
                if let Some(reply) = Reply::parse(&text) {
                    self.device
                        .hands
                        .iter_mut()
                        .for_each(|hand| hand.take(&reply, now_ns));
                }
            }
            Ok(None) => {}
            Err(cause) => self.lose(&cause),
        }
    }

    fn follow_events(&mut self) {
        let Some(events) = &self.device.events else {
            return;
        };
        while let Some(event) = events.next() {
            for (hand, port) in self.device.hands.iter_mut().zip(&mut self.ports) {
                if let Some(sentence) = hand.event(&event) {
                    port.trip(Trip::Driver);
                    tracing::warn!("{sentence}");
                }
            }
        }
    }

    /// Exchanges pose and force with every port. `instead` replaces every pose.
    fn exchange(&mut self, now_ns: u64, instead: Option<Unready>) {
        let flow = self.device.flow.as_ref();
        let unready = instead.or(match flow {
            None => Some(Unready::Absent),
            Some(flow) if !flow.is_steady() || flow.has_gap(now_ns) => Some(Unready::NoPose),
            Some(_) => None,
        });
        for (i, (hand, port)) in self
            .device
            .hands
            .iter_mut()
            .zip(&mut self.ports)
            .enumerate()
        {
            if hand.is_refused() {
                port.trip(Trip::Driver);
            }
            if let Some(difference) = hand.difference()
                && !std::mem::replace(&mut self.warned.different[i], true)
            {
                tracing::warn!("{} at {}: {difference}", hand.id(), self.device.address);
            }
            let pose = unready.map_or_else(|| hand.pose(now_ns), Err);
            let wrench = port.exchange(
                now_ns,
                pose.as_ref().map_err(|unready| *unready),
                hand.buttons(now_ns),
            );
            hand.set_force(wrench.force);
        }
    }

    /// Sends the forces, if a message may leave.
    fn send(&mut self, now_ns: u64) {
        let hands = &mut self.device.hands;
        let Some(flow) = &mut self.device.flow else {
            return;
        };
        if !flow.may_send(now_ns) {
            return;
        }
        let orders = hands.iter().map(|hand| hand.order());
        let text = message(flow.is_first(), flow.field(), orders);
        hands.iter_mut().for_each(|hand| hand.sent(now_ns));
        self.messages += 1;
        let begin_ns = self.between_ns.map_or(now_ns, |(begin_ns, _)| begin_ns);
        self.between_ns = Some((begin_ns, now_ns));
        if let Err(cause) = flow.send(text, now_ns) {
            self.lose(&cause);
        }
    }
}

impl Drop for Run<'_> {
    fn drop(&mut self) {
        self.rest(false);
    }
}
