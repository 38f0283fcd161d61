//! Standard output and standard error whose reader may go away at any time.
//!
//! | what happens | standard output | standard error |
//! |---|---|---|
//! | the reader has closed its end (`| head -1`) | further lines are dropped, the exit code stays | the line is dropped |
//! | a write fails otherwise (a full disk) | an error line at once, then exit code 2 | the line is dropped |
//!
//! The work of a program goes on in any case: a station keeps ticking and recording, a command writes its files.

use std::fmt::Arguments;
use std::io::{ErrorKind, Result, Write};
use std::process::ExitCode;
use std::sync::atomic::{AtomicU8, Ordering};

/// Every line so far was written.
const FINE: u8 = 0;
/// The reader has gone.
const GONE: u8 = 1;
/// A write has failed.
const FAILED: u8 = 2;

/// How standard output of this process has fared.
static STDOUT: AtomicU8 = AtomicU8::new(FINE);

/// Writes a line to standard output, unless an earlier one could not be written: the function of [`crate::say!`].
pub fn say(text: Arguments<'_>) {
    if STDOUT.load(Ordering::Relaxed) == FINE {
        note(write_line(std::io::stdout().lock(), text));
    }
}

/// Writes a line to standard error where that is possible: the function of [`crate::tell!`].
pub fn tell(text: Arguments<'_>) {
    // Nobody else could be told of a failure.
    let _ = write_line(std::io::stderr().lock(), text);
}

/// Takes note of what a library's own write to standard output came to.
pub fn note(written: Result<()>) {
    let Err(error) = written else { return };
    if error.kind() == ErrorKind::BrokenPipe {
        STDOUT.store(GONE, Ordering::Relaxed);
    } else if STDOUT.swap(FAILED, Ordering::Relaxed) == FINE {
        tell(format_args!(
            "error: cannot write to standard output: {error}{}",
            crate::disk::advice(&error)
        ));
    }
}

/// The exit code of a program that would end with `code`: 2 when its output could not be written.
pub fn settle(code: ExitCode) -> ExitCode {
    if STDOUT.load(Ordering::Relaxed) == FAILED {
        ExitCode::from(2)
    } else {
        code
    }
}

/// The exit code of a program that has shown its help (0) or a mistake in its arguments (2), which a library printed.
pub fn usage(printed: Result<()>, is_mistake: bool) -> ExitCode {
    if is_mistake {
        return ExitCode::from(2);
    }
    note(printed);
    settle(ExitCode::SUCCESS)
}

/// Writes the whole line at once, so that lines of several threads do not mix.
fn write_line(mut to: impl Write, text: Arguments<'_>) -> Result<()> {
    let mut line = text.to_string();
    line.push('\n');
    to.write_all(line.as_bytes())?;
    to.flush()
}

/// Standard error for a log: every write succeeds, whether or not anybody reads. (A logger that is told of a failure
/// complains on standard error.)
#[derive(Clone, Copy, Debug, Default)]
pub struct Log;

impl Write for Log {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        let _ = std::io::stderr().lock().write_all(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<()> {
        Ok(())
    }
}
