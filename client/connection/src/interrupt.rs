//! Ctrl-C and SIGTERM: the session is ended properly; a second one ends the program.

use std::sync::atomic::{AtomicBool, Ordering};

use sulcus_program::tell;

static ASKED: AtomicBool = AtomicBool::new(false);

/// Exit code of a program ended by SIGINT, as shells give it.
const ENDED_BY_SIGNAL: i32 = 130;

/// Listens from now on.
pub fn listen() {
    let heard = ctrlc::set_handler(|| {
        if ASKED.swap(true, Ordering::Relaxed) {
            std::process::exit(ENDED_BY_SIGNAL);
        }
        tell!("ending the session; once more to stop at once");
    });
    if let Err(error) = heard {
        tracing::warn!("Ctrl-C will end the program at once: {error}");
    }
}

/// Whether someone asked to end.
pub fn asked() -> bool {
    ASKED.load(Ordering::Relaxed)
}
