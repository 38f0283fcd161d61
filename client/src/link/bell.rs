//! An eventfd by which the device's thread wakes the link's thread.

use std::os::fd::OwnedFd;
use std::sync::Arc;

use rustix::event::{EventfdFlags, eventfd};
use tokio::io::Interest;
use tokio::io::unix::AsyncFd;

#[derive(Clone, Debug)]
pub(super) struct Bell(Arc<OwnedFd>);

impl Bell {
    pub fn new() -> std::io::Result<Self> {
        Ok(Self(Arc::new(eventfd(
            0,
            EventfdFlags::NONBLOCK | EventfdFlags::CLOEXEC,
        )?)))
    }

    /// Wakes the other side. One small system call, never blocks.
    pub fn ring(&self) {
        // Fails only when 2^64 - 2 rings were never heard.
        let _ = rustix::io::write(&*self.0, &1u64.to_ne_bytes());
    }

    /// Forgets all rings so far.
    pub fn silence(&self) {
        // Empty already: nothing to forget.
        let _ = rustix::io::read(&*self.0, &mut [0u8; 8]);
    }

    /// Becomes readable when rung. Needs a tokio runtime.
    pub fn listen(&self) -> std::io::Result<AsyncFd<OwnedFd>> {
        let descriptor = self.0.try_clone()?;
        // Readable only: an eventfd is always writable, which would wake the thread for nothing.
        // SAFETY: the descriptor is open, and owned by the `AsyncFd` until that is dropped.
        unsafe { AsyncFd::register_with_interest(descriptor, Interest::READABLE) }
            .map_err(Into::into)
    }
}
