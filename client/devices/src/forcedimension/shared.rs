//! What the thread of a device tells the supervising thread: atomics alone.

use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64};

/// State of one device.
#[derive(Debug, Default)]
pub struct HandState {
    /// Number of the mode, [`super::errors::Mode`].
    pub mode: AtomicU32,
    /// Number of periods.
    pub periods: AtomicU64,
    /// Number of commands that the motors could not follow.
    pub saturated: AtomicU64,
    /// Newest error of the library; 0 for none.
    pub error: AtomicU32,
    /// Number of errors.
    pub errors: AtomicU64,
    /// Number of gaps between commands in which the controller may have taken a force off.
    pub gaps: AtomicU32,
    /// Whether the device is open.
    pub is_open: AtomicBool,
    /// Whether the thread has ended by a panic.
    pub has_failed: AtomicBool,
}
