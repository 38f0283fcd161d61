//! Clock that its owner sets.

use std::sync::atomic::{AtomicU64, Ordering};

/// Times of a simulated machine. They stand still until the owner moves them.
#[derive(Debug, Default)]
pub struct SetClock {
    /// Monotonic time, nanoseconds.
    monotonic_ns: AtomicU64,
    /// Time since 1970 at the monotonic time 0, nanoseconds.
    unix_at_zero_ns: AtomicU64,
    /// CPU time, nanoseconds.
    cpu_ns: AtomicU64,
}

impl SetClock {
    /// Clock at the monotonic time `ns` without any CPU time, on a machine whose monotonic time 0 was `unix_at_zero_ns`
    /// after 1970.
    pub fn new(ns: u64, unix_at_zero_ns: u64) -> Self {
        Self {
            monotonic_ns: AtomicU64::new(ns),
            unix_at_zero_ns: AtomicU64::new(unix_at_zero_ns),
            cpu_ns: AtomicU64::new(0),
        }
    }

    /// Monotonic time, nanoseconds.
    pub fn monotonic_ns(&self) -> u64 {
        self.monotonic_ns.load(Ordering::Acquire)
    }

    /// Time since 1970, UTC, nanoseconds: moves with the monotonic time.
    pub fn unix_ns(&self) -> u64 {
        let at_zero_ns = self.unix_at_zero_ns.load(Ordering::Acquire);
        at_zero_ns.saturating_add(self.monotonic_ns())
    }

    /// CPU time, nanoseconds, the same for all threads.
    pub fn cpu_ns(&self) -> u64 {
        self.cpu_ns.load(Ordering::Acquire)
    }

    /// Moves the monotonic time to `ns`, and the time since 1970 by as much. A time before the present one is ignored:
    /// the clock is monotonic.
    pub fn set_ns(&self, ns: u64) {
        self.monotonic_ns.fetch_max(ns, Ordering::AcqRel);
    }

    /// Sets the date of the machine: the time since 1970 at the monotonic time 0, nanoseconds.
    pub fn set_unix_at_zero_ns(&self, unix_at_zero_ns: u64) {
        self.unix_at_zero_ns
            .store(unix_at_zero_ns, Ordering::Release);
    }

    /// Adds to the CPU time, nanoseconds.
    pub fn spend_cpu_ns(&self, ns: u64) {
        self.cpu_ns.fetch_add(ns, Ordering::AcqRel);
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::clock::Clock;

    #[test]
    fn a_set_clock_stands_until_its_owner_moves_it() {
        let set = Arc::new(SetClock::new(5, 1_000));
        let clock = Clock::Set(set.clone());
        let times = || (clock.monotonic_ns(), clock.unix_ns(), clock.thread_cpu_ns());
        assert_eq!(times(), (5, 1_005, 0));
        assert_eq!(times(), (5, 1_005, 0));
        set.set_ns(20);
        set.spend_cpu_ns(3);
        assert_eq!(times(), (20, 1_020, 3));
        set.set_unix_at_zero_ns(7);
        set.spend_cpu_ns(3);
        assert_eq!(times(), (20, 27, 6));
        // Never back.
        set.set_ns(19);
        assert_eq!(times(), (20, 27, 6));
    }
}
