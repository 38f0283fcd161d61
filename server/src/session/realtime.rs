//! Real-time scheduling of the simulation thread.

use std::sync::Once;

use sulcus_link::schedule::{exact_timers, fifo};

/// Priority of the simulation thread among SCHED_FIFO ones.
const PRIORITY: i32 = 50;

/// Makes the calling thread as punctual as the system permits: SCHED_FIFO, exact timers, memory that
/// is never paged out. What is not permitted is said once per process and done without.
pub(crate) fn enter() {
    static SCHEDULE: Once = Once::new();
    static MEMORY: Once = Once::new();
    if let Err(error) = fifo(PRIORITY) {
        SCHEDULE.call_once(|| {
            tracing::warn!(
                "no real-time scheduling ({error}): ticks will be late under load; \
                 grant CAP_SYS_NICE or raise `ulimit -r` to {PRIORITY}"
            );
        });
    }
    // What is mapped now, not what will be: future mappings of the process are none of our business.
    if let Err(error) = rustix::mm::mlockall(rustix::mm::MlockAllFlags::CURRENT) {
        MEMORY.call_once(|| {
            tracing::warn!(
                "memory is not locked ({error}): paging may delay ticks; raise `ulimit -l`"
            );
        });
    }
    exact_timers();
}
