//! The rig of a test: it starts the controller, causes faults and reads the log.

mod files;
mod request;

use files::Files;
pub use files::{example, library};
pub use request::{Fault, Request, Response, Snapshot};

use crate::board::ENV;
use crate::clock;
use crate::log::Log;
use crate::setup::{Hand, Setup};
use std::io::{BufRead, BufReader, Error, Result, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::Mutex;
use std::time::Duration;

/// A running controller with its devices. The controller ends with the rig.
pub struct Rig {
    child: Child,
    pipes: Mutex<(ChildStdin, BufReader<ChildStdout>)>,
    /// The log so far and the length of the file that it was read from.
    read: Mutex<(Log, u64)>,
    setup: Setup,
    files: Files,
}

impl Rig {
    /// Starts the controller beside the running test with these settings, and waits until it is ready.
    pub fn start(setup: Setup) -> Result<Self> {
        Self::start_at(&files::program("standin-controller")?, setup)
    }

    /// Starts the controller at `program` with these settings, and waits until it is ready.
    pub fn start_at(program: &Path, setup: Setup) -> Result<Self> {
        let files = Files::new()?;
        let mut child = Command::new(program)
            .arg(files.board())
            .arg(files.log())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()?;
        let (Some(input), Some(output)) = (child.stdin.take(), child.stdout.take()) else {
            return Err(Error::other("the controller has no pipes"));
        };
        let rig = Self {
            child,
            pipes: Mutex::new((input, BufReader::new(output))),
            read: Mutex::default(),
            setup,
            files,
        };
        rig.request(&Request::Start(Box::new(rig.setup.clone())))?;
        Ok(rig)
    }

    /// The environment variable that a client process needs, and its value.
    pub fn environment(&self) -> (&'static str, PathBuf) {
        (ENV, self.files.board())
    }

    /// Path of the board, for `standin_reset`.
    pub fn board(&self) -> PathBuf {
        self.files.board()
    }

    /// Path of the log's file.
    pub fn log_file(&self) -> PathBuf {
        self.files.log()
    }

    /// Settings that the controller started with.
    pub fn setup(&self) -> &Setup {
        &self.setup
    }

    /// Causes a fault of a device. Faults of the scheduler concern every HD device; the number is without effect.
    pub fn fault(&self, device: usize, fault: Fault) -> Result<()> {
        self.request(&Request::Fault(device, fault)).map(|_| ())
    }

    /// Gives a device another hand.
    pub fn hand(&self, device: usize, hand: Hand) -> Result<()> {
        self.request(&Request::Hand(device, Box::new(hand)))
            .map(|_| ())
    }

    /// The true state of a device.
    pub fn snapshot(&self, device: usize) -> Result<Snapshot> {
        match self.request(&Request::Snapshot(device))? {
            Response::Snapshot(snapshot) => Ok(snapshot),
            other => Err(Error::other(format!("the controller answered {other:?}"))),
        }
    }

    /// The log up to now. Every message that a library sent before the call is in it.
    pub fn log(&self) -> Result<Log> {
        self.with_log(Log::clone)
    }

    /// Gives the log up to now to `judge`, without a copy.
    pub fn with_log<T>(&self, judge: impl FnOnce(&Log) -> T) -> Result<T> {
        self.request(&Request::Sync)?;
        let mut read = self.read.lock().map_err(|_| poisoned())?;
        let (log, length) = &mut *read;
        *length += log.append(&self.files.log(), *length)?;
        Ok(judge(log))
    }

    /// Waits until the log satisfies `wanted`, at most for `time`. Returns the last log and whether it does.
    pub fn wait_log(&self, time: Duration, wanted: impl Fn(&Log) -> bool) -> Result<(Log, bool)> {
        let until = clock::now_ns() + time.as_nanos() as u64;
        loop {
            let late = clock::now_ns() > until;
            let found = self.with_log(|log| {
                let found = wanted(log);
                (found || late).then(|| (log.clone(), found))
            })?;
            if let Some(found) = found {
                return Ok(found);
            }
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    fn request(&self, request: &Request) -> Result<Response> {
        let mut pipes = self.pipes.lock().map_err(|_| poisoned())?;
        let mut line = serde_json::to_string(request)?;
        line.push('\n');
        pipes.0.write_all(line.as_bytes())?;
        pipes.0.flush()?;
        let mut answer = String::new();
        if pipes.1.read_line(&mut answer)? == 0 {
            return Err(Error::other("the controller ended"));
        }
        match serde_json::from_str(&answer)? {
            Response::Refused(why) => Err(Error::other(why)),
            response => Ok(response),
        }
    }
}

fn poisoned() -> Error {
    Error::other("another thread failed at the rig")
}

impl Drop for Rig {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
