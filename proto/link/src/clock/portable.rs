//! Clocks by the standard library.

use std::sync::OnceLock;
use std::time::{Duration, Instant};

/// Monotonic time since the first call in this process, nanoseconds.
pub fn monotonic_ns() -> u64 {
    static BEGAN: OnceLock<Instant> = OnceLock::new();
    nanoseconds(BEGAN.get_or_init(Instant::now).elapsed())
}

/// Monotonic time, nanoseconds, in place of the CPU time of the calling thread. A busy machine makes it larger.
pub fn thread_cpu_ns() -> u64 {
    monotonic_ns()
}

/// Sleeps until [`monotonic_ns`] reads `deadline_ns`. Returns at once for a deadline in the past.
pub fn sleep_until(deadline_ns: u64) {
    loop {
        let left = deadline_ns.saturating_sub(monotonic_ns());
        if left == 0 {
            return;
        }
        std::thread::sleep(Duration::from_nanos(left));
    }
}

fn nanoseconds(time: Duration) -> u64 {
    u64::try_from(time.as_nanos()).unwrap_or(u64::MAX)
}
