//! `sulcus-review live` and `sulcus-review viewer`: child processes of a server's console.

use std::io::{BufReader, BufWriter, stdin, stdout};
use std::process::ExitCode;

use crate::live::{draw, write_viewer};

/// Niceness: a server's stations come first.
const NICE: i32 = 19;

/// Draws a running session from standard input to standard output.
pub(super) fn run() -> anyhow::Result<ExitCode> {
    idle();
    draw(
        BufReader::new(stdin().lock()),
        BufWriter::new(stdout().lock()),
    )?;
    Ok(ExitCode::SUCCESS)
}

/// Writes the files of the web viewer to standard output.
pub(super) fn viewer() -> anyhow::Result<ExitCode> {
    idle();
    write_viewer(BufWriter::new(stdout().lock()))?;
    Ok(ExitCode::SUCCESS)
}

/// Before the first thread starts, so that all of them have it.
fn idle() {
    // Without the right to it the program has the niceness of its parent.
    let _ = rustix::process::nice(NICE);
}
