//! Thread that connects again, while the thread of the hands keeps its period.

use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Duration;

use super::address::Address;
use super::connect::{Connected, NoConnection, connect};

/// Time limit of one attempt.
const MOST: Duration = Duration::from_millis(1_500);

/// Thread that connects on request. The thread ends with the value.
#[derive(Debug)]
pub(super) struct Connector {
    ask: Sender<()>,
    results: Receiver<Result<Connected, NoConnection>>,
    busy: bool,
}

impl Connector {
    /// Starts the thread.
    pub(super) fn start(address: &Address) -> std::io::Result<Self> {
        let (ask, asked) = channel();
        let (sender, results) = channel();
        let address = address.clone();
        let work = move || {
            while asked.recv().is_ok() && sender.send(connect(&address, MOST)).is_ok() {}
        };
        std::thread::Builder::new()
            .name("haply-connect".into())
            .spawn(work)?;
        Ok(Self {
            ask,
            results,
            busy: false,
        })
    }

    /// Asks for one attempt.
    pub(super) fn ask(&mut self) {
        self.busy = self.ask.send(()).is_ok();
    }

    /// Whether an attempt is under way.
    pub(super) fn is_busy(&self) -> bool {
        self.busy
    }

    /// Result of an attempt that has ended.
    pub(super) fn result(&mut self) -> Option<Result<Connected, NoConnection>> {
        let result = self.results.try_recv().ok();
        self.busy &= result.is_none();
        result
    }
}
