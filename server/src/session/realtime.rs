//! Clocks, absolute sleep, and what a real-time thread asks of the system.

use std::num::NonZeroU64;
use std::sync::Once;

use rustix::thread::{ClockId, clock_nanosleep_absolute};
use rustix::time::{ClockId as Clock, Timespec, clock_gettime};

/// Priority of the simulation thread among SCHED_FIFO ones.
const PRIORITY: libc::c_int = 50;
const NS_PER_S: u64 = 1_000_000_000;

/// CLOCK_MONOTONIC, nanoseconds: the one clock for deadlines, ages and device times.
pub fn monotonic_ns() -> u64 {
    nanoseconds(clock_gettime(Clock::Monotonic))
}

/// CPU time used by the calling thread, nanoseconds.
pub(crate) fn thread_cpu_ns() -> u64 {
    nanoseconds(clock_gettime(Clock::ThreadCPUTime))
}

/// Time since 1970, nanoseconds, UTC.
pub(crate) fn unix_ns() -> u64 {
    nanoseconds(clock_gettime(Clock::Realtime))
}

/// Sleeps until CLOCK_MONOTONIC reads `deadline_ns`; returns at once when that is past.
pub(crate) fn sleep_until(deadline_ns: u64) {
    let deadline = Timespec {
        tv_sec: (deadline_ns / NS_PER_S) as i64,
        tv_nsec: (deadline_ns % NS_PER_S) as i64,
    };
    // Only a signal ends it early; nothing else can fail with a valid clock and time.
    while clock_nanosleep_absolute(ClockId::Monotonic, &deadline) == Err(rustix::io::Errno::INTR) {}
}

fn nanoseconds(time: Timespec) -> u64 {
    (time.tv_sec.max(0) as u64) * NS_PER_S + time.tv_nsec.max(0) as u64
}

/// Makes the calling thread as punctual as the system permits: SCHED_FIFO, exact timers, memory that
/// is never paged out. What is not permitted is said once per process and done without.
pub(crate) fn enter() {
    static SCHEDULE: Once = Once::new();
    static MEMORY: Once = Once::new();
    if let Err(error) = fifo() {
        SCHEDULE.call_once(|| {
            tracing::warn!(
                "no real-time scheduling ({error}): ticks will be late under load; \
                 grant CAP_SYS_NICE or raise `ulimit -r` to {PRIORITY}"
            );
        });
    }
    // What is mapped now, not what will be: future mappings of the process are none of our business.
    if let Err(error) = rustix::mm::mlockall(rustix::mm::MlockAllFlags::CURRENT) {
        MEMORY.call_once(|| {
            tracing::warn!(
                "memory is not locked ({error}): paging may delay ticks; raise `ulimit -l`"
            );
        });
    }
    exact_timers();
}

/// Timers of this thread fire within a nanosecond of their time instead of 50 us (matters without
/// SCHED_FIFO only, costs nothing).
pub(crate) fn exact_timers() {
    if let Some(slack) = NonZeroU64::new(1) {
        // Without it timers are up to 50 us late: no reason to stop.
        let _ = rustix::thread::set_current_timer_slack(Some(slack));
    }
}

fn fifo() -> std::io::Result<()> {
    let parameters = libc::sched_param {
        sched_priority: PRIORITY,
    };
    // SAFETY: plain system call on the calling thread (0) with a valid, initialised struct.
    let result = unsafe {
        libc::sched_setscheduler(0, libc::SCHED_FIFO | libc::SCHED_RESET_ON_FORK, &parameters)
    };
    if result == 0 {
        Ok(())
    } else {
        Err(std::io::Error::last_os_error())
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
}
