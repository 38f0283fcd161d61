//! Ticks that a device may still name: what each obeyed, used and sent.

use std::collections::BTreeMap;

use sulcus_core::MAX_TOOLS;

use crate::seen::{Tick, Used};

/// Largest number of ticks in memory: more than a minute at 1 kHz, twice the longest gap of a plan as shipped.
const KEPT: usize = 65_536;

/// Tick in memory.
pub(super) struct Kept {
    /// Newest pose that the tick had.
    pub(super) used: Option<Used>,
    /// Length of each sent force, newtons.
    pub(super) force_n: [f64; MAX_TOOLS],
    /// Whether the tick had a pause.
    pub(super) paused: bool,
    /// Force limit of the tick's input, newtons; 0: the scene's limit alone.
    pub(super) force_limit_n: f64,
    /// Number of ticks under the pause so far, this one included; 0 without a pause.
    pub(super) paused_ticks: u64,
}

/// Memory of the ticks from the newest one of the device on.
#[derive(Default)]
pub(super) struct Memory {
    ticks: BTreeMap<u64, Kept>,
    last: u64,
    paused_ticks: u64,
}

impl Memory {
    /// Keeps a tick.
    pub(super) fn keep(&mut self, tick: &Tick) {
        self.paused_ticks = if tick.paused {
            self.paused_ticks + 1
        } else {
            0
        };
        self.last = self.last.max(tick.tick);
        let kept = Kept {
            used: tick.used,
            force_n: tick.sent.map(|wrench| wrench.force.norm()),
            paused: tick.paused,
            force_limit_n: tick.force_limit_n,
            paused_ticks: self.paused_ticks,
        };
        self.ticks.insert(tick.tick, kept);
        if self.ticks.len() > KEPT {
            self.ticks.pop_first();
        }
    }

    /// Number of ticks under the present pause; 0 without a pause.
    pub(super) fn paused_ticks(&self) -> u64 {
        self.paused_ticks
    }

    /// Number of the newest tick; 0 before the first one.
    pub(super) fn last(&self) -> u64 {
        self.last
    }

    /// Tick of a number, if the memory has it.
    pub(super) fn of(&self, tick: u64) -> Option<&Kept> {
        self.ticks.get(&tick)
    }

    /// Forgets all ticks before a number. A device never goes back.
    pub(super) fn forget_before(&mut self, tick: u64) {
        while let Some(first) = self.ticks.first_entry()
            && *first.key() < tick
        {
            first.remove();
        }
    }
}
