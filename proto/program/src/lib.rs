//! Conduct that all programs of this workspace share, whatever they do: output whose reader may go away, a full disk
//! instead of a signal, names of files in text.
//!
//! A crate of its own, with no dependency but `libc` and `serde`, because the programs share no other crate that may write to a
//! terminal: `sulcus-proto` knows no files, and the core is pure.
//!
//! - [`say!`] writes a line to standard output, [`tell!`] one to standard error. Neither panics.
//! - [`begin`] comes first in every program, [`output::settle`] last.
//! - [`PathText::shown`] is a path as text, without loss.

#![cfg_attr(not(test), warn(clippy::print_stdout, clippy::print_stderr))]

pub mod disk;
pub mod output;
pub mod path;
pub mod progress;

pub use path::PathText;
pub use progress::ProgressLines;

/// Prepares the process: the first call of every program.
///
/// A write beyond a limit on the size of files (`ulimit -f`, a quota) then fails with `EFBIG`, as a write to a full disk
/// fails with `ENOSPC`. By default the system kills the process with SIGXFSZ instead.
pub fn begin() {
    // SAFETY: ignoring a signal installs no handler and touches no memory of this process.
    unsafe {
        libc::signal(libc::SIGXFSZ, libc::SIG_IGN);
    }
}

/// Writes a line to standard output, as `println!` does, but never panics: see [`output`].
#[macro_export]
macro_rules! say {
    ($($text:tt)*) => {
        $crate::output::say(::std::format_args!($($text)*))
    };
}

/// Writes a line to standard error, as `eprintln!` does, but never panics: see [`output`].
#[macro_export]
macro_rules! tell {
    ($($text:tt)*) => {
        $crate::output::tell(::std::format_args!($($text)*))
    };
}
