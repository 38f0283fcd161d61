//! Admission of sessions: a core for each, or a refusal that protects the running ones.

use std::fmt;

use serde::Serialize;

use super::cost::Cost;
use super::machine::Machine;

/// Number of a session, chosen by the caller; unique among the running ones.
pub type SessionId = u64;

/// Shares of the machine that sessions may use. The default is the model of [`crate::capacity`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Model {
    /// Largest share of a core for simulation threads, 0 to 1. Chosen: 25 % below the kernel's throttle.
    pub tick_share: f64,
    /// Largest part of the kernel's real-time share for simulation threads, 0 to 1. Chosen.
    pub of_real_time: f64,
    /// Share of a core for network, recorder and viewers' channels of one session. Chosen until sessions report theirs.
    pub other_share: f64,
    /// Largest share of all cores for everything, 0 to 1. Chosen: the rest is the system's.
    pub total_share: f64,
    /// Largest share of a period for the mean ticks of a core and the longest tick of one session.
    pub period_share: f64,
}

impl Default for Model {
    fn default() -> Self {
        Self {
            tick_share: 0.7,
            of_real_time: 0.9,
            other_share: 0.03,
            total_share: 0.9,
            period_share: 1.0,
        }
    }
}

/// Cost of a session.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Load {
    /// CPU time of a tick.
    pub cost: Cost,
    /// Ticks per second.
    pub rate_hz: u16,
}

impl Load {
    /// Share of a core for the ticks.
    fn share(&self) -> f64 {
        self.cost.mean_us * f64::from(self.rate_hz) / 1e6
    }

    /// Period of a tick, microseconds.
    fn period_us(&self) -> f64 {
        1e6 / f64::from(self.rate_hz.max(1))
    }
}

/// Refusal of a session. The text is a sentence with numbers.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "this machine has room for {room} of these stations ({cost_us:.0} us of CPU time a tick at {rate_hz} Hz, p99.9 {p999_us:.0} us, {cores}); {running} run: end a session, or use another machine"
)]
pub struct NoRoom {
    /// Number of stations with this cost that fit an empty machine.
    pub room: usize,
    /// Number of running sessions.
    pub running: usize,
    /// Mean CPU time of a tick, microseconds.
    pub cost_us: f64,
    /// 99.9th percentile of the CPU time of a tick, microseconds.
    pub p999_us: f64,
    /// Ticks per second.
    pub rate_hz: u16,
    /// Number of cores, in words.
    pub cores: Cores,
}

/// Number of cores for a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cores(pub usize);

impl fmt::Display for Cores {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            1 => f.write_str("1 core"),
            n => write!(f, "{n} cores"),
        }
    }
}

/// State of one core for display.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CoreLoad {
    /// Number of the core.
    pub core: usize,
    /// Number of sessions.
    pub sessions: usize,
    /// Share of the core for their ticks.
    pub tick_share: f64,
}

#[derive(Clone, Debug)]
struct Placed {
    id: SessionId,
    /// Index in the machine's list of cores.
    at: usize,
    load: Load,
}

/// Sessions on the cores of a machine. The owner serialises access, for example by a mutex.
#[derive(Clone, Debug)]
pub struct Capacity {
    machine: Machine,
    model: Model,
    placed: Vec<Placed>,
}

impl Capacity {
    /// Machine without a session.
    pub fn new(machine: Machine, model: Model) -> Self {
        Self {
            machine,
            model,
            placed: Vec::new(),
        }
    }

    /// Admits a session and returns the number of its core: the one with the least load that has room.
    ///
    /// # Errors
    /// No core has room, or the machine as a whole has none.
    pub fn admit(&mut self, id: SessionId, load: Load) -> Result<usize, NoRoom> {
        self.put(id, load).ok_or_else(|| self.refusal(&load))
    }

    /// Admits a session; `None` without room.
    fn put(&mut self, id: SessionId, load: Load) -> Option<usize> {
        let at = self.place(&load)?;
        self.placed.retain(|placed| placed.id != id);
        self.placed.push(Placed { id, at, load });
        self.machine.cores.get(at).copied()
    }

