//! Check of the monotonic clock and of short sleeps.

use std::time::{Duration, Instant};

use super::check::Check;

const NAME: &str = "clock";
/// Sleeps of the measurement, and the length of one.
const SLEEPS: usize = 50;
const SLEEP: Duration = Duration::from_millis(1);
/// Coarsest step of a clock that can time a loop at 1 kHz.
const STEP: Duration = Duration::from_micros(1);
/// Median lateness that is still ok, and a single lateness that is worth a hint.
const MEDIAN: Duration = Duration::from_millis(1);
const LATE: Duration = Duration::from_millis(3);

/// Measures for about 60 ms.
pub fn check() -> Check {
    let step = step();
    let mut lateness = Vec::with_capacity(SLEEPS);
    for _ in 0..SLEEPS {
        let start = Instant::now();
        std::thread::sleep(SLEEP);
        lateness.push(start.elapsed().saturating_sub(SLEEP));
    }
    judge(step, lateness)
}

/// Smallest step between two readings that differ; `None` for a clock that does not advance.
fn step() -> Option<Duration> {
    // A coarse clock of 10 ms still shows a step within the time limit.
    let start = Instant::now();
    let mut smallest: Option<Duration> = None;
    let mut before = start;
    for reading in 0..2_000_000 {
        let now = Instant::now();
        let step = now.saturating_duration_since(before);
        before = now;
        if !step.is_zero() {
            smallest = Some(smallest.map_or(step, |smallest| smallest.min(step)));
        }
        if reading >= 1000 && smallest.is_some() {
            break;
        }
    }
    smallest
}

fn judge(step: Option<Duration>, mut lateness: Vec<Duration>) -> Check {
    match step {
        None => {
            return Check::wrong(
                NAME,
                "the monotonic clock does not advance. Restart the computer, or choose another clock source of the \
                 system.",
            );
        }
        Some(step) if step > STEP => {
            return Check::wrong(
                NAME,
                format!(
                    "the monotonic clock has steps of {:.1} us; at most 1 us is needed. Choose a finer clock source of \
                     the system, such as tsc: cat /sys/devices/system/clocksource/clocksource0/available_clocksource",
                    step.as_secs_f64() * 1e6
                ),
            );
        }
        Some(_) => {}
    }
    lateness.sort();
    let median = lateness
        .get(lateness.len() / 2)
        .copied()
        .unwrap_or_default();
    let largest = lateness.last().copied().unwrap_or_default();
    let milliseconds = |time: Duration| time.as_secs_f64() * 1e3;
    let measured = format!(
        "{} sleeps of 1 ms were late by {:.2} ms in the median, {:.2} ms at most.",
        lateness.len(),
        milliseconds(median),
        milliseconds(largest)
    );
    let hint =
        "Close other programs, choose the power profile `performance`, and turn energy saving off.";
    if median > MEDIAN {
        Check::wrong(NAME, format!("{measured} {hint}"))
    } else if largest > LATE {
        Check::fine(NAME, format!("{measured} A run may lose ticks. {hint}"))
    } else {
        Check::fine(NAME, measured)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sleeps(median: u64, largest: u64) -> Vec<Duration> {
        let mut all = vec![Duration::from_micros(median); SLEEPS - 1];
        all.insert(7, Duration::from_micros(largest));
        all
    }

    fn fine_step() -> Option<Duration> {
        Some(Duration::from_nanos(30))
    }

    #[test]
    fn only_the_median_decides_and_a_late_sleep_gets_a_hint() {
        let quiet = judge(fine_step(), sleeps(60, 400));
        assert!(quiet.ok && !quiet.message.contains("power"), "{quiet:?}");
        assert!(
            quiet
                .message
                .contains("0.06 ms in the median, 0.40 ms at most"),
            "{quiet:?}"
        );
        let once = judge(fine_step(), sleeps(60, 3500));
        assert!(once.ok && once.message.contains("power"), "{once:?}");
        let slow = judge(fine_step(), sleeps(1200, 1300));
        assert!(!slow.ok && slow.message.contains("power"), "{slow:?}");
    }

    #[test]
    fn a_coarse_clock_and_a_stopped_clock_are_wrong() {
        let coarse = judge(Some(Duration::from_micros(15)), sleeps(60, 400));
        assert!(
            !coarse.ok && coarse.message.contains("15.0 us"),
            "{coarse:?}"
        );
        assert!(coarse.message.chars().count() <= 300 && !coarse.message.contains("..."));
        assert!(!judge(None, Vec::new()).ok);
        assert!(judge(fine_step(), Vec::new()).ok);
    }

    #[test]
    fn the_clock_of_this_machine_advances() {
        let step = step().expect("the clock advances");
        assert!(step < Duration::from_millis(20), "{step:?}");
        let check = check();
        assert!(check.name == NAME && check.message.chars().count() <= 300);
    }
}
