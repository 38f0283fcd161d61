//! Force on a tool: histogram, time in contact, and peak.

use std::collections::VecDeque;

use sulcus_core::math::fmax;

use super::tolerances::TOUCH_N;

/// Force on a tool over a session.
#[derive(Clone, Debug, PartialEq)]
pub struct Pressed {
    /// Number of ticks in contact, by bins of force.
    bins: Vec<u64>,
    /// Time in contact, seconds.
    seconds: f64,
    /// Forces of the last [`PEAK_S`], newtons.
    last: VecDeque<f64>,
    /// Largest mean of these forces, newtons.
    peak: f64,
}

/// Time over which the peak is a mean, seconds. A knock of a tick or two is thus no peak.
pub const PEAK_S: f64 = 0.05;

/// Width of a bin, newtons.
const BIN: f64 = 0.01;
/// Number of bins: up to 20 N.
const BINS: usize = 2000;

impl Default for Pressed {
    fn default() -> Self {
        Self {
            bins: vec![0; BINS],
            seconds: 0.0,
            last: VecDeque::new(),
            peak: 0.0,
        }
    }
}

impl Pressed {
    /// Takes in the force of a tick, newtons. `dt` is its length with the skipped ticks before it, seconds; `tick_s` is
    /// the period. The contact lasts `dt`, a push lasts `tick_s`.
    pub fn observe(&mut self, force: f64, dt: f64, tick_s: f64) {
        if force >= TOUCH_N && force.is_finite() {
            let bin = ((force / BIN) as usize).min(BINS - 1);
            self.bins[bin] += 1;
            self.seconds += dt;
        }
        let force = if force.is_finite() { force } else { 0.0 };
        let ticks = fmax((PEAK_S / tick_s).round(), 1.0);
        self.last.push_back(force);
        if self.last.len() > ticks as usize {
            self.last.pop_front();
        }
        // A push shorter than `PEAK_S` is averaged with zeros.
        self.peak = fmax(self.peak, self.last.iter().sum::<f64>() / ticks);
    }

    /// Largest mean force over [`PEAK_S`], newtons. None without a contact.
    pub fn peak(&self) -> Option<f64> {
        (self.seconds > 0.0).then_some(self.peak)
    }

    /// Time in contact, seconds.
    pub fn seconds(&self) -> f64 {
        self.seconds
    }

    /// Force that 95 % of the ticks in contact do not exceed, newtons, rounded up to 0.01. None without a contact.
    pub fn p95(&self) -> Option<f64> {
        let all: u64 = self.bins.iter().sum();
        let mut sum = 0;
        let bin = self.bins.iter().position(|count| {
            sum += count;
            all > 0 && sum * 100 >= all * 95
        })?;
        Some((bin + 1) as f64 * BIN)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stab_shows_in_the_peak_where_the_percentile_hides_it() {
        let mut pressed = Pressed::default();
        assert_eq!(pressed.peak(), None);
        (0..9600).for_each(|_| pressed.observe(1.0, 1e-3, 1e-3));
        assert!((pressed.peak().expect("a touch") - 1.0).abs() < 1e-9);
        // Mean of 25 ms of 7 N after 25 ms of 1 N: 4 N.
        (0..25).for_each(|_| pressed.observe(7.0, 1e-3, 1e-3));
        assert!((pressed.peak().expect("a touch") - 4.0).abs() < 1e-9);
        (0..375).for_each(|_| pressed.observe(20.0, 1e-3, 1e-3));
        pressed.observe(f64::NAN, 1e-3, 1e-3);
        assert!((pressed.peak().expect("a touch") - 20.0).abs() < 1e-9);
        assert!((pressed.p95().expect("a touch") - 1.01).abs() < 1e-9);
    }

    #[test]
    fn the_95th_percentile_of_a_hundred_ticks_is_the_95th() {
        let mut pressed = Pressed::default();
        assert_eq!(pressed.p95(), None);
        for k in 1..=100 {
            // Of 0.105, 0.205 to 10.005 N, the 95th is in the bin up to 9.51 N.
            pressed.observe(0.1 * f64::from(k) + 0.005, 1e-3, 1e-3);
        }
        pressed.observe(0.01, 1e-3, 1e-3);
        pressed.observe(f64::NAN, 1e-3, 1e-3);
        let p95 = pressed.p95().expect("touches");
        assert!((p95 - 9.51).abs() < 1e-9, "{p95}");
    }
}
