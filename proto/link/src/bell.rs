//! Wake-up of a network thread by a real-time thread.

use std::os::fd::OwnedFd;
use std::sync::Arc;

use rustix::event::{EventfdFlags, eventfd};
use tokio::io::Interest;
use tokio::io::unix::AsyncFd;

/// An eventfd: rung by any thread, awaited by a tokio task.
#[derive(Clone, Debug)]
pub struct Bell(Arc<OwnedFd>);

impl Bell {
    /// Opens a silent bell.
    ///
    /// # Errors
    /// The process has no descriptor left.
    pub fn new() -> std::io::Result<Self> {
        Ok(Self(Arc::new(eventfd(
            0,
            EventfdFlags::NONBLOCK | EventfdFlags::CLOEXEC,
        )?)))
    }

    /// Wakes the listener by one system call, which never blocks.
    pub fn ring(&self) {
        // Fails after 2^64 - 2 unread rings only.
        let _ = rustix::io::write(&*self.0, &1u64.to_ne_bytes());
    }

    /// Clears all rings so far.
    pub fn silence(&self) {
        // An error means that the counter is zero already.
        let _ = rustix::io::read(&*self.0, &mut [0u8; 8]);
    }

    /// Returns a descriptor that becomes readable with the next ring. Needs a tokio runtime.
    ///
    /// # Errors
    /// The process has no descriptor left.
    pub fn listen(&self) -> std::io::Result<AsyncFd<OwnedFd>> {
        let descriptor = self.0.try_clone()?;
        // Readable only: an eventfd is always writable, which would wake the task for nothing.
        // SAFETY: the descriptor is open, and owned by the `AsyncFd` until that is dropped.
        unsafe { AsyncFd::register_with_interest(descriptor, Interest::READABLE) }
            .map_err(Into::into)
    }
}
