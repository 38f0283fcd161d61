//! Thread that reads the channel of events.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::time::Duration;

use sulcus_link::clock::{monotonic_ns, sleep_until};

use super::address::Address;
use super::back_off::BackOff;
use super::event::{Event, Meaning};
use super::line::Line;

/// Number of events that wait at most. An event beyond is lost, and so is its repetition.
const WAITING: usize = 256;
/// Time between two looks at the end of the run, nanoseconds.
const LOOK_NS: u64 = 50_000_000;
/// Time limit of a connection.
const MOST: Duration = Duration::from_millis(500);

/// Events of the service. The thread ends with the value.
#[derive(Debug)]
pub(super) struct Events {
    receiver: Receiver<Event>,
    stop: Arc<AtomicBool>,
}

impl Events {
    /// Starts the thread. `address` is that of the channel of events.
    pub(super) fn start(address: Address) -> std::io::Result<Self> {
        let (sender, receiver) = sync_channel(WAITING);
        let stop = Arc::new(AtomicBool::new(false));
        let asked = stop.clone();
        let work = move || read(&address, &sender, &asked);
        std::thread::Builder::new()
            .name("haply-events".into())
            .spawn(work)?;
        Ok(Self { receiver, stop })
    }

    /// Next event that has arrived.
    pub(super) fn next(&self) -> Option<Event> {
        self.receiver.try_recv().ok()
    }
}

impl Drop for Events {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Release);
    }
}

/// Reads events until `stop`, over as many connections as it takes.
fn read(address: &Address, events: &SyncSender<Event>, stop: &AtomicBool) {
    let stopped = || stop.load(Ordering::Acquire);
    let mut back_off = BackOff::new();
    let mut warned = false;
    while !stopped() {
        let cause = match Line::open(address, MOST) {
            Ok(mut line) => {
                back_off = BackOff::new();
                let cause = follow(&mut line, events, &stopped);
                let _ = events.try_send(Event {
                    device: String::new(),
                    meaning: Meaning::Ended,
                });
                cause
            }
            Err(cause) => cause,
        };
        if !std::mem::replace(&mut warned, true) && !stopped() {
            tracing::warn!(
                "the channel of events of the Haply service at {address} is not there ({cause}): a safety event of an \
                 arm shows by its force alone until the channel returns"
            );
        }
        let until_ns = monotonic_ns() + back_off.next();
        while !stopped() && monotonic_ns() < until_ns {
            sleep_until((monotonic_ns() + LOOK_NS).min(until_ns));
        }
    }
}

/// Passes events on until the end of the connection, and returns its cause.
fn follow(line: &mut Line, events: &SyncSender<Event>, stopped: &impl Fn() -> bool) -> String {
    while !stopped() {
        match line.next() {
            Ok(Some(text)) => {
                if let Some(event) = Event::parse(&text) {
                    let _ = events.try_send(event);
                }
            }
            Ok(None) => line.wait(monotonic_ns() + LOOK_NS),
            Err(cause) => return cause,
        }
    }
    String::new()
}
