//! Scheduling on Windows.

use windows_sys::Win32::System::Threading::{
    GetCurrentThread, SetThreadPriority, THREAD_PRIORITY_TIME_CRITICAL,
};

/// Does nothing: the sleep of the standard library has timers of high resolution.
pub fn exact_timers() {}

/// Does nothing: this system has no capabilities of threads.
pub fn raise() {}

/// Gives the calling thread the priority "time critical". Windows has no finer order of `priority`.
///
/// # Errors
/// The system refuses the priority.
pub fn fifo(_priority: i32) -> std::io::Result<()> {
    // SAFETY: the pseudo handle of the calling thread is always valid.
    let done = unsafe { SetThreadPriority(GetCurrentThread(), THREAD_PRIORITY_TIME_CRITICAL) };
    if done == 0 {
        Err(std::io::Error::last_os_error())
    } else {
        Ok(())
    }
}
