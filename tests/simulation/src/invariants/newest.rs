//! Newest wrench of the server at a device: invariant 17.

use crate::seen::{Newest, Pass};

use super::Found;
use super::bounds::{Bounds, ROUNDING};
use super::memory::Memory;

/// Newest wrench so far.
#[derive(Default)]
pub(super) struct Newer(Option<Newest>);

impl Newer {
    /// Judges the newest wrench of a pass. `epoch`: present epoch of the server.
    ///
    /// A tick sends one wrench. A further arrival is therefore that of a later tick.
    pub(super) fn pass(
        &mut self,
        bounds: &Bounds,
        memory: &Memory,
        epoch: Option<u32>,
        at_ns: u64,
        pass: &Pass,
        found: &mut Found,
    ) {
        let Some(now) = pass.newest else { return };
        found.must(now.arrived_ns <= at_ns, 17, || {
            format!("at {at_ns} ns: a wrench from the future, {now:?}")
        });
        found.must(epoch.is_some_and(|epoch| now.epoch <= epoch), 17, || {
            format!(
                "a wrench of epoch {}; the server's epoch is {epoch:?}",
                now.epoch
            )
        });
        found.must(now.tick <= memory.last(), 17, || {
            format!(
                "a wrench of tick {}; the newest tick is {}",
                now.tick,
                memory.last()
            )
        });
        if let Some(before) = self.0 {
            let is_same = now.tick == before.tick
                && now.epoch == before.epoch
                && now.arrived_ns == before.arrived_ns;
            let is_later = now.tick > before.tick
                && now.epoch >= before.epoch
                && now.arrived_ns >= before.arrived_ns;
            found.must(is_same || is_later, 17, || {
                format!("wrench {now:?} after {before:?}")
            });
        }
        if let Some(tick) = memory.of(now.tick) {
            let limits = (
                bounds.limit_n(now.force_limit_n),
                bounds.limit_n(tick.force_limit_n),
            );
            let is_obeyed = now.paused == tick.paused && (limits.0 - limits.1).abs() <= ROUNDING;
            found.must(is_obeyed, 17, || {
                let (paused, limit_n) = (tick.paused, tick.force_limit_n);
                format!("{now:?}; its tick obeyed: paused {paused}, limit {limit_n} N")
            });
        }
        self.0 = Some(now);
    }
}