    /// Corrects the cost of a running session, by its own [`super::Estimate`]. No session is ended by a correction.
    pub fn update(&mut self, id: SessionId, cost: Cost) {
        let found = self.placed.iter_mut().find(|placed| placed.id == id);
        if let Some(placed) = found.filter(|_| cost.is_sound()) {
            placed.load.cost = cost;
        }
    }

    /// Corrects the share of a core for network, recorder and viewers' channels of one session, as measured. Values
    /// outside 0 to 1 are ignored.
    pub fn set_other_share(&mut self, share: f64) {
        if (0.0..=1.0).contains(&share) {
            self.model.other_share = share;
        }
    }

    /// Frees the place of a session that has ended.
    pub fn release(&mut self, id: SessionId) {
        self.placed.retain(|placed| placed.id != id);
    }

    /// Number of running sessions.
    pub fn running(&self) -> usize {
        self.placed.len()
    }

    /// Number of further sessions of a cost that have room, at most 1024.
    pub fn room(&self, load: &Load) -> usize {
        let mut copy = self.clone();
        (0..1024)
            .take_while(|k| copy.put(u64::MAX - k, *load).is_some())
            .count()
    }

    /// Load of every core.
    pub fn cores(&self) -> Vec<CoreLoad> {
        let core = |(at, core): (usize, &usize)| CoreLoad {
            core: *core,
            sessions: self.on(at).count(),
            tick_share: self.on(at).map(|placed| placed.load.share()).sum(),
        };
        self.machine.cores.iter().enumerate().map(core).collect()
    }

    fn on(&self, at: usize) -> impl Iterator<Item = &Placed> {
        self.placed.iter().filter(move |placed| placed.at == at)
    }

    /// Index of the core with the least load that has room for a session.
    fn place(&self, load: &Load) -> Option<usize> {
        if !load.cost.is_sound() || load.rate_hz == 0 {
            return None;
        }
        let share_of = |at: usize| -> f64 { self.on(at).map(|placed| placed.load.share()).sum() };
        let mut cores: Vec<(f64, usize)> = (0..self.machine.cores.len())
            .map(|at| (share_of(at), at))
            .collect();
        cores.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        if self.placed.is_empty() {
            return cores.first().map(|(_, at)| *at);
        }
        let ticks: f64 = cores.iter().map(|(share, _)| share).sum();
        let others = self.model.other_share * (self.placed.len() + 1) as f64;
        if ticks + load.share() + others > self.model.total_share * self.machine.quota_cores {
            return None;
        }
        let has_room = |(share, at): &&(f64, usize)| self.fits(*share, *at, load);
        cores.iter().find(has_room).map(|(_, at)| *at)
    }

    /// Whether a core with a tick share has room for a session.
    fn fits(&self, share: f64, at: usize, load: &Load) -> bool {
        let model = &self.model;
        let most = model
            .tick_share
            .min(model.of_real_time * self.machine.real_time_share);
        let all = || self.on(at).map(|placed| &placed.load).chain([load]);
        let means: f64 = all().map(|load| load.cost.mean_us).sum();
        // The longest tick replaces the mean tick of its own session.
        let excess = all().map(|load| load.cost.p999_us - load.cost.mean_us);
        let longest = excess.fold(0.0, f64::max);
        let period = all().map(Load::period_us).fold(f64::INFINITY, f64::min);
        share + load.share() <= most && means + longest <= model.period_share * period
    }

    fn refusal(&self, load: &Load) -> NoRoom {
        let empty = Self::new(self.machine.clone(), self.model);
        NoRoom {
            room: empty.room(load),
            running: self.running(),
            cost_us: load.cost.mean_us,
            p999_us: load.cost.p999_us,
            rate_hz: load.rate_hz,
            cores: Cores(self.machine.cores.len()),
        }
    }
}

#[cfg(test)]
mod tests;
