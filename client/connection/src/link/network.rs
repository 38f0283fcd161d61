//! The thread that carries the packets of links.

use std::thread::JoinHandle;

use sulcus_link::schedule::fifo;
use tokio::runtime::Handle;
use tokio::sync::oneshot;

use super::LinkError;

/// SCHED_FIFO priority of the thread, above that of the device's thread: a packet takes some microseconds.
const PRIORITY: i32 = 46;

/// A thread with a current-thread runtime. Several links may share it: their packets then cost fewer wake-ups. The
/// thread ends when the last holder drops it.
pub struct Network {
    handle: Handle,
    stop: Option<oneshot::Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Network {
    /// Starts the thread.
    ///
    /// # Errors
    /// The system has no thread or no descriptor left.
    pub fn start() -> Result<Self, LinkError> {
        Self::start_at(PRIORITY)
    }

    /// Starts the thread with a SCHED_FIFO priority, 1 to 99.
    ///
    /// # Errors
    /// The system has no thread or no descriptor left.
    pub fn start_at(priority: i32) -> Result<Self, LinkError> {
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()?;
        let handle = runtime.handle().clone();
        let (stop, stopped) = oneshot::channel::<()>();
        let thread = std::thread::Builder::new()
            .name("sulcus-link".into())
            .spawn(move || {
                if let Err(error) = fifo(priority) {
                    tracing::debug!("no real-time scheduling for the link: {error}");
                }
                // An error means that the sender was dropped.
                let _ = runtime.block_on(stopped);
            })?;
        Ok(Self {
            handle,
            stop: Some(stop),
            thread: Some(thread),
        })
    }

    /// Runs a task on the thread.
    pub(super) fn spawn(&self, task: impl Future<Output = ()> + Send + 'static) {
        self.handle.spawn(task);
    }
}

impl Drop for Network {
    fn drop(&mut self) {
        drop(self.stop.take());
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}
