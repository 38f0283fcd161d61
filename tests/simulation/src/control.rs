//! Control stream of a connection: messages that arrive once and in order, or never with a connection that is gone.

use std::collections::VecDeque;

use fastrand::Rng;
use sulcus_proto::ClientMessage;

use crate::faults::MS;

/// Shortest and longest delay of a message, nanoseconds.
const DELAY: [u64; 2] = [MS / 10, 150 * MS];
/// Time from the end of a cut to the repetition of what the cut has lost, nanoseconds.
const REPEATED: u64 = 200 * MS;

/// Message to the server.
#[derive(Clone, Debug, PartialEq)]
pub enum Up {
    /// Hello of a new connection of the session's student.
    Attach,
    /// Message of the client in the session.
    Message(ClientMessage),
}

/// Message to the client.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Down {
    /// Hello of the server with the epoch of the connection.
    Welcome(u32),
    /// New epoch of the same connection.
    Epoch(u32),
}

/// One direction of the control streams of all connections.
pub struct Stream<T> {
    rng: Rng,
    /// Time of arrival, connection, message.
    waiting: VecDeque<(u64, (u32, T))>,
}

impl<T> Stream<T> {
    /// Sends a message of a connection at `now_ns`, in a path that is open from `open_ns` on.
    pub fn send(&mut self, now_ns: u64, open_ns: u64, message: (u32, T)) {
        let repeated = if open_ns > now_ns {
            open_ns + REPEATED
        } else {
            now_ns
        };
        let at_ns = repeated + self.rng.u64(DELAY[0]..DELAY[1]);
        let before = self.waiting.back().map_or(0, |(at_ns, _)| *at_ns);
        self.waiting.push_back((at_ns.max(before), message));
    }

    /// Time of the next arrival.
    pub fn next_ns(&self) -> Option<u64> {
        self.waiting.front().map(|(at_ns, _)| *at_ns)
    }

    /// Next message that has arrived by `now_ns`, with its connection.
    pub fn receive(&mut self, now_ns: u64) -> Option<(u32, T)> {
        if self.next_ns()? > now_ns {
            return None;
        }
        self.waiting.pop_front().map(|(_, message)| message)
    }
}

/// Control streams in both directions.
pub struct Control {
    /// To the server.
    pub up: Stream<Up>,
    /// To the client.
    pub down: Stream<Down>,
}

impl Control {
    /// Streams whose delays follow from a seed.
    pub fn new(seed: u64) -> Self {
        let mut rng = Rng::with_seed(seed);
        Self {
            up: Stream {
                rng: rng.fork(),
                waiting: VecDeque::new(),
            },
            down: Stream {
                rng: rng.fork(),
                waiting: VecDeque::new(),
            },
        }
    }
}
