//! Parallel work on many files: a queue of files, a thread for each core, outcomes printed in the files' order.

use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::channel;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::print::{Outcome, Tally};

/// Progress of all files together, in ticks. The total grows when a file is opened.
pub(super) struct Progress(ProgressBar);

impl Progress {
    fn new(files: usize) -> Self {
        // The bar draws nothing if standard error is no terminal.
        let bar = ProgressBar::with_draw_target(Some(0), ProgressDrawTarget::stderr());
        let of = match files {
            1 => String::new(),
            n => format!(", {{msg}} of {n} files"),
        };
        let style = format!("{{wide_bar}} {{pos}}/{{len}} ticks{of}, {{eta}} left");
        if let Ok(style) = ProgressStyle::with_template(&style) {
            bar.set_style(style);
        }
        bar.set_message("0");
        Self(bar)
    }

    /// Adds a file with this number of ticks; function that takes the number of finished ticks.
    pub fn file(&self, ticks: u64) -> impl FnMut(u64) + '_ {
        self.0.inc_length(ticks);
        let mut before = 0;
        move |done: u64| {
            self.0.inc(done.saturating_sub(before));
            before = done.max(before);
        }
    }
}

/// Number of threads: by default the number of cores, never more than files.
pub(super) fn threads(jobs: Option<NonZeroUsize>, files: usize) -> usize {
    let cores = || std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
    jobs.map_or_else(cores, NonZeroUsize::get).min(files).max(1)
}

/// Calls `one` for every file, `jobs` at once, and prints the outcomes in order; worst exit code. The JSON object sums
/// `total` over the files.
pub(super) fn for_each_at_once(
    files: &[PathBuf],
    json: bool,
    total: &str,
    jobs: Option<NonZeroUsize>,
    one: impl Fn(&Path, &Progress) -> anyhow::Result<Outcome> + Sync,
) -> ExitCode {
    let progress = Progress::new(files.len());
    let mut tally = Tally::new(json);
    let next = AtomicUsize::new(0);
    std::thread::scope(|scope| {
        let (done, outcomes) = channel();
        for _ in 0..threads(jobs, files.len()) {
            let (done, next, one, progress) = (done.clone(), &next, &one, &progress);
            scope.spawn(move || {
                loop {
                    let k = next.fetch_add(1, Ordering::Relaxed);
                    let Some(path) = files.get(k) else { break };
                    if done.send((k, one(path, progress))).is_err() {
                        break;
                    }
                }
            });
        }
        drop(done);
        let mut waiting = BTreeMap::new();
        let mut printed = 0;
        for (finished, (k, outcome)) in outcomes.iter().enumerate() {
            progress.0.set_message((finished + 1).to_string());
            waiting.insert(k, outcome);
            while let Some(outcome) = waiting.remove(&printed) {
                progress.0.suspend(|| tally.add(&files[printed], outcome));
                printed += 1;
            }
        }
    });
    progress.0.finish_and_clear();
    tally.finish(total)
}
