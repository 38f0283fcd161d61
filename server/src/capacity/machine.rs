//! Cores of this process, and the share of each that real-time threads may use.

use serde::Serialize;

use super::pin::cores_of_process;
use super::throttle::Throttle;

/// Real-time share if the kernel does not tell its own: the default of Linux.
const REAL_TIME_SHARE: f64 = 0.95;

/// Cores for the sessions of a server.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Machine {
    /// Numbers of the cores, ascending, at least one.
    pub cores: Vec<usize>,
    /// Share of a core that real-time threads may use, 0 to 1.
    pub real_time_share: f64,
    /// CPU time of all threads together, cores: the number of cores, or a smaller quota of a container.
    pub quota_cores: f64,
}

impl Machine {
    /// This machine as the calling thread sees it; call the function from a thread that is not pinned.
    pub fn here() -> Self {
        let cores = cores_of_process().unwrap_or_default();
        Self::of(cores, &Throttle::read())
    }

    /// Machine with the given cores and limits.
    pub fn of(mut cores: Vec<usize>, throttle: &Throttle) -> Self {
        if cores.is_empty() {
            // A process runs on a core, even if the system does not tell which.
            cores.push(0);
        }
        let number = cores.len() as f64;
        Self {
            cores,
            real_time_share: throttle.real_time_share.unwrap_or(REAL_TIME_SHARE),
            quota_cores: throttle
                .quota_cores
                .map_or(number, |quota| quota.min(number)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn this_machine_has_a_core_and_a_quota_bounds_the_total() {
        let here = Machine::here();
        assert!(!here.cores.is_empty() && here.quota_cores > 0.0, "{here:?}");
        assert!(here.quota_cores <= here.cores.len() as f64);
        let limited = Throttle {
            quota_cores: Some(1.5),
            real_time_share: Some(0.5),
            ..Throttle::default()
        };
        let machine = Machine::of(vec![2, 3, 5], &limited);
        assert_eq!((machine.quota_cores, machine.real_time_share), (1.5, 0.5));
        assert_eq!(Machine::of(vec![], &Throttle::default()).cores, [0]);
    }
}
