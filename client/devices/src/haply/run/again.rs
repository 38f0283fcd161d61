//! Loss of the connection, and the attempts to connect again.

use sulcus_link::clock::monotonic_ns;

use super::Run;
use crate::State;
use crate::haply::back_off::BackOff;
use crate::haply::connect::{Connected, NoConnection};
use crate::haply::flow::Flow;

impl Run<'_> {
    /// Gives the connection up.
    pub(super) fn lose(&mut self, cause: &str) {
        self.device.flow = None;
        self.back_off = BackOff::new();
        self.retry_ns = monotonic_ns() + self.back_off.next();
        if !self.rested {
            tracing::warn!(
                "the connection to the Haply service at {} is lost ({cause}): the run goes on without a pose and \
                 connects again",
                self.device.address
            );
        }
    }

    /// Takes a new connection, or asks for one.
    pub(super) fn connect(&mut self) {
        match self.device.connector.result() {
            Some(Ok(connected)) => self.take(connected),
            Some(Err(no)) => self.refuse(&no),
            None if !self.device.connector.is_busy() && monotonic_ns() >= self.retry_ns => {
                self.device.connector.ask();
            }
            None => {}
        }
    }

    fn take(&mut self, connected: Connected) {
        let ids = self.device.hands.iter().map(|hand| hand.id());
        if let Some(sentence) = connected.against(ids) {
            let state = State::Error;
            self.refuse(&NoConnection { state, sentence });
            return;
        }
        for hand in &mut self.device.hands {
            hand.begin(&connected.inventory);
        }
        tracing::info!(
            "the Haply service at {} is connected again",
            self.device.address
        );
        self.warned.refused.clear();
        self.device.flow = Some(Flow::new(connected.line, connected.field, true));
    }

    /// Waits longer after a failed attempt. The same sentence is logged once.
    fn refuse(&mut self, no: &NoConnection) {
        self.retry_ns = monotonic_ns() + self.back_off.next();
        if no.state != State::NoLibrary && self.warned.refused != no.sentence {
            tracing::warn!("{}", no.sentence);
            self.warned.refused.clone_from(&no.sentence);
        }
    }
}
