//! A running program with a window: its lines, and waits for them.

use std::io::{BufRead, BufReader, Read};
use std::process::{Child, Command, Output};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use crate::display::VirtualDisplay;
use crate::{PATIENCE, until};

/// Script of [`Running::at_once`]: number of the program, then the commands of xdotool. A program that has ended is not
/// waited for.
const AT_ONCE: &str = r#"
program=$1
shift
kill -STOP "$program" || exit 1
until grep -q '^State:.[TZ]' "/proc/$program/status"; do :; done
xdotool "$@"
code=$?
kill -CONT "$program"
exit $code
"#;

/// Lines that a program has written so far.
type Lines = Arc<Mutex<String>>;

/// Running program; it ends with this value.
pub struct Running {
    child: Child,
    /// Lines of standard output and of standard error.
    lines: [Lines; 2],
    readers: Vec<JoinHandle<()>>,
    /// End of the text that was heard last, in the lines of standard error.
    heard: usize,
}

impl Running {
    /// Starts a program whose two outputs are pipes.
    pub fn start(command: &mut Command) -> Self {
        let mut child = command.spawn().expect("started");
        let stdout = child.stdout.take().expect("piped");
        let stderr = child.stderr.take().expect("piped");
        let lines: [Lines; 2] = Default::default();
        let readers = vec![collect(stdout, &lines[0]), collect(stderr, &lines[1])];
        Self {
            child,
            lines,
            readers,
            heard: 0,
        }
    }

    /// Waits for a text on standard error, behind the text of the call before.
    pub fn hears(&mut self, text: &str) {
        let begin = Instant::now();
        loop {
            // Asked before the search: readers that have ended have kept all lines.
            let has_ended = self.readers.iter().all(JoinHandle::is_finished);
            let told = locked(&self.lines[1]);
            if let Some(at) = told[self.heard..].find(text) {
                self.heard += at + text.len();
                return;
            }
            let is_late = has_ended || begin.elapsed() > PATIENCE;
            assert!(!is_late, "`{text}` is missing in: {told}");
            drop(told);
            std::thread::sleep(Duration::from_millis(50));
        }
    }

    /// Waits for the JSON object on standard output.
    pub fn prints(&self) {
        let has_object = || locked(&self.lines[0]).contains('{').then_some(());
        until("object on standard output", has_object);
    }

    /// Whether the program has not ended.
    pub fn is_running(&mut self) -> bool {
        self.child.try_wait().expect("a child").is_none()
    }

    /// Performs commands of xdotool while the program is stopped. All their events reach the window at one time,
    /// between two pictures, however slow pictures are.
    pub fn at_once(&self, screen: &VirtualDisplay, commands: &[&str]) {
        let done = Command::new("sh")
            .args(["-c", AT_ONCE, "sh", &self.child.id().to_string()])
            .args(commands)
            .env("DISPLAY", screen.name())
            .status()
            .expect("sh");
        assert!(done.success(), "xdotool {commands:?}");
    }

    /// Sends SIGINT, as Ctrl-C does.
    pub fn interrupt(&self) {
        let sent = Command::new("kill")
            .args(["-INT", &self.child.id().to_string()])
            .status()
            .expect("kill");
        assert!(sent.success());
    }

    /// Waits for the end, and returns all lines.
    pub fn ended(mut self) -> Output {
        let begin = Instant::now();
        let status = loop {
            if let Some(status) = self.child.try_wait().expect("a child") {
                break status;
            }
            assert!(
                begin.elapsed() < PATIENCE,
                "the program goes on: {}",
                locked(&self.lines[1])
            );
            std::thread::sleep(Duration::from_millis(50));
        };
        for reader in self.readers.drain(..) {
            reader.join().expect("all lines");
        }
        let [stdout, stderr] = self
            .lines
            .each_ref()
            .map(|lines| locked(lines).clone().into_bytes());
        Output {
            status,
            stdout,
            stderr,
        }
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Keeps the lines of an output until its end, on a thread of its own.
fn collect(from: impl Read + Send + 'static, to: &Lines) -> JoinHandle<()> {
    let to = to.clone();
    std::thread::spawn(move || {
        for line in BufReader::new(from).split(b'\n').map_while(Result::ok) {
            let mut kept = locked(&to);
            kept.push_str(&String::from_utf8_lossy(&line));
            kept.push('\n');
        }
    })
}

fn locked(lines: &Lines) -> MutexGuard<'_, String> {
    lines.lock().unwrap_or_else(PoisonError::into_inner)
}
