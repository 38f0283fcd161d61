//! A virtual display: Xvfb, with xdotool as the person at it.

use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::channel;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use sulcus_screen::gpu::{Backend, Graphics};

/// Xvfb on a free number. The server writes the number when clients may connect.
const XVFB: &str =
    "exec Xvfb -displayfd 3 -screen 0 1280x800x24 -nolisten tcp -noreset 3>&1 >/dev/null";
/// Longest start of the server.
const START: Duration = Duration::from_secs(120);

/// Whether a graphics adapter is here; the error names the reason.
pub fn adapter() -> Result<(), String> {
    let opened = Graphics::headless(Backend::Any);
    opened.map(|_| ()).map_err(|error| error.to_string())
}

/// Turn of a test that draws in software or computes for seconds: one at a time.
///
/// A window beside other heavy work has frames of a second.
pub type Turn = MutexGuard<'static, ()>;

/// Waits for the turn.
pub fn turn() -> Turn {
    static TURN: Mutex<()> = Mutex::new(());
    TURN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Running Xvfb; it ends with this value.
pub struct VirtualDisplay {
    server: Child,
    name: String,
    _turn: Turn,
}

impl VirtualDisplay {
    /// Starts a display on a free number, when no other test draws.
    pub fn start() -> Result<Self, String> {
        let turn = turn();
        let mut server = Command::new("sh")
            .args(["-c", XVFB])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .map_err(|error| format!("sh: {error}"))?;
        let stdout = server.stdout.take().expect("piped");
        let mut display = Self {
            server,
            name: String::new(),
            _turn: turn,
        };
        let (to, number) = channel();
        std::thread::spawn(move || {
            let mut line = String::new();
            let _ = BufReader::new(stdout).read_line(&mut line);
            let _ = to.send(line);
        });
        let number = number.recv_timeout(START).unwrap_or_default();
        if number.trim().is_empty() {
            return Err("Xvfb does not start".into());
        }
        display.name = format!(":{}", number.trim());
        let asked = display.command(&["getmouselocation"]).output();
        let asked = asked.map_err(|error| format!("xdotool: {error}"))?;
        if !asked.status.success() {
            return Err("Xvfb does not answer".into());
        }
        Ok(display)
    }

    /// Name of the display.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Kills the server at once, with all its windows.
    pub fn kill(&mut self) {
        self.server.kill().expect("a running server");
        self.server.wait().expect("an ended server");
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new("xdotool");
        command.env("DISPLAY", &self.name).args(arguments);
        command
    }

    /// Performs a command of xdotool.
    pub fn tool(&self, arguments: &[&str]) {
        let done = self.command(arguments).status().expect("xdotool");
        assert!(done.success(), "xdotool {arguments:?}");
    }

    /// Number of the window with this title.
    pub fn window(&self, title: &str) -> Option<String> {
        let found = self.command(&["search", "--name", title]).output().ok()?;
        let text = String::from_utf8(found.stdout).ok()?;
        text.lines().next().map(str::to_owned)
    }
}

impl Drop for VirtualDisplay {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}
