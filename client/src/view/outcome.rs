//! Exit code of a session, for a thread that cannot join the session's thread.

use std::sync::{Arc, Condvar, Mutex, PoisonError};

/// Exit code of a session whose thread panicked, as of a panic of the main thread.
const PANICKED: u8 = 101;

/// Exit code of a session, once the session has ended.
#[derive(Debug, Default)]
pub struct Outcome {
    code: Mutex<Option<u8>>,
    ended: Condvar,
}

impl Outcome {
    /// Session's end of an outcome.
    pub fn ending(outcome: &Arc<Self>) -> Ending {
        Ending(outcome.clone())
    }

    /// Waits for the end of the session, and returns its exit code.
    pub fn wait(&self) -> u8 {
        let mut code = self.code.lock().unwrap_or_else(PoisonError::into_inner);
        loop {
            if let Some(code) = *code {
                return code;
            }
            code = self
                .ended
                .wait(code)
                .unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Sets the code, if the session has not ended before.
    fn set(&self, new: u8) {
        let mut code = self.code.lock().unwrap_or_else(PoisonError::into_inner);
        code.get_or_insert(new);
        self.ended.notify_all();
    }
}

/// Session's end of an outcome. A session that panics drops the end.
pub struct Ending(Arc<Outcome>);

impl Ending {
    /// Ends the session with a code.
    pub fn set(&self, code: u8) {
        self.0.set(code);
    }
}

impl Drop for Ending {
    fn drop(&mut self) {
        self.0.set(PANICKED);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_end_counts_and_a_panic_is_an_end() {
        let outcome = Arc::new(Outcome::default());
        let ending = Outcome::ending(&outcome);
        let waiting = outcome.clone();
        let waits = std::thread::spawn(move || waiting.wait());
        ending.set(1);
        drop(ending);
        assert_eq!((waits.join().expect("a code"), outcome.wait()), (1, 1));
        let outcome = Arc::new(Outcome::default());
        drop(Outcome::ending(&outcome));
        assert_eq!(outcome.wait(), PANICKED);
    }
}
