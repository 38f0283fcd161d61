//! Interrupts: Ctrl-C, SIGTERM or a hang-up. The first ends the session with a stop, the second ends the program at
//! once.

use std::sync::atomic::{AtomicBool, Ordering};

use sulcus_program::tell;

static ASKED: AtomicBool = AtomicBool::new(false);

/// Exit code after a second interrupt: that of a program ended by SIGINT in a shell.
const ENDED_BY_SIGNAL: i32 = 130;

/// Installs the handler of interrupts. Without the handler a warning is logged, and an interrupt ends the program at
/// once.
pub fn listen() {
    let heard = ctrlc::set_handler(|| {
        if ASKED.swap(true, Ordering::Relaxed) {
            std::process::exit(ENDED_BY_SIGNAL);
        }
        tell!("ending the session; press Ctrl-C again to stop at once");
    });
    if let Err(error) = heard {
        tracing::warn!("Ctrl-C ends the program at once, without an end of the session: {error}");
    }
}

/// Whether an interrupt has arrived.
pub fn asked() -> bool {
    ASKED.load(Ordering::Relaxed)
}
