//! Tables of a swarm: on standard output, and in a document.

use std::fmt::Write as _;
use std::path::Path;

use anyhow::{Context, bail};
use sulcus_program::PathText;
use sulcus_proto::Percentiles;

use super::{Session, Swarm};

/// Markers of the generated lines of an exercise in a document.
fn markers(exercise: &str) -> [String; 2] {
    ["begin", "end"].map(|edge| format!("<!-- {edge}: swarm {exercise} -->"))
}

/// Lines for a person: a table of the sessions, then the sums.
pub(super) fn lines(swarm: &Swarm) -> String {
    let mut text = format!(
        "{:<12} {:>8} {:>7} {:>23} {:>23} {:>15} {:>8}\n",
        "station",
        "ticks",
        "missed",
        "tick CPU p50/p99/p99.9",
        "tick wall p50/p99/p99.9",
        "round trip p50",
        "dropped"
    );
    for one in &swarm.sessions {
        let three = |p: &Percentiles| format!("{:.0} / {:.0} / {:.0}", p.p50, p.p99, p.p999);
        let _ = writeln!(
            text,
            "{:<12} {:>8} {:>7} {:>23} {:>23} {:>15.0} {:>8}{}",
            one.station,
            one.ticks,
            one.deadline_misses,
            three(&one.tick_us),
            three(&one.tick_wall_us),
            one.rtt_us.p50,
            one.rows_dropped,
            if one.complete { "" } else { "  NOT COMPLETE" }
        );
    }
    for sentence in &swarm.refused {
        let _ = writeln!(text, "refused: {sentence}");
    }
    let _ = write!(
        text,
        "{} of {} stations; CPU {:.0} % of a core, of it the server {:.0} %; simulations waited {:.0} % of the time in sum; memory {:.0} MB; times in microseconds",
        swarm.sessions.len(),
        swarm.stations,
        swarm.cpu_percent,
        swarm.server_cpu_percent,
        swarm.waited_percent,
        swarm.memory_mb
    );
    if let Some(different) = swarm.not_identical {
        let _ = write!(text, "; {different} replays not identical");
    }
    text
}

/// Largest value of the sessions.
fn most(sessions: &[Session], value: impl Fn(&Session) -> f64) -> f64 {
    sessions.iter().map(value).fold(0.0, f64::max)
}

/// Table of the runs, a row each, as Markdown.
fn markdown(exercise: &str, runs: &[Swarm]) -> String {
    let cores = std::thread::available_parallelism().map_or(0, usize::from);
    let mut text = format!(
        "Machine: {cores} logical cores, shared by server and simulated hands. Exercise `{exercise}`.\n\
         Times are the largest of all stations, in microseconds. A missed point is a late tick or a point without a tick.\n\
         Waited: the time for which simulations were ready and did not run, in sum over all stations, in per cent of the wall\n\
         time; it may exceed 100. The time holds waits for other threads and throttles of the kernel.\n\n\
         | stations | sessions complete | rows dropped | replays not identical | missed points, % | tick CPU p50 | tick CPU p99 | tick CPU p99.9 | tick wall p99 | longest tick | round trip p50 | overslept by hands, % | waited, % | CPU, % of a core | server's CPU, % of a core | memory, MB |\n\
         |---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n"
    );
    for run in runs {
        let all = &run.sessions;
        let points: u64 = all.iter().map(|one| one.ticks + one.skipped).sum();
        let missed: u64 = all.iter().map(|one| one.deadline_misses).sum();
        let overslept: u64 = all.iter().map(|one| one.overslept).sum();
        let dropped: u64 = all.iter().map(|one| one.rows_dropped).sum();
        let complete = all.iter().filter(|one| one.complete).count();
        let _ = writeln!(
            text,
            "| {} | {complete} | {dropped} | {} | {:.2} | {:.0} | {:.0} | {:.0} | {:.0} | {:.0} | {:.0} | {:.2} | {:.0} | {:.0} | {:.0} | {:.0} |",
            run.stations,
            run.not_identical
                .map_or_else(|| "not tested".to_owned(), |n| n.to_string()),
            100.0 * missed as f64 / points.max(1) as f64,
            most(all, |one| one.tick_us.p50),
            most(all, |one| one.tick_us.p99),
            most(all, |one| one.tick_us.p999),
            most(all, |one| one.tick_wall_us.p99),
            most(all, |one| one.tick_wall_us.max),
            most(all, |one| one.rtt_us.p50),
            100.0 * overslept as f64 / points.max(1) as f64,
            run.waited_percent,
            run.cpu_percent,
            run.server_cpu_percent,
            run.memory_mb
        );
    }
    text
}

/// Replaces the lines between the markers of the exercise in a document.
///
/// # Errors
/// The file cannot be read or written, or lacks a marker.
pub(super) fn write(file: &Path, exercise: &str, runs: &[Swarm]) -> anyhow::Result<()> {
    let text = std::fs::read_to_string(file)
        .with_context(|| format!("--readme {}: cannot read", file.shown()))?;
    let new = replaced(&text, exercise, &markdown(exercise, runs))
        .with_context(|| format!("--readme {}", file.shown()))?;
    std::fs::write(file, new).with_context(|| format!("--readme {}: cannot write", file.shown()))
}

fn replaced(text: &str, exercise: &str, table: &str) -> anyhow::Result<String> {
    let [begin, end] = markers(exercise);
    let Some((head, rest)) = text.split_once(&begin) else {
        bail!("no line `{begin}`")
    };
    let Some((_, tail)) = rest.split_once(&end) else {
        bail!("no line `{end}` after `{begin}`")
    };
    Ok(format!("{head}{begin}\n\n{table}\n{end}{tail}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_lines_between_the_markers_of_the_exercise_change() {
        let lines = |of: &str, content: &str| {
            let [begin, end] = markers(of);
            format!("a\n{begin}\n{content}\n{end}\n")
        };
        let text = lines("crown", "old") + &lines("probing", "old");
        let new = replaced(&text, "probing", "| 1 |\n").expect("both markers");
        assert_eq!(new, lines("crown", "old") + &lines("probing", "\n| 1 |\n"));
        assert!(replaced("a", "crown", "t").is_err());
        let [begin, end] = markers("crown");
        assert!(replaced(&format!("{end}{begin}"), "crown", "t").is_err());
    }
}
