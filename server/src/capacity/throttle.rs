//! Limits of the kernel and of containers on CPU time, and the time that they took.
//!
//! | source | content | kernel |
//! |---|---|---|
//! | `/proc/sys/kernel/sched_rt_runtime_us`, `sched_rt_period_us` | real-time share of a core | all; since 6.12 a fair server keeps 5 % for other threads instead |
//! | `cpu.max` of the control group and its parents | quota of all cores | control groups, version 2 |
//! | `cpu.stat` of the control group | number and time of throttles by the quota | control groups, version 2 |
//! | `/proc/thread-self/schedstat` | time a thread was ready and did not run | with CONFIG_SCHED_INFO |
//!
//! The kernel does not report the time of its real-time throttle by itself. The waiting time of the simulation threads
//! includes that time.

use std::path::{Path, PathBuf};

use serde::Serialize;

/// Limits on CPU time, as found. A part that this machine does not tell is `None`.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Throttle {
    /// Share of a core that real-time threads may use, 0 to 1; 1 without a limit.
    pub real_time_share: Option<f64>,
    /// Quota of the control group, cores; `None` also without a quota.
    pub quota_cores: Option<f64>,
    /// Number of periods in which the quota stopped the group.
    pub throttled_periods: Option<u64>,
    /// Time for which the quota stopped threads of the group, microseconds.
    pub throttled_us: Option<u64>,
    /// Sources that could not be read, a sentence each.
    pub unavailable: Vec<String>,
}

impl Throttle {
    /// Limits of this machine at present.
    pub fn read() -> Self {
        Self::read_below(Path::new("/"))
    }

    /// Limits in the files below `root`.
    pub fn read_below(root: &Path) -> Self {
        let mut found = Self::default();
        let kernel = root.join("proc/sys/kernel");
        let number = |name: &str| -> Option<i64> {
            std::fs::read_to_string(kernel.join(name))
                .ok()?
                .trim()
                .parse()
                .ok()
        };
        found.real_time_share =
            real_time_share(number("sched_rt_runtime_us"), number("sched_rt_period_us"));
        if found.real_time_share.is_none() {
            let text =
                "the kernel's real-time share is unknown (sched_rt_runtime_us): 95 % assumed";
            found.unavailable.push(text.into());
        }
        let Some(group) = own_group(root) else {
            let text =
                "no control group of version 2: quota and throttles of a container are unknown";
            found.unavailable.push(text.into());
            return found;
        };
        let top = root.join("sys/fs/cgroup");
        let all = group
            .ancestors()
            .take_while(|folder| folder.starts_with(&top));
        let quotas =
            all.filter_map(|folder| quota(&std::fs::read_to_string(folder.join("cpu.max")).ok()?));
        found.quota_cores = quotas.min_by(f64::total_cmp);
        match std::fs::read_to_string(group.join("cpu.stat")) {
            Ok(text) => {
                found.throttled_periods = field(&text, "nr_throttled");
                found.throttled_us = field(&text, "throttled_usec");
            }
            Err(error) => found.unavailable.push(format!(
                "throttles of the control group are unknown: {error}"
            )),
        }
        found
    }
}

/// Time for which the calling thread was ready to run and did not run, nanoseconds; `None` if the kernel does not tell.
/// The time includes waits for other real-time threads and all throttles.
pub fn thread_wait_ns() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    text.split_whitespace().nth(1)?.parse().ok()
}

/// Share of a core by the kernel's two numbers. A runtime of -1 is no limit.
fn real_time_share(runtime_us: Option<i64>, period_us: Option<i64>) -> Option<f64> {
    match (runtime_us?, period_us?) {
        (-1, _) => Some(1.0),
        (runtime, period) if period > 0 && (0..=period).contains(&runtime) => {
            Some(runtime as f64 / period as f64)
        }
        _ => None,
    }
}

