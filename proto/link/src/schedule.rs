//! Scheduling of a real-time thread.
//!
//! Linux has SCHED_FIFO, Windows the priority "time critical". Other systems have neither here: their threads are late
//! on a busy machine.

#[cfg(target_os = "linux")]
mod linux;
#[cfg(not(any(target_os = "linux", windows)))]
mod none;
#[cfg(windows)]
mod windows;

#[cfg(target_os = "linux")]
pub use linux::{exact_timers, fifo, raise};
#[cfg(not(any(target_os = "linux", windows)))]
pub use none::{exact_timers, fifo, raise};
#[cfg(windows)]
pub use windows::{exact_timers, fifo, raise};

/// Whether threads of this process may have real-time priority. The question is put on a thread that ends at once.
pub fn may_fifo() -> bool {
    std::thread::spawn(|| fifo(1).is_ok())
        .join()
        .unwrap_or(false)
}
