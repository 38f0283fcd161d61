//! Tests of the programs from outside, over real sockets and real files: how a test starts a program and reads its output.
//!
//! [`Place`] is a folder for one test, [`Program`] a program of the workspace, [`Ended`] its result, [`Serving`] a running
//! server. The tests themselves stand in `tests/it`.

mod image;
pub mod page;
mod program;

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use sulcus_sessions::{Message, Recording, Row};

pub use image::{Image, USER};
pub use program::Program;

/// Longest wait for a condition.
pub const LIMIT: Duration = Duration::from_secs(120);

/// A folder of its own for one test: recordings, keys and caches go there, nothing else is touched.
pub struct Place {
    folder: tempfile::TempDir,
    /// Image in which the server's programs run; `None`: they run on this machine.
    image: Option<Image>,
    /// Further variables of all programs.
    variables: Vec<(String, String)>,
}

impl Place {
    /// A new empty place.
    pub fn new() -> Self {
        Self {
            folder: tempfile::tempdir().expect("a temporary folder"),
            image: None,
            variables: Vec::new(),
        }
    }

    /// A new empty place, where the server's programs run in an image as its user. Other programs run on this machine.
    pub fn with_image(image: Image) -> Self {
        let place = Self {
            image: Some(image),
            ..Self::new()
        };
        // The scenes that other tests have compiled, for the image's own user.
        let copied = Command::new("cp")
            .arg("-r")
            .arg(cache())
            .arg(place.path("cache"))
            .output();
        let _ = copied.expect("cp starts");
        let owner = format!("{USER}:{USER}");
        let owned = Command::new("chown")
            .args(["-R", &owner])
            .arg(place.folder.path())
            .status();
        assert!(owned.expect("chown starts").success());
        place
    }

    /// Sets a variable for all further programs.
    pub fn set(&mut self, name: &str, value: &str) {
        self.variables.push((name.into(), value.into()));
    }

    /// Takes all variables of [`Place::set`] back.
    pub fn unset(&mut self) {
        self.variables.clear();
    }

    /// A path in it.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// A command that runs in it. All tests share the cache of sphere trees below `target`.
    pub fn command(&self, path: &Path) -> Command {
        let inside = self.image.as_ref();
        let inside = inside.and_then(|image| Some((image, image.path(path)?)));
        // In an image the server's user can read nothing of the root's programs, and owns its folders alone.
        let (mut command, state, cache) = match inside {
            Some((image, inside)) => {
                let command = image.command(&inside, self.folder.path());
                (command, "state", self.path("cache"))
            }
            None if self.image.is_some() => (Command::new(path), "own-state", cache()),
            None => (Command::new(path), "state", cache()),
        };
        command
            .current_dir(self.folder.path())
            .env("SULCUS_STATE_DIR", self.path(state))
            .env("SULCUS_CACHE", cache)
            .envs(self.variables.iter().map(|(name, value)| (name, value)))
            .stdin(Stdio::null());
        command
    }

    /// Runs a debug program to its end.
    pub fn run(&self, program: Program, arguments: &[&str]) -> Ended {
        self.run_path(program.path(), arguments)
    }

    /// Runs the program at `path` to its end.
    pub fn run_path(&self, path: &Path, arguments: &[&str]) -> Ended {
        let output = self
            .command(path)
            .args(arguments)
            .output()
            .expect("the program starts");
        Ended::new(output)
    }

    /// Runs the client to the end of a session with `server`, with further arguments.
    pub fn perform(&self, server: &Serving, arguments: &[&str]) -> Ended {
        self.run(Program::Client, &server.joining(arguments))
    }

    /// Waits until a recording under `folder` of this place has rows, and gives its path.
    ///
    /// # Panics
    /// No session began within [`LIMIT`].
    pub fn begun(&self, folder: &str) -> PathBuf {
        self.until(folder, |rows| !rows.is_empty())
    }

    /// Waits until a recording under `recordings` has a force of more than 0.1 N.
    ///
    /// # Panics
    /// The hand touched nothing within [`LIMIT`].
    pub fn touched(&self) -> PathBuf {
        let touches = |row: &Row| row.wrench[0][..3].iter().any(|x| x.abs() > 0.1);
        self.until("recordings", |rows| rows.iter().any(touches))
    }

    /// Waits until the rows of a recording under `folder` fulfil a condition. The file is still being written.
    fn until(&self, folder: &str, condition: impl Fn(&[Row]) -> bool) -> PathBuf {
        let began = Instant::now();
        loop {
            for file in files_with(&self.path(folder), "mcap") {
                let Ok(recording) = Recording::open(&file) else {
                    continue;
                };
                let row = |message| match message {
                    Ok(Message::Row(row)) => Some(row),
                    _ => None,
                };
                let rows: Vec<Row> = recording.messages().filter_map(row).collect();
                if condition(&rows) {
                    return file;
                }
            }
            assert!(began.elapsed() < LIMIT, "no such rows below {folder}");
            std::thread::sleep(Duration::from_millis(50));
        }
    }

    /// The one recording under `recordings`.
    pub fn recording(&self) -> PathBuf {
        let mut found = files_with(&self.path("recordings"), "mcap");
        assert_eq!(found.len(), 1, "one recording, found {found:?}");
        found.remove(0)
    }
}

impl Default for Place {
    fn default() -> Self {
        Self::new()
    }
}

