//! The clock of the stand-ins: the kernel's monotonic clock, the same in every process.

use rustix::thread::clock_nanosleep_absolute;
use rustix::time::{ClockId, Timespec, clock_gettime};

/// Nanoseconds in a millisecond.
pub const MS: u64 = 1_000_000;

/// Nanoseconds in a microsecond.
pub const US: u64 = 1_000;

/// Time of the monotonic clock in ns.
pub fn now_ns() -> u64 {
    let t = clock_gettime(ClockId::Monotonic);
    t.tv_sec as u64 * 1_000_000_000 + t.tv_nsec as u64
}

/// Sleeps until the monotonic clock shows `at`, in ns. A time in the past returns at once.
pub fn sleep_until(at: u64) {
    let at = Timespec {
        tv_sec: (at / 1_000_000_000) as i64,
        tv_nsec: (at % 1_000_000_000) as i64,
    };
    while clock_nanosleep_absolute(rustix::thread::ClockId::Monotonic, &at).is_err() {}
}

/// Asks for short timer slack and the real-time class at `priority`. Returns false where the system refuses the class.
pub fn make_realtime(priority: i32) -> bool {
    // SAFETY: prctl with these arguments changes the calling thread's timer slack alone.
    unsafe { libc::prctl(libc::PR_SET_TIMERSLACK, 1_000 as libc::c_ulong, 0, 0, 0) };
    let param = libc::sched_param {
        sched_priority: priority,
    };
    // SAFETY: `param` is valid for the call; thread id 0 is the calling thread.
    unsafe { libc::sched_setscheduler(0, libc::SCHED_FIFO, &param) == 0 }
}
