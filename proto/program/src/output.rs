//! Standard output and standard error whose reader may close at any time.
//!
//! | event | standard output | standard error |
//! |---|---|---|
//! | the reader has closed its end (`| head -1`) | further lines are dropped, same exit code | the line is dropped |
//! | a write fails otherwise (a full disk) | an error line at once, then exit code 2 | the line is dropped |
//!
//! A failed write never stops the program: a server keeps ticking and recording, a command still writes its files.

use std::fmt::Arguments;
use std::io::{ErrorKind, Result, Write};
use std::process::ExitCode;
use std::sync::atomic::{AtomicU8, Ordering};

/// State: every line so far was written.
const FINE: u8 = 0;
/// State: the reader has closed its end; further lines are dropped.
const GONE: u8 = 1;
/// State: a write has failed for another reason; further lines are dropped and the exit code is 2.
const FAILED: u8 = 2;

/// State of this process's standard output: `FINE`, `GONE` or `FAILED`.
static STDOUT: AtomicU8 = AtomicU8::new(FINE);

/// Writes a line to standard output; the function behind [`crate::say!`].
///
/// After a failed write, all further lines are dropped.
pub fn say(text: Arguments<'_>) {
    if STDOUT.load(Ordering::Relaxed) == FINE {
        note(write_line(std::io::stdout().lock(), text));
    }
}

/// Writes a line to standard error and ignores write errors; the function behind [`crate::tell!`].
pub fn tell(text: Arguments<'_>) {
    // No other channel is left to report this failure.
    let _ = write_line(std::io::stderr().lock(), text);
}

/// Records the result of a write to standard output, for example by a library.
///
/// The first error other than a broken pipe is reported on standard error.
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

/// Returns the exit code of the program: 2 after a write error on standard output, `code` otherwise.
///
/// A closed reader does not change `code`.
pub fn settle(code: ExitCode) -> ExitCode {
    if STDOUT.load(Ordering::Relaxed) == FAILED {
        ExitCode::from(2)
    } else {
        code
    }
}

/// The same for a code as a number, for a program that ends elsewhere than in `main`.
pub fn settled(code: u8) -> u8 {
    if STDOUT.load(Ordering::Relaxed) == FAILED {
        2
    } else {
        code
    }
}

/// Returns the exit code after the argument parser has printed its message.
///
/// The code is 2 for an error in the arguments (`is_mistake`). For help the code is 0, or 2 when the write `printed`
/// failed.
pub fn usage(printed: Result<()>, is_mistake: bool) -> ExitCode {
    if is_mistake {
        return ExitCode::from(2);
    }
    note(printed);
    settle(ExitCode::SUCCESS)
}

/// Writes text and newline with a single call, so that lines of several threads do not mix, and flushes.
fn write_line(mut to: impl Write, text: Arguments<'_>) -> Result<()> {
    let mut line = text.to_string();
    line.push('\n');
    to.write_all(line.as_bytes())?;
    to.flush()
}

/// Writer to standard error for a logger; every write reports success.
///
/// A logger that receives an error would itself write a complaint to standard error.
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
