//! Clocks of the system and the absolute sleep. Every deadline, age and device time is of the monotonic clock.
//!
//! Systems other than Linux have no absolute sleep and no common clock for the CPU time of a thread: the sleep is as
//! exact as that of the standard library, and the CPU time is the monotonic time.

use std::time::SystemTime;

#[cfg(target_os = "linux")]
mod linux;
#[cfg(any(test, not(target_os = "linux")))]
mod portable;

#[cfg(target_os = "linux")]
pub use linux::{monotonic_ns, sleep_until, thread_cpu_ns};
#[cfg(not(target_os = "linux"))]
pub use portable::{monotonic_ns, sleep_until, thread_cpu_ns};

/// Time since 1970, UTC, nanoseconds; 0 for a clock before 1970.
///
/// The time is that of the standard library, which the tests of a wrong clock can shift.
pub fn unix_ns() -> u64 {
    let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH);
    since.map_or(0, |since| {
        u64::try_from(since.as_nanos()).unwrap_or(u64::MAX)
    })
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
}
