//! Processor time and memory of this process, by the kind of thread, from `/proc`.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Interval between two readings. A thread that lives shorter may be missed.
const EVERY: Duration = Duration::from_millis(250);
/// Beginnings of the names of a server's threads.
const SERVER: [&str; 4] = [SIMULATION, "sulcus-rec", "sulcus-net", "tokio-"];
/// Name of a simulation thread.
const SIMULATION: &str = "sulcus-sim";

/// Use of the machine in a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Usage {
    /// Processor time of the whole process per wall time, per cent of one core.
    pub cpu_percent: f64,
    /// The same for the threads of the server alone.
    pub server_percent: f64,
    /// Time for which simulation threads were ready and did not run, summed over the threads, per cent of the wall
    /// time. The time holds waits for other real-time threads and all throttles of the kernel.
    pub waited_percent: f64,
    /// Largest resident memory of the process, mebibytes.
    pub memory_mb: f64,
}

/// Meter of a run. A thread reads `/proc` until [`Meter::stop`].
pub struct Meter {
    over: Arc<AtomicBool>,
    thread: JoinHandle<Usage>,
}

impl Meter {
    /// Starts the meter.
    ///
    /// # Errors
    /// The system refuses a thread.
    pub fn start() -> std::io::Result<Self> {
        let over = Arc::new(AtomicBool::new(false));
        let ended = over.clone();
        let thread = std::thread::Builder::new()
            .name("sulcus-meter".into())
            .spawn(move || {
                let begin = Instant::now();
                let before = times();
                let mut newest = before.clone();
                while !ended.load(Ordering::Relaxed) {
                    std::thread::sleep(EVERY);
                    // A thread that has ended keeps its last reading.
                    for (id, mut reading) in times() {
                        let former = newest.get(&id).map_or(0, |former| former.wait_ns);
                        reading.wait_ns = reading.wait_ns.max(former);
                        newest.insert(id, reading);
                    }
                }
                let wall_s = begin.elapsed().as_secs_f64();
                let mut usage = Usage {
                    memory_mb: memory_mb(),
                    ..Usage::default()
                };
                for (id, reading) in &newest {
                    let earlier = before.get(id);
                    let (ticks, wait_ns) =
                        earlier.map_or((0, 0), |earlier| (earlier.ticks, earlier.wait_ns));
                    let ticks = reading.ticks.saturating_sub(ticks);
                    let percent = 100.0 * ticks as f64 / ticks_per_s() / wall_s;
                    usage.cpu_percent += percent;
                    if SERVER.iter().any(|begin| reading.name.starts_with(begin)) {
                        usage.server_percent += percent;
                    }
                    if reading.name.starts_with(SIMULATION) {
                        let wait_ns = reading.wait_ns.saturating_sub(wait_ns);
                        usage.waited_percent += 100.0 * wait_ns as f64 / 1e9 / wall_s;
                    }
                }
                usage
            })?;
        Ok(Self { over, thread })
    }

    /// Ends the meter.
    pub fn stop(self) -> Usage {
        self.over.store(true, Ordering::Relaxed);
        self.thread.join().unwrap_or_default()
    }
}

fn ticks_per_s() -> f64 {
    // The unit of `/proc` is 1/100 s on every Linux of the last decades (USER_HZ).
    100.0
}

/// Reading of one thread.
#[derive(Clone, Debug, PartialEq)]
struct Reading {
    name: String,
    /// Processor time, 1/100 s.
    ticks: u64,
    /// Time ready and not running; 0 if the kernel does not tell.
    wait_ns: u64,
}

/// Readings of the threads of this process, by number.
fn times() -> BTreeMap<u32, Reading> {
    let mut found = BTreeMap::new();
    for entry in std::fs::read_dir("/proc/self/task")
        .into_iter()
        .flatten()
        .flatten()
    {
        let Some(id) = entry.file_name().to_str().and_then(|id| id.parse().ok()) else {
            continue;
        };
        let Ok(stat) = std::fs::read_to_string(entry.path().join("stat")) else {
            continue;
        };
        if let Some((name, ticks)) = parse(&stat) {
            let waits = std::fs::read_to_string(entry.path().join("schedstat"));
            let wait_ns = waits
                .ok()
                .and_then(|text| text.split(' ').nth(1)?.parse().ok());
            let reading = Reading {
                name,
                ticks,
                wait_ns: wait_ns.unwrap_or(0),
            };
            found.insert(id, reading);
        }
    }
    found
}

/// Name and sum of user and system time of a line of `stat`. The name stands in brackets and may hold any character.
fn parse(stat: &str) -> Option<(String, u64)> {
    let (head, rest) = stat.rsplit_once(") ")?;
    let (_, name) = head.split_once('(')?;
    // Fields 14 and 15 of the line; the rest begins with field 3.
    let mut fields = rest.split(' ').skip(11);
    let user: u64 = fields.next()?.parse().ok()?;
    let system: u64 = fields.next()?.parse().ok()?;
    Some((name.to_owned(), user + system))
}

fn memory_mb() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kib = line.and_then(|line| line.trim().split(' ').next()?.parse::<f64>().ok());
    kib.unwrap_or(0.0) / 1024.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_with_brackets_in_the_name_is_read() {
        let line = "12 (a) b) S 1 2 3 4 5 6 7 8 9 10 40 2 0 0";
        assert_eq!(parse(line), Some(("a) b".into(), 42)));
        assert_eq!(parse("12 a S"), None);
    }

    #[test]
    fn a_thread_that_works_is_seen() {
        let limit = Instant::now() + Duration::from_secs(120);
        let mut x = 0u64;
        // On a busy machine the meter may wait for its first reading until the work is over.
        let usage = loop {
            let meter = Meter::start().expect("a thread");
            let begin = Instant::now();
            while begin.elapsed() < Duration::from_millis(600) {
                x = x.wrapping_mul(31).wrapping_add(7);
            }
            let usage = meter.stop();
            if x != 1 && usage.cpu_percent > 1.0 {
                break usage;
            }
            assert!(Instant::now() < limit, "{usage:?}");
        };
        assert!(usage.memory_mb > 1.0 && usage.server_percent <= usage.cpu_percent);
    }
}
