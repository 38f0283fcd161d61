//! Bell of systems without an eventfd.

use std::sync::Arc;

use tokio::sync::Notify;

/// A notification of tokio: rung by any thread, awaited by a tokio task.
#[derive(Clone, Debug)]
pub struct Bell(Arc<Notify>);

/// Listener of a [`Bell`].
#[derive(Debug)]
pub struct Listening(Arc<Notify>);

// The signatures are those of Linux, where both calls need a descriptor.
#[allow(clippy::unnecessary_wraps)]
impl Bell {
    /// Opens a silent bell.
    ///
    /// # Errors
    /// None at present.
    pub fn new() -> std::io::Result<Self> {
        Ok(Self(Arc::default()))
    }

    /// Wakes the listener. The call can wait for a lock that the listener holds for an instant.
    pub fn ring(&self) {
        self.0.notify_one();
    }

    /// Returns a listener, which the next ring wakes.
    ///
    /// # Errors
    /// None at present.
    pub fn listen(&self) -> std::io::Result<Listening> {
        Ok(Listening(self.0.clone()))
    }
}

impl Listening {
    /// Waits for a ring, and clears all rings so far. A cancelled call loses no ring.
    pub async fn rung(&mut self) {
        self.0.notified().await;
    }
}
