//! Scheduling on a system without real-time threads.

use std::io::{Error, ErrorKind};

/// Does nothing.
pub fn exact_timers() {}

/// Does nothing: this system has no capabilities of threads.
pub fn raise() {}

/// Fails: this system has no real-time threads.
///
/// # Errors
/// Always.
pub fn fifo(_priority: i32) -> std::io::Result<()> {
    Err(Error::new(
        ErrorKind::Unsupported,
        "this system has no real-time threads for programs",
    ))
}
