//! Messages to the recorder: entries of the simulation's queue, buffers on their way back, words of the network.

use rtrb::Producer;
use sulcus_core::{TickOutput, Vec3};
use sulcus_proto::SessionSummary;
use sulcus_proto::control::Event;
use sulcus_sessions::{Occurrence, Row, Shapes};

use crate::session::levels::InForce;

/// Number of slots in the channel of events and of the end; chosen as more than a person causes in [`super::POLL`].
pub(crate) const EVENTS: usize = 256;

/// Entry of the simulation's queue. One queue keeps the order: look and shapes, then their tick, then its snapshot.
#[expect(
    clippy::large_enum_variant,
    reason = "nearly all are ticks, and a box would be allocated in the tick's thread"
)]
pub(crate) enum Entry {
    /// A tick. The recorder's thread finds the events and makes the viewers' messages.
    Tick(Ticked),
    /// Number of a tick, and the sphere centres after it that events need, world axes, metres: see
    /// [`sulcus_sessions::exercise::events::Look`].
    Look(u64, Vec<Vec3>),
    /// Shapes for viewers after the next tick in the queue.
    Shapes(Box<Shapes>),
    /// State after a tick, with the tick's time since 1970.
    Snapshot {
        unix_ns: u64,
        tick: u64,
        bytes: Vec<u8>,
    },
}

/// A tick on its way to the recorder.
pub(crate) struct Ticked {
    /// Exact row.
    pub row: Row,
    /// Output.
    pub output: TickOutput,
    /// CPU time, nanoseconds.
    pub cpu_ns: u32,
    /// Levels of both sides.
    pub in_force: InForce,
    /// Whether the student is gone.
    pub gone: bool,
}

/// Message from the network to the recorder.
pub(crate) enum FromNetwork {
    /// Event of the client.
    Event(Event),
    /// Event of the station: a gap, an instruction.
    Occurrence(Box<Occurrence>),
    /// End of the session. The simulation has ended, and no entry follows.
    End(Box<SessionSummary>),
}

/// Rings of buffers from the recorder back to the simulation.
pub(crate) struct Returned {
    /// Buffers of snapshots.
    pub snapshots: Producer<Vec<u8>>,
    /// Buffers of looks.
    pub looks: Producer<Vec<Vec3>>,
    /// Buffers of shapes for viewers.
    pub shapes: Producer<Box<Shapes>>,
}
