//! Clocks of the system and the absolute sleep. Every deadline, age and device time is of the monotonic clock.
//!
//! Systems other than Linux have no absolute sleep and no common clock for the CPU time of a thread: the sleep is as
//! exact as that of the standard library, and the CPU time is the monotonic time.
//!
//! A loop that a simulator steps reads its times from a [`Clock`], which its owner can set.

use std::sync::Arc;
use std::time::SystemTime;

#[cfg(target_os = "linux")]
mod linux;
#[cfg(any(test, not(target_os = "linux")))]
mod portable;
mod set;

#[cfg(target_os = "linux")]
pub use linux::{monotonic_ns, sleep_until, thread_cpu_ns};
#[cfg(not(target_os = "linux"))]
pub use portable::{monotonic_ns, sleep_until, thread_cpu_ns};
pub use set::SetClock;

/// Time since 1970, UTC, nanoseconds; 0 for a clock before 1970.
///
/// The time is that of the standard library, which the tests of a wrong clock can shift.
pub fn unix_ns() -> u64 {
    let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH);
    since.map_or(0, |since| {
        u64::try_from(since.as_nanos()).unwrap_or(u64::MAX)
    })
}

/// Source of the times of a loop. Clones of a set clock share its times.
#[derive(Clone, Debug, Default)]
pub enum Clock {
    /// Clocks of the system.
    #[default]
    System,
    /// Times that the owner of the loop sets.
    Set(Arc<SetClock>),
}

impl Clock {
    /// Monotonic time, nanoseconds.
    pub fn monotonic_ns(&self) -> u64 {
        match self {
            Self::System => monotonic_ns(),
            Self::Set(clock) => clock.monotonic_ns(),
        }
    }

    /// Time since 1970, UTC, nanoseconds.
    pub fn unix_ns(&self) -> u64 {
        match self {
            Self::System => unix_ns(),
            Self::Set(clock) => clock.unix_ns(),
        }
    }

    /// CPU time of the calling thread, nanoseconds.
    pub fn thread_cpu_ns(&self) -> u64 {
        match self {
            Self::System => thread_cpu_ns(),
            Self::Set(clock) => clock.cpu_ns(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sleep_never_ends_early() {
        let deadline = monotonic_ns() + 2_000_000;
        sleep_until(deadline);
        assert!(monotonic_ns() >= deadline);
        sleep_until(0);
    }

    #[test]
    fn the_portable_clock_keeps_the_same_promises() {
        let deadline = portable::monotonic_ns() + 2_000_000;
        portable::sleep_until(deadline);
        assert!(portable::monotonic_ns() >= deadline);
        portable::sleep_until(0);
        let before = portable::thread_cpu_ns();
        assert!(portable::thread_cpu_ns() >= before);
    }

    #[test]
    fn a_clock_of_the_system_reads_the_systems_clocks() {
        let clock = Clock::default();
        let (before, unix_before, cpu_before) = (monotonic_ns(), unix_ns(), thread_cpu_ns());
        assert!(clock.monotonic_ns() >= before);
        // The system's date may be set back by a moment at any time.
        assert!(clock.unix_ns().abs_diff(unix_before) < 60_000_000_000);
        assert!(clock.thread_cpu_ns() >= cpu_before);
    }
}
