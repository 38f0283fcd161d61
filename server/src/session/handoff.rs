//! Hand-overs from thread to thread. Every one is wait-free for the simulation: triple buffers where the newest wins,
//! rings where nothing may be lost, atomic words for buttons (and for pause and force limit, in
//! [`crate::session::levels`]), one eventfd as the only wake-up.

use std::sync::atomic::{AtomicBool, AtomicU16, Ordering};

use sulcus_core::{MAX_TOOLS, Params};
use sulcus_proto::{PoseDatagram, WrenchDatagram};

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

/// Network to simulation: buttons that went down, a bit each; held buttons come with the poses. However many edges a
/// client sends, none takes the place of another.
#[derive(Debug, Default)]
pub(crate) struct Pressed([AtomicU16; MAX_TOOLS]);

impl Pressed {
    /// A button went down; tools and buttons that do not exist are ignored.
    pub fn press(&self, tool: u8, button: u8) {
        let bit = 1u16.checked_shl(u32::from(button)).unwrap_or(0);
        if let Some(buttons) = self.0.get(usize::from(tool)) {
            buttons.fetch_or(bit, Ordering::AcqRel);
        }
    }

    /// Buttons that went down since the last call, for each tool.
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
            // A look every twentieth of a second, as the exercises need it.
            let every = params.ticks_in(0.05);
            assert!(looks(slots, every) >= 80, "{rate_hz} Hz");
        }
    }
}
