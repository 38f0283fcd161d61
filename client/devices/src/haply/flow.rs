//! Messages and replies on one connection: exactly one reply to each message, silence, and the return of late replies.

use sulcus_link::clock::monotonic_ns;
use tungstenite::Utf8Bytes;

use super::line::Line;
use super::version::Field;

/// Time without a reply from which the service is silent, nanoseconds.
const SILENT_NS: u64 = 20_000_000;
/// Time between two messages to a silent service, nanoseconds.
const AGAIN_NS: u64 = 50_000_000;
/// Time without a reply from which the connection is lost, nanoseconds.
const LOST_NS: u64 = 500_000_000;
/// Time without a further reply after which no late reply is under way, nanoseconds.
const SETTLED_NS: u64 = 5_000_000;
/// Time between two messages from which the service may have taken the force away, nanoseconds.
const GAP_NS: u64 = 16_000_000;

/// Conversation on one connection.
#[derive(Debug)]
pub(super) struct Flow {
    line: Line,
    field: Field,
    /// Whether the first message is still to come.
    first: bool,
    state: State,
    /// Time of the newest message.
    sent_ns: Option<u64>,
    /// Time of the first message without a reply; `None` for an answered message.
    waits_ns: Option<u64>,
    heard_ns: u64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    /// Each message is answered in time.
    Steady,
    /// No reply for [`SILENT_NS`].
    Silent,
    /// The service answers again; late replies are under way.
    Settling,
}

impl Flow {
    /// Conversation on a new connection, or on one whose first message is sent and answered.
    pub(super) fn new(line: Line, field: Field, first: bool) -> Self {
        Self {
            line,
            field,
            first,
            state: State::Steady,
            sent_ns: None,
            waits_ns: None,
            heard_ns: monotonic_ns(),
        }
    }

    /// Field of a force.
    pub(super) fn field(&self) -> Field {
        self.field
    }

    /// Whether the next message is the first one.
    pub(super) fn is_first(&self) -> bool {
        self.first
    }

    /// Takes the newest reply. Waits for it until the service is silent.
    ///
    /// # Errors
    /// The connection is lost: cause.
    pub(super) fn listen(&mut self) -> Result<Option<Utf8Bytes>, String> {
        loop {
            let (_, newest) = self.line.newest()?;
            let now_ns = monotonic_ns();
            if newest.is_some() {
                self.heard_ns = now_ns;
                self.waits_ns = None;
                if self.state == State::Silent {
                    self.state = State::Settling;
                }
                return Ok(newest);
            }
            let waited_ns = self
                .waits_ns
                .map_or(0, |since| now_ns.saturating_sub(since));
            match (self.state, self.waits_ns) {
                (State::Steady, Some(_)) if waited_ns >= SILENT_NS => self.state = State::Silent,
                (State::Steady, Some(since)) => {
                    self.line.wait(since + SILENT_NS);
                    continue;
                }
                (State::Silent, _) if waited_ns >= LOST_NS => {
                    return Err(format!("no reply for {} ms", LOST_NS / 1_000_000));
                }
                (State::Settling, _) if now_ns.saturating_sub(self.heard_ns) >= SETTLED_NS => {
                    self.state = State::Steady;
                }
                _ => {}
            }
            return Ok(None);
        }
    }

    /// Whether each message is answered in time.
    pub(super) fn is_steady(&self) -> bool {
        self.state == State::Steady
    }

    /// Whether the service may have taken the force away since the newest message.
    pub(super) fn has_gap(&self, now_ns: u64) -> bool {
        self.sent_ns
            .is_some_and(|sent_ns| now_ns.saturating_sub(sent_ns) >= GAP_NS)
    }

    /// Whether the next message may leave.
    pub(super) fn may_send(&self, now_ns: u64) -> bool {
        match self.state {
            State::Steady => self.waits_ns.is_none(),
            State::Silent => self
                .sent_ns
                .is_none_or(|sent| now_ns.saturating_sub(sent) >= AGAIN_NS),
            State::Settling => false,
        }
    }

    /// Sends a message.
    ///
    /// # Errors
    /// The connection is lost: cause.
    pub(super) fn send(&mut self, text: String, now_ns: u64) -> Result<(), String> {
        self.first = false;
        self.sent_ns = Some(now_ns);
        self.waits_ns.get_or_insert(now_ns);
        self.line.send(text)
    }

    /// Takes the last reply, and closes the connection.
    pub(super) fn close(mut self) {
        // The connection ends anyway, whatever the reply.
        let _ = self.listen();
        self.line.close();
    }
}
