//! Bell on Linux: an eventfd.

use std::os::fd::OwnedFd;
use std::sync::Arc;

use rustix::event::{EventfdFlags, eventfd};
use tokio::io::Interest;
use tokio::io::unix::AsyncFd;

/// An eventfd: rung by any thread, awaited by a tokio task.
#[derive(Clone, Debug)]
pub struct Bell(Arc<OwnedFd>);

/// Listener of a [`Bell`].
#[derive(Debug)]
pub struct Listening(AsyncFd<OwnedFd>);

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

    /// Returns a listener, which the next ring wakes. Needs a tokio runtime.
    ///
    /// # Errors
    /// The process has no descriptor left.
    pub fn listen(&self) -> std::io::Result<Listening> {
        let descriptor = self.0.try_clone()?;
        // Readable only: an eventfd is always writable, which would wake the task for nothing.
        // SAFETY: the descriptor is open, and owned by the `AsyncFd` until that is dropped.
        let descriptor =
            unsafe { AsyncFd::register_with_interest(descriptor, Interest::READABLE) }?;
        Ok(Listening(descriptor))
    }
}

impl Listening {
    /// Waits for a ring, and clears all rings so far. A cancelled call loses no ring.
    pub async fn rung(&mut self) {
        if let Ok(mut ready) = self.0.readable().await {
            // An error means that the counter is zero already.
            let _ = rustix::io::read(self.0.get_ref(), &mut [0u8; 8]);
            ready.clear_ready();
        }
    }
}
