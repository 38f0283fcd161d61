//! The simulation thread of a server that ticks: ticks at the scene's rate on absolute deadlines. A missed grid point
//! is skipped, counted and recorded as input. The thread never runs two ticks to catch up.

use std::sync::Arc;
use std::thread::JoinHandle;

use sulcus_core::Scene;
use sulcus_link::Bell;
use sulcus_link::clock::{Clock, sleep_until};
use triple_buffer::{Input, Output};

use crate::capacity::pin_to;
use crate::session::detail::Detail;
use crate::session::handoff::{Flags, PoseIn, Pressed, Progress, WrenchOut};
use crate::session::levels::Levels;
use crate::session::metrics::Metrics;
use crate::session::precedence::Places;
use crate::session::queue::Rings;
use crate::session::realtime;

mod ticker;

pub(super) use ticker::Ticker;

/// Data that the simulation thread owns.
pub(crate) struct Simulation {
    pub scene: Arc<Scene>,
    pub poses: Output<Option<PoseIn>>,
    /// Pause and force limit of both sides.
    pub levels: Levels,
    /// Buttons pressed since the last tick.
    pub pressed: Arc<Pressed>,
    pub wrenches: Input<WrenchOut>,
    pub bell: Bell,
    pub flags: Arc<Flags>,
    pub progress: Arc<Progress>,
    /// Level of detail of tissue.
    pub detail: Detail,
    /// Source of the times.
    pub clock: Clock,
    /// Whether to request real-time scheduling and locked memory.
    pub real_time: bool,
    /// Places behind the other stations of the server.
    pub places: Arc<Places>,
    /// Core on which the thread runs; `None`: any.
    pub core: Option<usize>,
}

/// Reports the end of the thread to the network, even after a panic.
struct Leaving(Arc<Flags>, Bell);

impl Drop for Leaving {
    fn drop(&mut self) {
        Flags::raise(&self.0.simulation_over);
        self.1.ring();
    }
}

impl Simulation {
    /// Starts the thread; it ends when [`Flags::stop`] is raised. Its clock must be that of the system.
    pub fn spawn(self, rings: Rings) -> std::io::Result<JoinHandle<Metrics>> {
        // Allocated here: the thread allocates nothing after its first tick.
        let metrics = Metrics::new();
        std::thread::Builder::new()
            .name("sulcus-sim".into())
            .spawn(move || self.run(rings, metrics))
    }

    fn run(self, rings: Rings, metrics: Metrics) -> Metrics {
        let _leaving = Leaving(self.flags.clone(), self.bell.clone());
        let (flags, real_time) = (self.flags.clone(), self.real_time);
        let core = self.core;
        let mut ticker = Ticker::new(self, rings, metrics);
        if let Some(core) = core
            && let Err(error) = pin_to(core)
        {
            tracing::warn!("simulation is not bound to core {core}: {error}");
        }
        // After all allocations, so that their memory is locked. The grid begins afterwards.
        let is_real_time = real_time && realtime::enter();
        sulcus_link::schedule::exact_timers();
        ticker.begin(is_real_time);
        let mut next_ns = ticker.next_ns();
        while !Flags::is_up(&flags.stop) {
            sleep_until(next_ns);
            next_ns = ticker.step();
        }
        ticker.into_metrics()
    }
}

#[cfg(test)]
pub(crate) mod tests;
