//! Hand-overs of a session, as the station and its student's connections use them.

use std::sync::atomic::Ordering;
use std::sync::mpsc::SyncSender;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use sulcus_link::Bell;
use sulcus_proto::control::Event;
use sulcus_sessions::{Detached, Occurrence};

use crate::net::datagrams::Datagrams;
use crate::outlets::recording::{EVENTS, FromNetwork};
use crate::session::at_hand::HandPort;
use crate::session::handoff::{Attachment, Flags, Pressed, Progress};

/// Largest sum of a client's events in one session, bytes of kind and content. A client must not fill the disk.
const EVENT_BYTES: usize = 1024 * 1024;

/// Channel of a client's events to the recorder, bounded in number and in bytes. A push never blocks.
#[derive(Debug)]
pub(super) struct Events {
    to_recorder: SyncSender<FromNetwork>,
    /// Sum of the accepted events, bytes.
    bytes: usize,
    /// Number of events that found the queue full or the bytes used up.
    dropped: u64,
}

impl Events {
    pub fn new(to_recorder: SyncSender<FromNetwork>) -> Self {
        Self {
            to_recorder,
            bytes: 0,
            dropped: 0,
        }
    }

    fn push(&mut self, event: Event) {
        let to_recorder = self.to_recorder.clone();
        // A recorder that has ended has raised its flag, after a panic by its alarm.
        self.push_to(event, |event| {
            to_recorder.try_send(FromNetwork::Event(event)).is_ok()
        });
    }

    /// Passes an event within the limits to `take`, which returns whether it has taken the event.
    fn push_to(&mut self, event: Event, take: impl FnOnce(Event) -> bool) {
        let bytes = self.bytes + event.kind.len() + event.json.len();
        if bytes <= EVENT_BYTES && take(event) {
            self.bytes = bytes;
            return;
        }
        if self.dropped == 0 {
            tracing::warn!(
                "the client sent more than {EVENT_BYTES} bytes of events, or more than {EVENTS} events at once: \
                 further events may be dropped"
            );
        }
        self.dropped += 1;
    }
}

/// Ends of a session's hand-overs for the connections of its student. The connection that is attached uses them; a
/// later connection takes over.
#[derive(Debug)]
pub(crate) struct Ports {
    pub(super) datagrams: Mutex<Datagrams>,
    pub(super) events: Mutex<Events>,
    pub(super) pressed: Arc<Pressed>,
    pub(super) bell: Bell,
    pub(super) flags: Arc<Flags>,
    pub(super) progress: Arc<Progress>,
    pub(super) attachment: Arc<Attachment>,
    /// Ends of ticks at the hand; `None` if the server ticks.
    pub(super) hand: Option<HandPort>,
}

impl Ports {
    /// Ends of ticks at the hand; `None` if the server ticks.
    pub fn hand(&self) -> Option<&HandPort> {
        self.hand.as_ref()
    }

    /// Datagrams of the session. The lock is held for one datagram at most, and never across an `await`.
    pub fn datagrams(&self) -> MutexGuard<'_, Datagrams> {
        // After a panic of a connection the datagrams are whole: each step leaves them consistent.
        self.datagrams
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
    }

    /// Wake-up of the network: after every tick, at the end of the simulation, and at a failure of the recorder.
    pub fn bell(&self) -> &Bell {
        &self.bell
    }

    /// Flags of the session.
    pub fn flags(&self) -> &Flags {
        &self.flags
    }

    /// Progress of the simulation.
    pub fn progress(&self) -> &Progress {
        &self.progress
    }

    /// Takes all tools away: the student is gone. The recording holds the reason.
    pub fn let_go(&self, reason: Detached) {
        self.attachment.gone(reason);
        self.datagrams().let_go();
    }

    /// A student is back over another connection.
    pub fn returned(&self) {
        if let Some(hand) = &self.hand {
            hand.returned();
        }
    }

    /// Begins the epoch of a new connection, or of the end of a pause.
    pub fn begin_epoch(&self, epoch: u32) {
        self.attachment.epoch.store(epoch, Ordering::Release);
        self.datagrams().begin_epoch(epoch);
    }

    /// Newest tick.
    pub fn tick(&self) -> u64 {
        self.progress.tick.load(Ordering::Relaxed)
    }

    /// Passes the press of a button to the simulation.
    pub fn press(&self, tool: u8, button: u8) {
        self.pressed.press(tool, button);
    }

    /// Passes an event of the client to the recorder. An event above the limits is dropped and counted.
    pub fn event(&self, event: Event) {
        let mut events = self.events();
        match &self.hand {
            // The recorder must not hear of a tick before it has the tick.
            Some(hand) => events.push_to(event, |event| hand.event(event)),
            None => events.push(event),
        }
    }

    /// Passes a last message to the recorder at the end of the session. Waits for room.
    pub(super) fn say(&self, message: FromNetwork) {
        let to_recorder = self.events().to_recorder.clone();
        // A recorder that has ended has raised its flag.
        let _ = to_recorder.send(message);
    }

    /// Number of the client's events that were dropped.
    pub fn events_dropped(&self) -> u64 {
        self.events().dropped
    }

    /// Passes an event of the station to the recorder. `false`: the recorder's channel is full or closed.
    pub fn occurrence(&self, occurrence: Occurrence) -> bool {
        let message = FromNetwork::Occurrence(Box::new(occurrence));
        self.events().to_recorder.try_send(message).is_ok()
    }

    fn events(&self) -> MutexGuard<'_, Events> {
        self.events.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::sync_channel;

    use super::*;

    fn event(bytes: usize) -> Event {
        Event {
            tick: 1,
            kind: String::new(),
            json: "x".repeat(bytes),
        }
    }

    #[test]
    fn events_are_bounded_in_number_and_in_bytes() {
        let (sender, recorder) = sync_channel(EVENTS);
        let mut events = Events::new(sender);
        for _ in 0..EVENTS + 2 {
            events.push(event(1));
        }
        assert_eq!(events.dropped, 2);
        assert_eq!(recorder.try_iter().count(), EVENTS);
        events.push(event(EVENT_BYTES - EVENTS));
        events.push(event(1));
        assert_eq!(events.dropped, 3);
        assert_eq!(recorder.try_iter().count(), 1);
    }
}
