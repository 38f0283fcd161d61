//! Scheduling on Linux.

use std::num::NonZeroU64;

use rustix::thread::{CapabilitySet, CapabilitySets, capabilities, set_capabilities};

/// Sets the timer slack of the calling thread to 1 ns instead of 50 us. The slack has no effect under SCHED_FIFO.
pub fn exact_timers() {
    if let Some(slack) = NonZeroU64::new(1) {
        // Without it timers are up to 50 us late: no reason to stop.
        let _ = rustix::thread::set_current_timer_slack(Some(slack));
    }
}

/// Moves the calling thread to SCHED_FIFO at `priority` (1 to 99), by its permitted capabilities: see [`raise`]. Child
/// processes do not inherit it.
///
/// # Errors
/// The process may not schedule real-time threads: no CAP_SYS_NICE, or RLIMIT_RTPRIO below `priority`.
pub fn fifo(priority: i32) -> std::io::Result<()> {
    raise();
    let parameters = libc::sched_param {
        sched_priority: priority,
    };
    // SAFETY: plain system call on the calling thread (0) with a valid, initialised struct.
    let result = unsafe {
        libc::sched_setscheduler(0, libc::SCHED_FIFO | libc::SCHED_RESET_ON_FORK, &parameters)
    };
    if result == 0 {
        Ok(())
    } else {
        Err(std::io::Error::last_os_error())
    }
}

/// Makes the permitted capabilities for scheduling and locked memory effective in the calling thread.
///
/// The program file in the image has these capabilities as permitted ones alone, so that the program also starts where
/// a container's runtime withholds them. `ulimit` serves without any capability.
pub fn raise() {
    let Ok(mut sets) = capabilities(None) else {
        return;
    };
    let missing = missing(&sets);
    if missing.is_empty() {
        return;
    }
    sets.effective |= missing;
    // A thread without them is one without the right: the request that follows says so.
    let _ = set_capabilities(None, sets);
}

/// Capabilities of a real-time thread that are permitted and not effective.
fn missing(sets: &CapabilitySets) -> CapabilitySet {
    let wanted = CapabilitySet::SYS_NICE | CapabilitySet::IPC_LOCK;
    wanted & sets.permitted & !sets.effective
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_permitted_capabilities_of_a_real_time_thread_are_raised() {
        let mut sets = CapabilitySets {
            effective: CapabilitySet::IPC_LOCK,
            permitted: CapabilitySet::IPC_LOCK | CapabilitySet::SYS_NICE | CapabilitySet::CHOWN,
            inheritable: CapabilitySet::empty(),
        };
        assert_eq!(missing(&sets), CapabilitySet::SYS_NICE);
        sets.permitted = CapabilitySet::CHOWN;
        assert!(missing(&sets).is_empty());
    }

    #[test]
    fn a_thread_that_dropped_its_capability_raises_it_again() {
        let thread = std::thread::spawn(|| {
            let Ok(before) = capabilities(None) else {
                return;
            };
            if !before.permitted.contains(CapabilitySet::SYS_NICE) {
                // A user without rights has nothing to raise.
                raise();
                assert_eq!(capabilities(None), Ok(before));
                return;
            }
            let dropped = CapabilitySets {
                effective: before.effective - CapabilitySet::SYS_NICE,
                ..before
            };
            set_capabilities(None, dropped).expect("a thread may drop a capability");
            assert_eq!(missing(&dropped), CapabilitySet::SYS_NICE);
            raise();
            let after = capabilities(None).expect("capabilities");
            assert!(after.effective.contains(CapabilitySet::SYS_NICE));
        });
        thread.join().expect("no panic");
    }
}
