//! Compilations by child processes: one at a time, at the least priority, watched and stopped.

use std::collections::{BTreeMap, VecDeque};
use std::ffi::OsString;
use std::io::{BufRead as _, BufReader, Read};
use std::process::{Child, Command, Stdio};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use sulcus_console::house::cases::{Running, Work};

/// Longest line of a child that is read, bytes.
const LINE: u64 = 4096;

/// Compiler of cases.
#[derive(Clone, Default)]
pub(super) struct Worker {
    inner: Arc<Mutex<Inner>>,
}

#[derive(Default)]
struct Inner {
    waiting: VecDeque<Job>,
    running: Option<Running>,
    /// Process of the running compilation.
    child: Option<Child>,
    is_cancelled: bool,
    failed: BTreeMap<String, String>,
    ended: u64,
}

/// A compilation that is asked for.
struct Job {
    name: String,
    command: Command,
}

/// End of a child process.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Ended {
    /// Success.
    Well,
    /// A sentence of the child, or about the child.
    Badly(String),
}

impl Worker {
    fn inner(&self) -> MutexGuard<'_, Inner> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Compilations for the console.
    pub fn work(&self) -> Work {
        let inner = self.inner();
        let failed = inner.failed.iter();
        Work {
            running: inner.running.clone(),
            waiting: inner.waiting.iter().map(|job| job.name.clone()).collect(),
            failed: failed
                .map(|(name, why)| (name.clone(), why.clone()))
                .collect(),
            ended: inner.ended,
        }
    }

    /// Adds a compilation by `command`, unless the case waits already.
    pub fn add(&self, name: &str, command: Command) {
        let mut inner = self.inner();
        if inner.waiting.iter().any(|job| job.name == name) {
            return;
        }
        inner.failed.remove(name);
        inner.waiting.push_back(Job {
            name: name.to_owned(),
            command,
        });
        if inner.running.is_some() {
            return;
        }
        // The place of the running compilation is taken before the thread runs, so that there is one thread.
        inner.running = Some(Running::default());
        drop(inner);
        let worker = self.clone();
        let spawned = std::thread::Builder::new()
            .name("cases".into())
            .spawn(move || while worker.step() {});
        if let Err(error) = spawned {
            let mut inner = self.inner();
            inner.running = None;
            inner.waiting.clear();
            let why = format!("the server has no thread for the compilation: {error}");
            inner.failed.insert(name.to_owned(), why);
        }
    }

    /// Stops the compilation of a case, or takes the case out of those that wait.
    pub fn cancel(&self, name: &str) {
        let mut inner = self.inner();
        inner.waiting.retain(|job| job.name != name);
        if inner
            .running
            .as_ref()
            .is_some_and(|running| running.name == name)
        {
            inner.is_cancelled = true;
            if let Some(child) = &mut inner.child {
                let _ = child.kill();
            }
        }
    }

    /// Forgets the failure of a case.
    pub fn forget(&self, name: &str) {
        self.inner().failed.remove(name);
    }

    /// Carries out the next compilation; `false` without one.
    fn step(&self) -> bool {
        let mut inner = self.inner();
        let Some(mut job) = inner.waiting.pop_front() else {
            inner.running = None;
            return false;
        };
        inner.is_cancelled = false;
        inner.running = Some(Running {
            name: job.name.clone(),
            stage: "starting".into(),
            percent: 0,
        });
        let started = start(&mut job.command);
        let said = match started {
            Ok((child, lines)) => {
                inner.child = Some(child);
                drop(inner);
                self.follow(lines)
            }
            Err(why) => {
                inner.failed.insert(job.name, why);
                inner.ended += 1;
                return true;
            }
        };
        let mut inner = self.inner();
        let ended = inner.child.take().map(|child| end(child, &said));
        let is_cancelled = std::mem::take(&mut inner.is_cancelled);
        if let Some(Ended::Badly(why)) = ended
            && !is_cancelled
        {
            tracing::warn!("case {}: {why}", job.name);
            inner.failed.insert(job.name, why);
        }
        inner.ended += 1;
        true
    }

    /// Reads the lines of a child until their end. Returns the last line that is no progress.
    fn follow(&self, lines: impl Read) -> String {
        let mut said = String::new();
        each_line(lines, |line| match progress(line) {
            Some((percent, stage)) => {
                if let Some(running) = &mut self.inner().running {
                    running.percent = percent;
                    running.stage = stage.to_owned();
                }
            }
            None => said = line.to_owned(),
        });
        said
    }
}

/// A command of the server's own program.
///
/// # Errors
/// The program is not known.
pub(super) fn own(arguments: &[OsString]) -> Result<Command, String> {
    let program = std::env::current_exe();
    let program = program.map_err(|error| format!("the server's program is unknown: {error}"))?;
    let mut command = Command::new(program);
    command.args(arguments);
    Ok(command)
}

/// Runs a command to its end.
pub(super) fn run(command: &mut Command) -> Ended {
    match start(command) {
        Ok((child, lines)) => {
            let mut said = String::new();
            each_line(lines, |line| {
                if progress(line).is_none() {
                    said = line.to_owned();
                }
            });
            end(child, &said)
        }
        Err(why) => Ended::Badly(why),
    }
}

fn start(command: &mut Command) -> Result<(Child, impl Read + use<>), String> {
    let spawned = command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        // The lines are for this module, whatever log the server writes.
        .env("SULCUS_LOG", "error")
        .spawn();
    let mut child = spawned.map_err(|error| format!("the compiler does not start: {error}"))?;
    let lines = child.stderr.take();
    let lines = lines.ok_or("the compiler has no output")?;
    Ok((child, lines))
}

/// Calls `with` for each line; longer lines are cut.
fn each_line(from: impl Read, mut with: impl FnMut(&str)) {
    let mut from = BufReader::new(from);
    loop {
        let mut line = Vec::new();
        match (&mut from).take(LINE).read_until(b'\n', &mut line) {
            Ok(0) | Err(_) => return,
            Ok(_) => {
                let line = String::from_utf8_lossy(&line);
                let line = line.trim();
                if !line.is_empty() {
                    with(line);
                }
            }
        }
    }
}

/// Percent and stage of a line such as ` 42 %  tooth 43`.
fn progress(line: &str) -> Option<(u8, &str)> {
    let (percent, stage) = line.split_once(" %  ")?;
    let percent: u8 = percent.trim().parse().ok()?;
    Some((percent.min(100), stage))
}

/// End of a child whose output has ended. `said`: its last line that is no progress.
fn end(mut child: Child, said: &str) -> Ended {
    use std::os::unix::process::ExitStatusExt as _;
    let status = match child.wait() {
        Ok(status) if status.success() => return Ended::Well,
        Ok(status) => status,
        Err(error) => return Ended::Badly(format!("the compiler cannot be waited for: {error}")),
    };
    let told = said.strip_prefix("error: ").filter(|told| !told.is_empty());
    Ended::Badly(match (status.signal(), told) {
        (Some(signal), _) => {
            format!("the compiler was ended by signal {signal}; the former scene is unchanged")
        }
        (None, Some(told)) => told.to_owned(),
        (None, None) => format!(
            "the compiler ended with {status}{}{}",
            if said.is_empty() { "" } else { ": " },
            said
        ),
    })
}

#[cfg(test)]
#[path = "worker_tests.rs"]
mod tests;
