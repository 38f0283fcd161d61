//! Messages about a run, outside of the devices' threads.

use std::sync::atomic::Ordering::Relaxed;

use sulcus_haptics::device::HandInfo;

use super::api::{Code, Dhd};
use super::errors::Mode;
use super::shared::HandState;
use super::unit::title;

/// Time between two messages about the same state, nanoseconds.
const AGAIN_NS: u64 = 30_000_000_000;

/// Time over which the rate is measured, nanoseconds.
const RATE_OVER_NS: u64 = 2_000_000_000;

/// What was said about one device.
#[derive(Clone, Copy, Debug, Default)]
pub struct Said {
    mode: Option<(Mode, u64)>,
    error: Option<(u32, u64)>,
    is_saturation_said: bool,
    is_rate_said: bool,
    gaps: u32,
    /// Number of periods at a time.
    periods: Option<(u64, u64)>,
}

impl Said {
    /// Says what is new.
    pub fn look(&mut self, dhd: &Dhd, info: &HandInfo, state: &HandState, now_ns: u64) {
        let name = title(info);
        let is_open = state.is_open.load(Relaxed);
        let mode = Mode::of(state.mode.load(Relaxed));
        let is_old = |at: u64| now_ns.saturating_sub(at) >= AGAIN_NS;
        // A mode at the start, before the first look at the device, is no event.
        let is_settled = state.periods.load(Relaxed) * info.period_ns > RATE_OVER_NS / 10;
        let is_new = self
            .mode
            .is_none_or(|(said, at)| said != mode || is_old(at));
        if is_open && is_settled && is_new {
            self.mode = Some((mode, now_ns));
            if let Some(text) = mode.remark(&name) {
                tracing::warn!("{text}");
            }
        }
        let error = state.error.load(Relaxed);
        if error != 0
            && self
                .error
                .is_none_or(|(said, at)| said != error || is_old(at))
        {
            self.error = Some((error, now_ns));
            let text = dhd.error_text(Code(error as i32));
            let count = state.errors.swap(0, Relaxed);
            state.error.store(0, Relaxed);
            tracing::warn!("{name}: the library reports {text} (error {error}), {count} times");
        }
        if state.saturated.load(Relaxed) > 0
            && !std::mem::replace(&mut self.is_saturation_said, true)
        {
            tracing::warn!(
                "{name}: the motors cannot follow the force: the device is weaker than its model file says"
            );
        }
        let gaps = state.gaps.load(Relaxed);
        if gaps != std::mem::replace(&mut self.gaps, gaps) {
            tracing::warn!(
                "{name}: the haptic loop stopped for more than 15 ms and the force is off: press a button"
            );
        }
        self.rate(&name, info, state, now_ns);
    }

    /// Warns once about a rate below half of the model's, and below 1 kHz.
    fn rate(&mut self, name: &str, info: &HandInfo, state: &HandState, now_ns: u64) {
        let periods = state.periods.load(Relaxed);
        let (before, at) = *self.periods.get_or_insert((periods, now_ns));
        let over_ns = now_ns.saturating_sub(at);
        if over_ns < RATE_OVER_NS {
            return;
        }
        self.periods = Some((periods, now_ns));
        let hz = (periods - before) as f64 * 1e9 / over_ns as f64;
        let wanted = (0.5e9 / info.period_ns as f64).min(1000.0);
        if hz < wanted && !std::mem::replace(&mut self.is_rate_said, true) {
            tracing::warn!(
                "{name}: the haptic loop runs at {hz:.0} Hz: contact may feel soft or rough; end other programs and \
                 connect the device without a hub"
            );
        }
    }
}
