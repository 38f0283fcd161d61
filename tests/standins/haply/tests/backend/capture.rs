//! Sentences that the back-end logs.

use std::io::{self, Write};
use std::sync::{Mutex, MutexGuard, Once, PoisonError};

static LINES: Mutex<Vec<String>> = Mutex::new(Vec::new());
static START: Once = Once::new();

/// Word whose sentence makes the logging thread panic; empty for none.
static PANIC: Mutex<&str> = Mutex::new("");

struct Capture;

impl Write for Capture {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let line = String::from_utf8_lossy(bytes).trim().to_owned();
        let word = *PANIC.lock().unwrap_or_else(PoisonError::into_inner);
        lines().push(line.clone());
        assert!(word.is_empty() || !line.contains(word), "as the test wants");
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn lines() -> MutexGuard<'static, Vec<String>> {
    LINES.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Starts the capture, and forgets what was logged before.
pub fn clear() {
    START.call_once(|| {
        tracing_subscriber::fmt()
            .with_ansi(false)
            .without_time()
            .with_max_level(tracing::Level::INFO)
            .with_writer(|| Capture)
            .init();
    });
    panic_on("");
    lines().clear();
}

/// Lets the thread panic that logs a sentence with `word`.
pub fn panic_on(word: &'static str) {
    *PANIC.lock().unwrap_or_else(PoisonError::into_inner) = word;
}

/// Warnings since [`clear`], but for that of a busy machine.
pub fn warnings() -> Vec<String> {
    let all = lines();
    all.iter()
        .filter(|line| line.starts_with("WARN") && !line.contains("messages a second"))
        .cloned()
        .collect()
}
