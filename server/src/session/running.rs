//! Threads of a session, simulation and recorder, as the station uses them.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::thread::JoinHandle;

use sulcus_link::clock::Clock;
use sulcus_proto::SessionSummary;
use sulcus_proto::control::EndReason;

use crate::outlets::opening::Opening;
use crate::outlets::recording::Report;
use crate::session::ending;
use crate::session::handoff::{Flags, Provoked};
use crate::session::loops::{Begin, Loops, Ticks, no_start};
use crate::session::metrics::Metrics;
use crate::session::ports::Ports;

/// Stops the simulation when a session is dropped without [`Running::finish`].
struct Abandoned(Arc<Flags>);

impl Drop for Abandoned {
    fn drop(&mut self) {
        Flags::raise(&self.0.stop);
    }
}

/// A running session: handles of its threads.
pub(crate) struct Running {
    file_name: String,
    _abandoned: Abandoned,
    ports: Arc<Ports>,
    simulation: JoinHandle<Metrics>,
    recorder: JoinHandle<Report>,
}

impl Running {
    /// Opens the recording, then starts both threads. Blocks while the scene is written, and copied if its couplings
    /// change.
    ///
    /// # Errors
    /// The reason of the end and one sentence: the couplings do not fit the scene, the recording cannot be written, or
    /// a thread cannot start.
    pub fn start(asked: Opening, begin: Begin) -> Result<Self, (EndReason, String)> {
        let loops = Loops::open(asked, begin, Clock::System)?;
        Self::spawn(loops).map_err(no_start)
    }

    /// Starts the threads of `loops`.
    fn spawn(loops: Loops) -> std::io::Result<Self> {
        let Loops {
            ports,
            ticks,
            recorder,
        } = loops;
        let file_name = recorder.file_name().to_owned();
        let recorder = recorder.spawn()?;
        // After an error the recorder's channel is closed: the recorder ends, and the file has no end record.
        let simulation = match ticks {
            Ticks::Server(ticks) => {
                let (simulation, rings) = *ticks;
                simulation.spawn(rings)?
            }
            Ticks::Hand(ticks) => ticks.spawn()?,
        };
        Ok(Self {
            file_name,
            _abandoned: Abandoned(ports.flags.clone()),
            ports,
            simulation,
            recorder,
        })
    }

    /// File name of the recording.
    pub fn file_name(&self) -> &str {
        &self.file_name
    }

    /// Hand-overs for the student's connections.
    pub fn ports(&self) -> &Arc<Ports> {
        &self.ports
    }

    /// Provokes a fault, for a test.
    pub fn provoke(&self, fault: Provoked) {
        let flags = self.ports.flags();
        flags.provoked.store(fault as u8, Ordering::Relaxed);
    }

    /// Stops the simulation, then finishes and signs the recording. Blocks until both threads have ended.
    ///
    /// Completes `summary`, which holds the reason of the end and the gaps, and returns it with a short text for the
    /// goodbye. After the failure of a thread the summary has another reason.
    pub fn finish(self, summary: SessionSummary) -> (SessionSummary, String) {
        let ticks = || self.simulation.join().ok();
        let recorder = || self.recorder.join().ok();
        ending::finish(&self.ports, summary, ticks, recorder)
    }
}

#[cfg(test)]
mod tests;
