//! A virtual display: Xvfb, with xdotool as the person at it.

use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use sulcus_screen::gpu::{Backend, Graphics};

/// Whether a graphics adapter is here; the error names the reason.
pub fn adapter() -> Result<(), String> {
    let opened = Graphics::headless(Backend::Any);
    opened.map(|_| ()).map_err(|error| error.to_string())
}

/// Turn of a test that draws in software: one at a time.
///
/// A window beside other drawing has frames of a second. Lengths of key presses are not known better than that.
pub type Turn = MutexGuard<'static, ()>;

/// Waits for the turn to draw.
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
    /// Starts a display with a number of its own, when no other test draws.
    pub fn start() -> Result<Self, String> {
        static STARTED: AtomicU32 = AtomicU32::new(0);
        let turn = turn();
        let number = STARTED.fetch_add(1, Ordering::Relaxed);
        let name = format!(":{}", 100 + (4 * std::process::id() + number) % 30_000);
        let server = Command::new("Xvfb")
            .args([&name, "-screen", "0", "1280x800x24", "-nolisten", "tcp"])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .map_err(|error| format!("Xvfb: {error}"))?;
        let display = Self {
            server,
            name,
            _turn: turn,
        };
        let begin = Instant::now();
        while !display.answers()? {
            if begin.elapsed() > Duration::from_secs(60) {
                return Err("Xvfb does not answer".into());
            }
            std::thread::sleep(Duration::from_millis(50));
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

    fn answers(&self) -> Result<bool, String> {
        let asked = self
            .command(&["getmouselocation"])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .status();
        asked
            .map(|status| status.success())
            .map_err(|error| format!("xdotool: {error}"))
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
