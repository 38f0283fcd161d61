//! The machine that a report is of.

use serde::Serialize;

/// What times depend on.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Machine {
    pub(crate) processor: String,
    pub(crate) logical_cores: usize,
    pub(crate) memory_gib: f64,
    pub(crate) system: String,
    /// Processes that wanted a core over the last minute: over the number of cores, times are those of a machine that others use.
    pub(crate) load: f64,
    pub(crate) build: &'static str,
}

impl Machine {
    /// This one; what the system does not tell is said to be unknown.
    pub(crate) fn here() -> Self {
        let read = |path: &str| std::fs::read_to_string(path).unwrap_or_default();
        let line = |text: &str, key: &str| {
            let found = text.lines().find(|line| line.starts_with(key))?;
            Some(found.split_once(':')?.1.trim().to_owned())
        };
        let processor = line(&read("/proc/cpuinfo"), "model name");
        let memory = line(&read("/proc/meminfo"), "MemTotal")
            .and_then(|found| found.trim_end_matches(" kB").parse::<f64>().ok());
        let release = read("/proc/sys/kernel/osrelease");
        Self {
            processor: processor.unwrap_or_else(|| "unknown processor".into()),
            logical_cores: std::thread::available_parallelism().map_or(1, |cores| cores.get()),
            memory_gib: memory.map_or(f64::NAN, |kib| kib / (1024.0 * 1024.0)),
            system: format!(
                "{} {} {}",
                std::env::consts::OS,
                release.trim(),
                std::env::consts::ARCH
            ),
            load: read("/proc/loadavg")
                .split(' ')
                .next()
                .and_then(|load| load.parse().ok())
                .unwrap_or(f64::NAN),
            build: if cfg!(debug_assertions) {
                "debug"
            } else {
                "release"
            },
        }
    }
}
