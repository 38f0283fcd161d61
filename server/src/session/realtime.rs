//! Real-time scheduling of the simulation thread.

use std::sync::Once;

use sulcus_link::schedule::{exact_timers, fifo};

/// Priority of the simulation thread among SCHED_FIFO ones.
const PRIORITY: i32 = 50;

/// Requests SCHED_FIFO, exact timers and locked memory for the calling thread. The lock covers the memory mapped so
/// far.
///
/// A missing right causes one warning in a process, and the thread runs without it.
pub(crate) fn enter() {
    static SCHEDULE: Once = Once::new();
    static MEMORY: Once = Once::new();
    if let Err(error) = fifo(PRIORITY) {
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
    exact_timers();
}