/// The cache of sphere trees: cargo's setting, else a folder beside the folder of the profile.
fn cache() -> PathBuf {
    let set = std::env::var_os("SULCUS_CACHE").map(PathBuf::from);
    set.unwrap_or_else(|| program::folder().with_file_name("sulcus-cache"))
}

/// Files under `folder` (any depth) with an extension.
pub fn files_with(folder: &Path, extension: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            found.extend(files_with(&path, extension));
        } else if path.extension().is_some_and(|e| e == extension) {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// Sends a signal to a process: `-INT`, as Ctrl-C does, `-TERM`, `-HUP` or `-STOP`.
pub fn signal(name: &str, process: &Child) {
    let sent = Command::new("kill")
        .args([name, &process.id().to_string()])
        .status();
    assert!(sent.expect("kill runs").success());
}

/// How a program ended.
#[derive(Debug)]
pub struct Ended {
    /// Exit code; -1 when a signal ended it.
    pub code: i32,
    /// Standard output.
    pub stdout: String,
    /// Standard error.
    pub stderr: String,
}

impl Ended {
    /// From what a process left.
    pub fn new(output: Output) -> Self {
        Self {
            code: output.status.code().unwrap_or(-1),
            stdout: String::from_utf8_lossy(&output.stdout).into_owned(),
            stderr: String::from_utf8_lossy(&output.stderr).into_owned(),
        }
    }

    /// The JSON object on the last line of standard output.
    pub fn json(&self) -> serde_json::Value {
        let last = self.stdout.lines().last().unwrap_or_default();
        serde_json::from_str(last).unwrap_or_else(|error| panic!("{error}: {self:#?}"))
    }

    /// Asserts success.
    pub fn ok(self) -> Self {
        assert_eq!(self.code, 0, "{self:#?}");
        self
    }

    /// Asserts exit code 2 and one sentence on standard error that names all of `words`.
    pub fn refused(&self, words: &[&str]) {
        assert_eq!(self.code, 2, "{self:#?}");
        let errors: Vec<&str> = self
            .stderr
            .lines()
            .filter(|line| line.starts_with("error: "))
            .collect();
        assert_eq!(errors.len(), 1, "one error line: {self:#?}");
        for word in words {
            assert!(
                errors[0].contains(word),
                "`{word}` is not in: {}",
                errors[0]
            );
        }
        assert!(!self.stderr.contains("panicked"), "{self:#?}");
    }
}

/// All rows of a recording.
pub fn rows(recording: &Recording) -> Vec<Row> {
    let message = |message: Result<Message, _>| match message.expect("a sound message") {
        Message::Row(row) => Some(row),
        _ => None,
    };
    recording.messages().filter_map(message).collect()
}

impl Place {
    /// Starts `sulcus-client run` on `server` for a minute at most, with `--json`; what it says is kept.
    pub fn join(&self, server: &Serving) -> Child {
        self.command(Program::Client.path())
            .args(["run", "--server", &server.address])
            .args(["--ticket", &server.ticket])
            .args(["--duration", "60", "--tick", "server", "--json"])
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the client starts")
    }
}

/// A server in its own process, and what it said first. Killed when dropped.
pub struct Serving {
    /// The process.
    pub process: Child,
    /// Where it listens.
    pub address: String,
    /// What a client needs besides.
    pub ticket: String,
    /// Address of the instructor's console, with `--console`.
    pub console: Option<String>,
}

impl Serving {
    /// Ends the server at once, as a loss of power does.
    pub fn stop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }

    /// What a client is told to join it, with further arguments.
    fn joining<'a>(&'a self, more: &[&'a str]) -> Vec<&'a str> {
        let run = ["run", "--server", &self.address, "--ticket", &self.ticket];
        // On a busy machine the choice of a client would be a matter of chance.
        [&run[..], &["--tick", "server", "--json"], more].concat()
    }
}

impl Drop for Serving {
    fn drop(&mut self) {
        self.stop();
    }
}

impl Place {
    /// Starts `sulcus-server serve` on a free port of loopback with further arguments.
    pub fn serve(&self, arguments: &[&str]) -> Serving {
        self.serve_at("127.0.0.1:0", arguments)
    }

    /// Starts `sulcus-server serve` on an address with further arguments.
    pub fn serve_at(&self, listen: &str, arguments: &[&str]) -> Serving {
        self.serve_by(Program::Server.path(), listen, arguments)
    }

    /// The same with the program at `path`.
    pub fn serve_by(&self, path: &Path, listen: &str, arguments: &[&str]) -> Serving {
        let mut process = self
            .command(path)
            .args(["serve", "--listen", listen, "--json"])
            .args(arguments)
            .stdout(Stdio::piped())
            .spawn()
            .expect("the server starts");
        let mut first = String::new();
        let stdout = process.stdout.take().expect("piped");
        BufReader::new(stdout)
            .read_line(&mut first)
            .expect("a first line");
        let said: serde_json::Value =
            serde_json::from_str(&first).unwrap_or_else(|e| panic!("{e}: {first}"));
        let text = |field: &str| {
            said[field]
                .as_str()
                .unwrap_or_else(|| panic!("`{field}` in {first}"))
                .to_owned()
        };
        Serving {
            address: text("address"),
            ticket: text("ticket"),
            console: said["console"].as_str().map(str::to_owned),
            process,
        }
    }
}
