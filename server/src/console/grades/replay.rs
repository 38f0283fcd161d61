//! Replay of some seconds about a moment, drawn by the program `sulcus-review` as a file for the viewer.

use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use sulcus_sessions::cli::sibling;

use super::child::{last_words, wait};
use super::store::Store;

/// Time before the moment, milliseconds. Chosen: a viewer sees how the hand came there.
const BEFORE_MS: u64 = 3000;
/// Time after the moment, milliseconds.
const AFTER_MS: u64 = 4000;

/// File for the viewer. `stop` ends the program.
///
/// # Errors
/// Sentence for the person: the program is missing, or has drawn nothing.
pub(super) fn drawn(
    store: &Store,
    recording: &Path,
    at_ms: u64,
    stop: &AtomicBool,
) -> Result<Vec<u8>, String> {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    let program = sibling::find("sulcus-review", sibling::BUILDS_REVIEW);
    let program = program.map_err(|error| error.to_string())?;
    let seconds = |ms: u64| format!("{:.3}", ms as f64 * 1e-3);
    let count = COUNT.fetch_add(1, Ordering::Relaxed);
    let name = format!("replay-{}-{count}.rrd", std::process::id());
    let out = store.folder().join(name);
    let told = out.with_extension("told");
    let failed = |error: std::io::Error| format!("the replay cannot be drawn: {error}");
    let started = std::fs::File::create(&told).and_then(|errors| {
        Command::new(program)
            .arg(recording)
            .args(["--from", &seconds(at_ms.saturating_sub(BEFORE_MS))])
            .args(["--to", &seconds(at_ms + AFTER_MS)])
            .arg("--no-open")
            .arg("--out")
            .arg(&out)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(errors)
            .spawn()
    });
    let ended = started.map_err(failed).and_then(|child| wait(child, stop));
    let bytes = std::fs::read(&out);
    let words = std::fs::read_to_string(&told).unwrap_or_default();
    for file in [&out, &told] {
        // A program that failed may have left none.
        let _ = std::fs::remove_file(file);
    }
    ended?;
    bytes.map_err(|_| last_words(&words))
}
