//! Real-time scheduling of the simulation thread.

use std::sync::Once;

use sulcus_link::schedule::fifo;

/// SCHED_FIFO priority of the simulation threads and of the network thread: threads of one priority wait in one queue.
/// A network above the simulations would interrupt another station's tick for every wrench. A network below them would
/// not run on full cores: without wrenches the clients let go every hand.
pub(crate) const PRIORITY: i32 = 50;

/// Requests SCHED_FIFO and locked memory for the calling thread. The lock covers the memory mapped so
/// far.
///
/// A missing right causes one warning in a process, and the thread runs without it. Returns whether the thread is a
/// SCHED_FIFO one.
pub(crate) fn enter() -> bool {
    static SCHEDULE: Once = Once::new();
    static MEMORY: Once = Once::new();
    let scheduled = fifo(PRIORITY);
    if let Err(error) = &scheduled {
        SCHEDULE.call_once(|| {
            tracing::warn!(
                "no real-time scheduling ({error}): more ticks are missed under load; \
                 grant CAP_SYS_NICE or set `ulimit -r {PRIORITY}`"
            );
        });
    }
    // A lock of future mappings would also affect the other threads.
    if let Err(error) = rustix::mm::mlockall(rustix::mm::MlockAllFlags::CURRENT) {
        MEMORY.call_once(|| {
            tracing::warn!(
                "memory is not locked ({error}): paging may delay ticks; \
                 grant CAP_IPC_LOCK or set `ulimit -l unlimited`"
            );
        });
    }
    scheduled.is_ok()
}
