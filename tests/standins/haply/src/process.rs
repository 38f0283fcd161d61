//! Program `standin-haply` beside the process of a test.

use std::io::{self, BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::Mutex;

use tempfile::TempDir;

use crate::fault::Fault;
use crate::log::Log;
use crate::options::Options;
use crate::request::{Ready, Request, RequestError};

/// Running program `standin-haply`; the end of the value kills it.
#[derive(Debug)]
pub struct Process {
    child: Child,
    pipes: Mutex<(ChildStdin, BufReader<ChildStdout>)>,
    ready: Ready,
    _folder: Option<TempDir>,
}

impl Process {
    /// Starts the program and waits until it listens.
    pub fn start(program: &Path, options: &Options) -> io::Result<Self> {
        let mut options = options.clone();
        let folder = if options.log.is_none() {
            Some(tempfile::tempdir()?)
        } else {
            None
        };
        if let Some(folder) = &folder {
            options.log = Some(folder.path().join("haply.log"));
        }
        let mut child = Command::new(program)
            .arg("-")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()?;
        let lost = || io::Error::other("the program has no pipes");
        let mut stdin = child.stdin.take().ok_or_else(lost)?;
        let mut stdout = BufReader::new(child.stdout.take().ok_or_else(lost)?);
        writeln!(stdin, "{}", serde_json::to_string(&options)?)?;
        stdin.flush()?;
        let mut line = String::new();
        stdout.read_line(&mut line)?;
        let Some(text) = line.strip_prefix("ready ") else {
            let _ = child.kill();
            let _ = child.wait();
            return Err(io::Error::other(format!(
                "the program did not start: {}",
                line.trim()
            )));
        };
        let ready = serde_json::from_str(text)?;
        Ok(Self {
            child,
            pipes: Mutex::new((stdin, stdout)),
            ready,
            _folder: folder,
        })
    }

    /// Ports and file of the log.
    #[must_use]
    pub fn ready(&self) -> &Ready {
        &self.ready
    }

    /// Address of the simulation channel.
    #[must_use]
    pub fn url(&self) -> String {
        format!("ws://127.0.0.1:{}", self.ready.port)
    }

    /// Address of the channel of events.
    #[must_use]
    pub fn events_url(&self) -> String {
        format!("ws://127.0.0.1:{}", self.ready.events_port)
    }

    /// Carries a request out; the time of the clock of the program in ns.
    pub fn apply(&self, request: &Request) -> Result<u64, RequestError> {
        let program = |error: io::Error| RequestError::Program(error.to_string());
        let text = serde_json::to_string(request).map_err(|error| program(error.into()))?;
        let mut pipes = self
            .pipes
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner);
        writeln!(pipes.0, "{text}")
            .and_then(|()| pipes.0.flush())
            .map_err(program)?;
        let mut line = String::new();
        pipes.1.read_line(&mut line).map_err(program)?;
        let number = line
            .trim()
            .strip_prefix("ok ")
            .and_then(|text| text.parse().ok());
        number.ok_or_else(|| RequestError::Program(line.trim().to_owned()))
    }

    /// Begins or ends a fault.
    pub fn fault(&self, fault: Fault) -> Result<u64, RequestError> {
        self.apply(&Request::Fault(fault))
    }

    /// Log up to a millisecond ago; the program writes it to its file each millisecond.
    pub fn log(&self) -> io::Result<Log> {
        Log::read(&self.ready.log)
    }

    /// Kills the program at once, as a crash of the service.
    pub fn kill(&mut self) -> io::Result<()> {
        self.child.kill()?;
        self.child.wait().map(|_| ())
    }

    /// Ends the program in order and reads its whole log.
    pub fn stop(mut self) -> io::Result<Log> {
        self.apply(&Request::Quit).map_err(io::Error::other)?;
        self.child.wait()?;
        Log::read(&self.ready.log)
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Program beside the running test, in its folder or in one above; none where it was not built.
#[must_use]
pub fn find_program() -> Option<PathBuf> {
    let name = format!("standin-haply{}", std::env::consts::EXE_SUFFIX);
    let here = std::env::current_exe().ok()?;
    here.ancestors()
        .skip(1)
        .take(3)
        .map(|folder| folder.join(&name))
        .find(|path| path.is_file())
}
