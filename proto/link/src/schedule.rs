//! Scheduling of a real-time thread.

use std::num::NonZeroU64;

/// Sets the timer slack of the calling thread to 1 ns instead of 50 us. The slack has no effect under SCHED_FIFO.
pub fn exact_timers() {
    if let Some(slack) = NonZeroU64::new(1) {
        // Without it timers are up to 50 us late: no reason to stop.
        let _ = rustix::thread::set_current_timer_slack(Some(slack));
    }
}

/// Moves the calling thread to SCHED_FIFO at `priority` (1 to 99). Child processes do not inherit it.
///
/// # Errors
/// The process may not schedule real-time threads: no CAP_SYS_NICE, or RLIMIT_RTPRIO below `priority`.
pub fn fifo(priority: i32) -> std::io::Result<()> {
    let parameters = libc::sched_param {
        sched_priority: priority,
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

/// Whether threads of this process may have real-time priority. The question is put on a thread that ends at once.
pub fn may_fifo() -> bool {
    std::thread::spawn(|| fifo(1).is_ok())
        .join()
        .unwrap_or(false)
}