/// Folder of this process's control group of version 2.
fn own_group(root: &Path) -> Option<PathBuf> {
    let text = std::fs::read_to_string(root.join("proc/self/cgroup")).ok()?;
    let path = text.lines().find_map(|line| line.strip_prefix("0::/"))?;
    let group = root.join("sys/fs/cgroup").join(path);
    // A container may not see the folder of its own name; its own group is then the top.
    let top = root.join("sys/fs/cgroup");
    [group, top]
        .into_iter()
        .find(|group| group.join("cgroup.controllers").exists())
}

/// Quota of a file `cpu.max`, cores: `QUOTA PERIOD`, microseconds, or `max PERIOD`.
fn quota(text: &str) -> Option<f64> {
    let mut parts = text.split_whitespace();
    let quota: f64 = parts.next()?.parse().ok()?;
    let period: f64 = parts.next()?.parse().ok()?;
    let cores = quota / period;
    (cores.is_finite() && cores > 0.0).then_some(cores)
}

/// Number behind a name in a file of lines `NAME NUMBER`.
fn field(text: &str, name: &str) -> Option<u64> {
    let rest = text
        .lines()
        .find_map(|line| line.strip_prefix(name)?.strip_prefix(' '))?;
    rest.trim().parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn machine(files: &[(&str, &str)]) -> tempfile::TempDir {
        let root = tempfile::tempdir().expect("temporary folder");
        for (path, text) in files {
            let path = root.path().join(path);
            std::fs::create_dir_all(path.parent().expect("a folder")).expect("creates");
            std::fs::write(path, text).expect("writes");
        }
        root
    }

    #[test]
    fn a_container_with_a_quota_is_read() {
        let root = machine(&[
            ("proc/sys/kernel/sched_rt_runtime_us", "950000\n"),
            ("proc/sys/kernel/sched_rt_period_us", "1000000\n"),
            ("proc/self/cgroup", "0::/system.slice/sulcus.service\n"),
            (
                "sys/fs/cgroup/system.slice/sulcus.service/cgroup.controllers",
                "cpu\n",
            ),
            (
                "sys/fs/cgroup/system.slice/sulcus.service/cpu.max",
                "max 100000\n",
            ),
            (
                "sys/fs/cgroup/system.slice/sulcus.service/cpu.stat",
                "usage_usec 5\nnr_periods 9\nnr_throttled 3\nthrottled_usec 4200\n",
            ),
            ("sys/fs/cgroup/system.slice/cpu.max", "150000 100000\n"),
        ]);
        let found = Throttle::read_below(root.path());
        assert_eq!(
            found,
            Throttle {
                real_time_share: Some(0.95),
                quota_cores: Some(1.5),
                throttled_periods: Some(3),
                throttled_us: Some(4200),
                unavailable: Vec::new(),
            }
        );
    }

    #[test]
    fn an_unlimited_share_is_a_whole_core_and_nonsense_is_unknown() {
        assert_eq!(real_time_share(Some(-1), Some(1_000_000)), Some(1.0));
        assert_eq!(real_time_share(Some(0), Some(1_000_000)), Some(0.0));
        assert_eq!(real_time_share(Some(5), Some(0)), None);
        assert_eq!(real_time_share(Some(9), Some(5)), None);
        assert_eq!(real_time_share(None, Some(5)), None);
        for text in ["", "max", "max 5", "5", "0 5", "5 0", "-5 5", "x y"] {
            assert_eq!(quota(text), None, "{text}");
        }
    }

    #[test]
    fn a_machine_that_tells_nothing_is_said_to() {
        let root = machine(&[]);
        let found = Throttle::read_below(root.path());
        assert_eq!((found.real_time_share, found.quota_cores), (None, None));
        assert_eq!(found.unavailable.len(), 2, "{found:?}");
    }

    #[test]
    fn the_wait_of_a_thread_never_falls() {
        let Some(before) = thread_wait_ns() else {
            return;
        };
        std::thread::yield_now();
        assert!(thread_wait_ns().expect("as before") >= before);
    }
}
