//! Hand-overs between threads, each wait-free for the simulation.
//!
//! Triple buffers carry poses and wrenches: the newest wins. Rings carry rows and buffers: a full ring drops the new
//! entry, and dropped rows are counted. Atomic words hold buttons, and in [`crate::session::levels`] pause and force
//! limit. One eventfd wakes the network.

use std::sync::atomic::{AtomicBool, AtomicU8, AtomicU16, AtomicU32, AtomicU64, Ordering};

use sulcus_core::{MAX_TOOLS, Params};
use sulcus_proto::{PoseDatagram, WrenchDatagram};
use sulcus_sessions::Detached;

/// Smallest number of slots in the recorder's queue.
const LEAST_ROWS: usize = 4096;
/// Length of the recorder's queue, seconds of ticks.
const QUEUED_S: f64 = 4.0;
/// Number of slots in the recorder's queue at the scene's rate: four seconds of ticks, rounded up to a power of two.
/// Looks, shapes and snapshots take slots of the same queue.
pub(crate) fn rows(params: &Params) -> usize {
    let ticks = params.ticks_in(QUEUED_S) as usize;
    ticks.next_power_of_two().max(LEAST_ROWS)
}
/// Number of buffers for state snapshots.
pub(crate) const SNAPSHOTS: usize = 3;
/// Number of buffers for looks: one for every `every`-th of `rows` ticks, and one more.
pub(crate) fn looks(rows: usize, every: u64) -> usize {
    rows / every.max(1) as usize + 1
}
/// Number of buffers for the shapes of viewers: a quarter of a second at 62.5 frames a second. Without a free buffer
/// one frame is skipped.
pub(crate) const SHAPES: usize = 16;

/// Network to simulation: the newest pose and its arrival.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PoseIn {
    pub datagram: PoseDatagram,
    /// Arrival, nanoseconds of the server's monotonic clock.
    pub arrived_ns: u64,
}

/// Network to simulation: buttons pressed since the last tick, one bit for each. A pose carries the held buttons.
///
/// No press replaces that of another button. Several presses of one button within a tick count once.
#[derive(Debug, Default)]
pub(crate) struct Pressed([AtomicU16; MAX_TOOLS]);

impl Pressed {
    /// Sets the bit of a pressed button. Unknown tools and buttons are ignored.
    pub fn press(&self, tool: u8, button: u8) {
        let bit = 1u16.checked_shl(u32::from(button)).unwrap_or(0);
        if let Some(buttons) = self.0.get(usize::from(tool)) {
            buttons.fetch_or(bit, Ordering::AcqRel);
        }
    }

    /// Takes the buttons pressed since the last call, for each tool.
    pub fn take(&self) -> [u16; MAX_TOOLS] {
        std::array::from_fn(|tool| self.0[tool].swap(0, Ordering::AcqRel))
    }
}

/// Simulation to network: a wrench whose epoch, sequence and hold time the network fills in.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct WrenchOut {
    pub datagram: WrenchDatagram,
    /// Arrival of the echoed pose, nanoseconds of the server's monotonic clock.
    pub pose_arrived_ns: u64,
}

/// Progress of the simulation, for threads that are no real-time threads.
#[derive(Debug, Default)]
pub(crate) struct Progress {
    /// Newest tick.
    pub tick: AtomicU64,
    /// Number of commands of the station's side that the newest tick obeyed.
    pub commands: AtomicU64,
    /// First tick that obeyed that number of commands.
    pub since: AtomicU64,
}

/// Attachment of the student, from the station to the recorder.
#[derive(Debug, Default)]
pub(crate) struct Attachment {
    /// Epoch of the newest connection.
    pub epoch: AtomicU32,
    /// Reason of the newest gap: index in [`Detached::ALL`].
    pub reason: AtomicU8,
}

impl Attachment {
    /// Sets the reason of a gap that begins.
    pub fn gone(&self, reason: Detached) {
        let index = Detached::ALL.iter().position(|one| *one == reason);
        self.reason
            .store(index.unwrap_or(0) as u8, Ordering::Release);
    }

    /// Reason of the newest gap.
    pub fn reason(&self) -> Detached {
        let index = usize::from(self.reason.load(Ordering::Acquire));
        Detached::ALL
            .get(index)
            .copied()
            .unwrap_or(Detached::Station)
    }
}

/// Fault that a test provokes in a thread or a task of a station.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[doc(hidden)]
pub enum Provoked {
    /// Panic of the simulation.
    Simulation = 1,
    /// Panic of the recorder.
    Recorder = 2,
    /// Panic of the task of the student's connection.
    Connection = 3,
    /// Panic of the task of the station.
    Station = 4,
}

/// Flags of one session.
#[derive(Debug, Default)]
pub(crate) struct Flags {
    /// Network to simulation: the session ends.
    pub stop: AtomicBool,
    /// Recorder to network: writing failed or the recorder panicked, so the session must end.
    pub record_failed: AtomicBool,
    /// Ticks at the hand to station: they differ from the server's, or broke a rule.
    pub diverged: AtomicBool,
    /// Simulation to network: the thread ends, by request or by a panic.
    pub simulation_over: AtomicBool,
    /// Fault that a test asks for; 0 for none.
    pub provoked: AtomicU8,
}

impl Flags {
    pub fn raise(flag: &AtomicBool) {
        flag.store(true, Ordering::Release);
    }
    pub fn is_up(flag: &AtomicBool) -> bool {
        flag.load(Ordering::Acquire)
    }

    /// Panics once if a test has asked for this fault. A connection that returns must find a sound session.
    pub fn provoke(&self, fault: Provoked) {
        let asked =
            self.provoked
                .compare_exchange(fault as u8, 0, Ordering::Relaxed, Ordering::Relaxed);
        if asked.is_ok() {
            panic!("a fault that a test provokes: {fault:?}");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn presses_are_taken_once_and_unknown_buttons_are_ignored() {
        let pressed = Pressed::default();
        for (tool, button) in [(0, 3), (1, 15), (0, 0), (0, 3), (0, 16), (2, 1), (255, 255)] {
            pressed.press(tool, button);
        }
        assert_eq!(pressed.take(), [0b1001, 0x8000]);
        assert_eq!(pressed.take(), [0, 0]);
    }

    #[test]
    fn the_recorders_queue_holds_four_seconds_at_any_rate() {
        for (rate_hz, slots) in [(250, 4096), (1000, 4096), (2000, 8192), (8000, 32_768)] {
            let params = Params {
                rate_hz,
                ..Params::default()
            };
            assert_eq!(rows(&params), slots, "{rate_hz} Hz");
            assert!(slots >= 4 * usize::from(rate_hz));
            // One look in a twentieth of a second, as the exercises need.
            let every = params.ticks_in(0.05);
            assert!(looks(slots, every) >= 80, "{rate_hz} Hz");
        }
    }
}
