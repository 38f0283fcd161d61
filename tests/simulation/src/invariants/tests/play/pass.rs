//! Device of the model: one pass with its gate and slew limit.

use std::collections::VecDeque;

use super::{MS, Play, slewed, wrenches};
use crate::seen::{Pass, Seen};

impl Play {
    /// Takes the wrenches that have arrived, and displays the newest one through the gate.
    pub(super) fn pass(&mut self) {
        let at_ns = self.now_ms * MS + 500_000;
        let before_ns = self.newest.map(|(newest, _)| newest.arrived_ns);
        let mut waiting = VecDeque::new();
        let mut arrived: Vec<_> = Vec::new();
        for packet in self.on_the_way.drain(..) {
            if packet.0 <= at_ns {
                arrived.push(packet)
            } else {
                waiting.push_back(packet)
            }
        }
        self.on_the_way = waiting;
        arrived.sort_by_key(|(arrived_ns, _, _)| *arrived_ns);
        for (_, newest, force_n) in arrived {
            if self
                .newest
                .is_none_or(|(before, _)| newest.tick > before.tick)
            {
                self.newest = Some((newest, force_n));
            }
        }
        let mut target = 0.0;
        if let Some((newest, force_n)) = self.newest {
            let interruption = before_ns.map_or(u64::MAX, |before| newest.arrived_ns - before);
            if interruption > 20 * MS {
                self.rise_ms = if interruption > 50 * MS { 500.0 } else { 100.0 };
            }
            let course = (1.0 + self.overslept as f64).min(2.0);
            let is_silent = at_ns - newest.arrived_ns > 20 * MS;
            self.gate += if is_silent {
                -course / 20.0
            } else {
                course / self.rise_ms
            };
            self.gate = self.gate.clamp(0.0, 1.0);
            target = force_n * self.gate * self.gate * (3.0 - 2.0 * self.gate);
        }
        self.displayed_n = slewed(self.displayed_n, target);
        let pass = Pass {
            displayed: wrenches(self.displayed_n),
            newest: self.newest.map(|(newest, _)| newest),
            overslept: std::mem::take(&mut self.overslept),
            braked: false,
        };
        self.see(500_000, Seen::Pass(Box::new(pass)));
    }
}
