//! A thread on one core.

use rustix::thread::{CpuSet, sched_getaffinity, sched_setaffinity};

/// Keeps the calling thread on `core`, a number of [`cores_of_process`].
///
/// # Errors
/// The core does not exist, or does not belong to this process.
pub fn pin_to(core: usize) -> std::io::Result<()> {
    if core >= CpuSet::MAX_CPU {
        let text = format!(
            "core is {core}, expected a number below {}",
            CpuSet::MAX_CPU
        );
        return Err(std::io::Error::new(std::io::ErrorKind::InvalidInput, text));
    }
    let mut set = CpuSet::new();
    set.set(core);
    Ok(sched_setaffinity(None, &set)?)
}

/// Numbers of the cores on which the calling thread may run, in ascending order: the process's own, unless the thread
/// is pinned.
///
/// # Errors
/// The system does not tell.
pub fn cores_of_process() -> std::io::Result<Vec<usize>> {
    let set = sched_getaffinity(None)?;
    Ok((0..CpuSet::MAX_CPU)
        .filter(|core| set.is_set(*core))
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pinned_thread_has_one_core() {
        let cores = cores_of_process().expect("cores");
        let last = *cores.last().expect("at least one");
        let pinned = std::thread::spawn(move || {
            pin_to(last).expect("an own core");
            cores_of_process().expect("cores")
        });
        assert_eq!(pinned.join().expect("no panic"), [last]);
        assert_eq!(
            cores_of_process().expect("cores"),
            cores,
            "this thread is free"
        );
        pin_to(CpuSet::MAX_CPU).expect_err("no such core");
    }
}
