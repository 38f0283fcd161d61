//! Grading of a session: the program `sulcus-sessions grade` as a child of idle priority.
//!
//! The replay of a session takes minutes of CPU time. As a process of its own with the lowest priority it delays no
//! tick, and a crash of it harms no station.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use serde_json::Value;

/// Lowest priority of a process.
const NICE: i32 = 19;
/// Longest grading. Chosen: an hour of two hands replays in less than half of this time on one slow core.
const LONGEST: Duration = Duration::from_secs(4 * 3600);
/// Time between two looks at the child.
const LOOK: Duration = Duration::from_millis(50);
/// Longest sentence of an error, characters.
const MOST_WORDS: usize = 400;

/// Outcome of a grading.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Made {
    /// Grade as JSON.
    pub object: Value,
    /// Printable page; empty without one.
    pub page: String,
}

/// A grading to make.
#[derive(Clone, Debug)]
pub(super) struct Job<'a> {
    /// Program `sulcus-sessions`.
    pub program: &'a Path,
    /// Last recording of the session.
    pub recording: &'a Path,
    /// Recordings that it continues.
    pub before: &'a [PathBuf],
    /// Public key of the server's recordings.
    pub signer: Option<&'a Path>,
    /// Mode in which the grade is shown; `None`: the recorded one.
    pub mode: Option<&'a str>,
    /// Empty folder for the child's output.
    pub work: &'a Path,
}

impl Job<'_> {
    /// Runs the child until its end. `stop` kills it.
    ///
    /// # Errors
    /// Sentence for the person: the child cannot be started, was stopped, or printed no grade.
    pub fn run(&self, stop: &AtomicBool) -> Result<Made, String> {
        let (out, told) = (self.work.join("out"), self.work.join("told"));
        let file = |path: &Path| {
            File::create(path)
                .map_err(|error| format!("the work folder cannot be written: {error}"))
        };
        let mut command = Command::new(self.program);
        command.args(["grade", "--json", "--html"]).arg(self.work);
        if let Some(mode) = self.mode {
            command.args(["--mode", mode]);
        }
        if let Some(signer) = self.signer {
            command.arg("--signer").arg(signer);
        }
        command.args(self.before).arg(self.recording);
        command
            .stdin(Stdio::null())
            .stdout(file(&out)?)
            .stderr(file(&told)?);
        let child = command
            .spawn()
            .map_err(|error| format!("the grading program cannot be started: {error}"))?;
        wait(child, stop)?;
        let printed = std::fs::read_to_string(&out).unwrap_or_default();
        let object: Option<Value> = printed
            .lines()
            .last()
            .and_then(|line| serde_json::from_str(line).ok());
        let words = || last_words(&std::fs::read_to_string(&told).unwrap_or_default());
        let Some(object) = object.filter(Value::is_object) else {
            return Err(words());
        };
        if let Some(error) = object["error"].as_str() {
            return Err(error.to_owned());
        }
        let name = self.recording.with_extension("html");
        let page = self.work.join(name.file_name().unwrap_or_default());
        Ok(Made {
            object,
            page: std::fs::read_to_string(page).unwrap_or_default(),
        })
    }
}

/// Waits for the child, at the lowest priority; kills it at `stop` and after [`LONGEST`].
pub(super) fn wait(mut child: Child, stop: &AtomicBool) -> Result<(), String> {
    let pid = i32::try_from(child.id())
        .ok()
        .and_then(rustix::process::Pid::from_raw);
    if let Err(error) = rustix::process::setpriority_process(pid, NICE) {
        tracing::debug!("console: priority of the grading stays: {error}");
    }
    let begin = Instant::now();
    loop {
        match child.try_wait() {
            Ok(Some(_)) => return Ok(()),
            Ok(None) => {}
            Err(error) => return Err(format!("the program cannot be watched: {error}")),
        }
        let is_stopped = stop.load(Ordering::Acquire);
        if is_stopped || begin.elapsed() > LONGEST {
            let _ = child.kill();
            let _ = child.wait();
            let why = if is_stopped {
                "the server is ending"
            } else {
                "the program took too long"
            };
            return Err(why.into());
        }
        std::thread::sleep(LOOK);
    }
}

/// Last line that a program has told, as a sentence.
pub(super) fn last_words(told: &str) -> String {
    let line = told.lines().rev().find(|line| !line.trim().is_empty());
    let line = line.unwrap_or("the grading program has ended without a grade");
    line.trim_start_matches("error: ")
        .chars()
        .take(MOST_WORDS)
        .collect()
}

#[cfg(test)]
mod tests {
    use std::os::unix::fs::PermissionsExt as _;

    use super::*;

    /// Program of a test: a shell script.
    fn program(place: &Path, text: &str) -> PathBuf {
        let path = place.join("program");
        std::fs::write(&path, format!("#!/bin/sh\n{text}\n")).expect("writes");
        let mode = std::fs::Permissions::from_mode(0o700);
        std::fs::set_permissions(&path, mode).expect("own file");
        path
    }

    fn run(text: &str, stop: &AtomicBool) -> Result<Made, String> {
        let place = tempfile::tempdir().expect("a folder");
        let work = place.path().join("work");
        std::fs::create_dir(&work).expect("a folder");
        let program = program(place.path(), text);
        let job = Job {
            program: &program,
            recording: Path::new("r/x.mcap"),
            before: &[],
            signer: None,
            mode: Some("practice"),
            work: &work,
        };
        job.run(stop)
    }

    #[test]
    fn the_last_line_is_the_grade_and_the_page_comes_from_the_folder() {
        let text = r#"echo page > "$4/x.html"; echo progress; echo '{"score":61.5}'; exit 1"#;
        // Arguments: grade --json --html FOLDER --mode practice RECORDING.
        let made = run(text, &AtomicBool::new(false)).expect("a grade");
        assert_eq!(made.object["score"], 61.5);
        assert_eq!(made.page, "page\n");
    }

    #[test]
    fn a_program_that_fails_gives_its_sentence() {
        let going = AtomicBool::new(false);
        let told = run("echo 'error: x.mcap: no recording' >&2; exit 2", &going);
        assert_eq!(told, Err("x.mcap: no recording".into()));
        let told = run(r#"echo '{"error":"torn","file":"x"}'; exit 2"#, &going);
        assert_eq!(told, Err("torn".into()));
        let told = run("kill -9 $$", &going);
        assert_eq!(
            told,
            Err("the grading program has ended without a grade".into())
        );
    }

    #[test]
    fn the_end_of_the_server_kills_the_child() {
        let begin = Instant::now();
        let told = run("exec sleep 600", &AtomicBool::new(true));
        assert_eq!(told, Err("the server is ending".into()));
        assert!(begin.elapsed() < Duration::from_secs(60));
    }
}
