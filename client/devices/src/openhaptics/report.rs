//! Messages about a run, outside of the callback: once for an event, and again after a while for a state that lasts.

use std::sync::atomic::Ordering::{Acquire, Relaxed};

use super::api::Hd;
use super::shared::{HandState, Shared};
use super::unit::Unit;
use super::{calibration, errors};

/// Time between two messages about the same state, nanoseconds.
const AGAIN_NS: u64 = 30_000_000_000;

/// Time without a tick from which the scheduler counts as stopped, nanoseconds.
const FROZEN_NS: u64 = 1_000_000_000;

/// What was said so far.
#[derive(Debug, Default)]
pub struct Reporter {
    hands: Vec<Said>,
    is_slow_said: bool,
    is_frozen_said: bool,
    ticks: (u64, u64),
}

#[derive(Clone, Copy, Debug, Default)]
struct Said {
    refused: Timed,
    other: Timed,
    calibration: Timed,
    gaps: u32,
}

/// A message that repeats.
#[derive(Clone, Copy, Debug, Default)]
struct Timed {
    code: u32,
    count: u32,
    at_ns: Option<u64>,
}

impl Timed {
    /// Whether a message about `code` is due; `count` is the number of the event.
    fn is_due(&mut self, code: u32, count: u32, now_ns: u64) -> bool {
        if code == 0 || count == self.count {
            return false;
        }
        let is_old = self
            .at_ns
            .is_none_or(|at| now_ns.saturating_sub(at) >= AGAIN_NS);
        if !is_old && code == self.code {
            return false;
        }
        (self.code, self.count, self.at_ns) = (code, count, Some(now_ns));
        true
    }
}

impl Reporter {
    /// Reporter of this number of hands.
    pub fn new(hands: usize) -> Self {
        Self {
            hands: vec![Said::default(); hands],
            ..Self::default()
        }
    }

    /// A service begins: the scheduler's ticks count anew.
    pub fn begin(&mut self, now_ns: u64) {
        self.ticks = (u64::MAX, now_ns);
    }

    /// Says what is new.
    pub fn look(&mut self, hd: &Hd, units: &[Unit], shared: &Shared, now_ns: u64) {
        for ((unit, said), state) in units.iter().zip(&mut self.hands).zip(&shared.hands) {
            for text in said.look(hd, unit, state, now_ns) {
                tracing::warn!("{text}");
            }
        }
        if shared.is_slow.load(Relaxed) && !std::mem::replace(&mut self.is_slow_said, true) {
            tracing::warn!(
                "the haptic loop of OpenHaptics runs below 500 Hz: contact may feel soft or rough; end other programs \
                 and connect the devices without a hub"
            );
        }
        let ticks = shared.ticks.load(Acquire);
        if ticks != self.ticks.0 {
            self.ticks = (ticks, now_ns);
        } else if now_ns.saturating_sub(self.ticks.1) >= FROZEN_NS
            && !std::mem::replace(&mut self.is_frozen_said, true)
        {
            tracing::warn!(
                "the haptic loop of OpenHaptics stands still and the devices have no force: end the session, and plug \
                 the devices in again"
            );
        }
    }
}

impl Said {
    fn look(&mut self, hd: &Hd, unit: &Unit, state: &HandState, now_ns: u64) -> Vec<String> {
        let title = unit.title();
        let mut texts = Vec::new();
        let (code, count) = (state.refused.load(Relaxed), state.refusals.load(Relaxed));
        if self.refused.is_due(code, count, now_ns) {
            texts.push(errors::remark(&title, code, &hd.error_text(code)));
        }
        let (code, count) = (state.other.load(Relaxed), state.others.load(Relaxed));
        if self.other.is_due(code, count, now_ns) {
            let text = errors::remark(&title, code, &hd.error_text(code));
            texts.push(format!("{text}, {count} times so far"));
        }
        let code = state.uncalibrated.load(Relaxed);
        // Each message is an event of its own while the state lasts.
        if self
            .calibration
            .is_due(code, self.calibration.count.wrapping_add(1), now_ns)
        {
            texts.push(calibration::remark(&title, code, unit.styles));
        }
        let gaps = state.gaps.load(Relaxed);
        if gaps != std::mem::replace(&mut self.gaps, gaps) {
            texts.push(format!(
                "{title}: the haptic loop stopped for more than 15 ms and the force is off: press a button"
            ));
        }
        texts
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_state_is_told_every_thirty_seconds_and_a_new_one_at_once() {
        let mut timed = Timed::default();
        let mut count = 0;
        let mut told = Vec::new();
        for second in 0..70 {
            count += 1;
            let code = if second == 40 { 0x5002 } else { 0x5001 };
            if timed.is_due(code, count, second * 1_000_000_000) {
                told.push(second);
            }
        }
        assert_eq!(told, [0, 30, 40, 41]);
        assert!(!timed.is_due(0, count + 1, u64::MAX));
        assert!(!timed.is_due(7, timed.count, u64::MAX));
    }
}
