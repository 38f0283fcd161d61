//! Many sessions by seed, on all cores.

use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::faults::MS;
use crate::run::{Name, Outcome, Run};
use crate::scene::small;

/// Sessions to run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Class {
    /// First seed.
    pub from: u64,
    /// Last seed.
    pub to: u64,
    /// Number of stations of each seed.
    pub stations: u32,
    /// Length of each session, seconds of virtual time.
    pub seconds: u64,
}

impl Class {
    /// Runs all sessions, and gives their outcomes in the order of their names. `done` hears of each one.
    ///
    /// # Errors
    /// A recording cannot be opened: one sentence.
    pub fn run(&self, done: impl Fn(&Outcome) + Sync) -> Result<Vec<Outcome>, String> {
        let count = (self.to + 1).saturating_sub(self.from) * u64::from(self.stations);
        let (next, outcomes) = (AtomicU64::new(0), Mutex::new(Ok(Vec::new())));
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        std::thread::scope(|scope| {
            for _ in 0..threads {
                scope.spawn(|| {
                    loop {
                        let number = next.fetch_add(1, Ordering::Relaxed);
                        if number >= count {
                            return;
                        }
                        let name = Name {
                            seed: self.from + number / u64::from(self.stations),
                            station: (number % u64::from(self.stations)) as u32,
                        };
                        let outcome = session(name, self.seconds);
                        let mut outcomes = outcomes.lock().expect("no session panicked");
                        match (&mut *outcomes, outcome) {
                            (Ok(outcomes), Ok(outcome)) => {
                                done(&outcome);
                                outcomes.push(outcome);
                            }
                            (all, Err(text)) => *all = Err(text),
                            (Err(_), _) => return,
                        }
                    }
                });
            }
        });
        let mut outcomes = outcomes.into_inner().expect("no session panicked")?;
        outcomes.sort_by_key(|outcome| outcome.name);
        Ok(outcomes)
    }
}

/// Runs the session of a name for `seconds` of virtual time, with a recording that is removed afterwards.
///
/// # Errors
/// The recording cannot be opened: one sentence.
pub fn session(name: Name, seconds: u64) -> Result<Outcome, String> {
    let folder = tempfile::tempdir().map_err(|error| error.to_string())?;
    let run = Run::new(name, seconds * 1000 * MS, &small(), folder.path())?;
    Ok(run.finish(folder.path()))
}

/// Hash of the events of all outcomes, in their order.
pub fn hash(outcomes: &[Outcome]) -> [u8; 32] {
    let mut hasher = blake3::Hasher::new();
    for outcome in outcomes {
        hasher.update(&outcome.hash);
        hasher.update(&outcome.recording);
    }
    *hasher.finalize().as_bytes()
}
