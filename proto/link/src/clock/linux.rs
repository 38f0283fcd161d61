//! Clocks of Linux.

use rustix::thread::{ClockId, clock_nanosleep_absolute};
use rustix::time::{ClockId as Clock, Timespec, clock_gettime};

const NS_PER_S: u64 = 1_000_000_000;

/// CLOCK_MONOTONIC, nanoseconds.
pub fn monotonic_ns() -> u64 {
    nanoseconds(clock_gettime(Clock::Monotonic))
}

/// CPU time of the calling thread, nanoseconds.
pub fn thread_cpu_ns() -> u64 {
    nanoseconds(clock_gettime(Clock::ThreadCPUTime))
}

/// Sleeps until CLOCK_MONOTONIC reads `deadline_ns`. Returns at once for a deadline in the past.
pub fn sleep_until(deadline_ns: u64) {
    let deadline = Timespec {
        tv_sec: (deadline_ns / NS_PER_S) as i64,
        tv_nsec: (deadline_ns % NS_PER_S) as i64,
    };
    // Only a signal ends the sleep early: clock and time are valid.
    while clock_nanosleep_absolute(ClockId::Monotonic, &deadline) == Err(rustix::io::Errno::INTR) {}
}

fn nanoseconds(time: Timespec) -> u64 {
    (time.tv_sec.max(0) as u64) * NS_PER_S + time.tv_nsec.max(0) as u64
}
