//! What crosses from thread to thread. Every hand-over is wait-free for the simulation: triple
//! buffers where the newest wins, rings where nothing may be lost, one eventfd as the only wake-up.

use std::os::fd::OwnedFd;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use rustix::event::{EventfdFlags, eventfd};
use sulcus_core::Params;
use sulcus_proto::{PoseDatagram, WrenchDatagram};
use tokio::io::Interest;
use tokio::io::unix::AsyncFd;

/// Slots in the ring of edges.
pub(crate) const EDGES: usize = 64;
/// Slots in the recorder's queue at least.
const LEAST_ROWS: usize = 4096;
/// What the recorder's queue holds, seconds of ticks.
const QUEUED_S: f64 = 4.0;
/// Slots in the recorder's queue at the scene's rate, rounded up: looks, shapes and snapshots go with the ticks.
pub(crate) fn rows(params: &Params) -> usize {
    let ticks = params.ticks_in(QUEUED_S) as usize;
    ticks.next_power_of_two().max(LEAST_ROWS)
}
/// State snapshot buffers that go round.
pub(crate) const SNAPSHOTS: usize = 3;
/// Looks on their way: as many as a queue of so many rows can hold.
pub(crate) fn looks(rows: usize, every: u64) -> usize {
    rows / every.max(1) as usize + 1
}
/// Shapes for viewers on their way: a quarter of a second's. Where none is left, a frame is left out, and the next one is not.
pub(crate) const SHAPES: usize = 16;

/// Network to simulation: the newest pose and when it came.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PoseIn {
    pub datagram: PoseDatagram,
    /// Arrival, nanoseconds of the server's monotonic clock.
    pub arrived_ns: u64,
}

/// Network to simulation: must not be lost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Edge {
    Paused(bool),
    /// Newtons; 0: the scene's limit.
    ForceLimit(f32),
    /// A button went down; held buttons come with the poses.
    Pressed {
        tool: u8,
        button: u8,
    },
}

/// Simulation to network: a wrench whose epoch, sequence and hold time the network fills in.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct WrenchOut {
    pub datagram: WrenchDatagram,
    /// Arrival of the echoed pose, nanoseconds of the server's monotonic clock.
    pub pose_arrived_ns: u64,
}

/// An eventfd: rung by the simulation and the recorder, awaited by the network.
#[derive(Clone, Debug)]
pub(crate) struct Bell(Arc<OwnedFd>);

impl Bell {
    pub fn new() -> std::io::Result<Self> {
        Ok(Self(Arc::new(eventfd(
            0,
            EventfdFlags::NONBLOCK | EventfdFlags::CLOEXEC,
        )?)))
    }

    /// Wakes the other side. One small system call, never blocks.
    pub fn ring(&self) {
        // Fails only when 2^64 - 2 rings were never heard.
        let _ = rustix::io::write(&*self.0, &1u64.to_ne_bytes());
    }

    /// Forgets all rings so far.
    pub fn silence(&self) {
        // Empty already: nothing to forget.
        let _ = rustix::io::read(&*self.0, &mut [0u8; 8]);
    }

    /// For the network: becomes readable when rung. Needs a tokio runtime.
    pub fn listen(&self) -> std::io::Result<AsyncFd<OwnedFd>> {
        let descriptor = self.0.try_clone()?;
        // Readable only: an eventfd is always writable, which would wake the network for nothing.
        // SAFETY: the descriptor is open, and owned by the `AsyncFd` until that is dropped.
        unsafe { AsyncFd::register_with_interest(descriptor, Interest::READABLE) }
            .map_err(Into::into)
    }
}

/// Flags of one session.
#[derive(Debug, Default)]
pub(crate) struct Flags {
    /// Network to simulation: end.
    pub stop: AtomicBool,
    /// Recorder to network: writing failed, end the session.
    pub record_failed: AtomicBool,
    /// Simulation to network: the thread is leaving, asked or not.
    pub simulation_over: AtomicBool,
}

impl Flags {
    pub fn raise(flag: &AtomicBool) {
        flag.store(true, Ordering::Release);
    }
    pub fn is_up(flag: &AtomicBool) -> bool {
        flag.load(Ordering::Acquire)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_recorders_queue_holds_four_seconds_at_any_rate() {
        for (rate_hz, slots) in [(250, 4096), (1000, 4096), (2000, 8192), (8000, 32_768)] {
            let params = Params {
                rate_hz,
                ..Params::default()
            };
            assert_eq!(rows(&params), slots, "{rate_hz} Hz");
            assert!(slots >= 4 * usize::from(rate_hz));
            // A look every twentieth of a second, as the exercises need it.
            let every = params.ticks_in(0.05);
            assert!(looks(slots, every) >= 80, "{rate_hz} Hz");
        }
    }
}
