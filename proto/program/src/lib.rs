//! Process behaviour common to all programs of this workspace.
//!
//! The crate covers output whose reader may close, write errors of a full disk instead of a signal, and file names as
//! text. Its only dependencies are `libc` and `serde`. The programs share no other crate that may write to a terminal:
//! `sulcus-proto` does no file access, and the core does no I/O.
//!
//! - [`say!`] writes a line to standard output, [`tell!`] a line to standard error. Neither panics.
//! - [`begin`] is the first call of every program, [`output::settle`] the last.
//! - [`PathText::shown`] formats a path as text without loss.
//! - [`ProgressLines`] writes the progress of a long task.

#![cfg_attr(not(test), warn(clippy::print_stdout, clippy::print_stderr))]

pub mod disk;
pub mod output;
pub mod path;
pub mod progress;

pub use path::PathText;
pub use progress::ProgressLines;

/// Ignores SIGXFSZ in this process; the first call of every program.
///
/// A write beyond a file-size limit (`ulimit -f`) then fails with `EFBIG`. The default action of the signal kills the
/// process. Systems without the signal need nothing.
pub fn begin() {
    #[cfg(unix)]
    // SAFETY: ignoring a signal installs no handler and touches no memory of this process.
    unsafe {
        libc::signal(libc::SIGXFSZ, libc::SIG_IGN);
    }
}

/// Writes a line to standard output, as `println!` does, but without a panic. See [`output`] for write errors.
#[macro_export]
macro_rules! say {
    ($($text:tt)*) => {
        $crate::output::say(::std::format_args!($($text)*))
    };
}

/// Writes a line to standard error, as `eprintln!` does, but without a panic. See [`output`] for write errors.
#[macro_export]
macro_rules! tell {
    ($($text:tt)*) => {
        $crate::output::tell(::std::format_args!($($text)*))
    };
}
