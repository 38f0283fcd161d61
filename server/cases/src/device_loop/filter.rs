//! Buzz of a force: its part above 20 Hz.

use std::f64::consts::{SQRT_2, TAU};

use sulcus_core::Vec3;

/// Corner frequency, Hz: a limit cycle counts from here.
const CORNER_HZ: f64 = 20.0;

/// High-pass filter of second order after Butterworth, with the corner at [`CORNER_HZ`]. The filter passes 0.71 of an
/// amplitude at the corner, 0.91 at 30 Hz and 0.24 at 10 Hz.
#[derive(Clone, Debug)]
pub(super) struct HighPass {
    /// Factors of the input now, one and two periods ago, and of the output one and two periods ago.
    factors: [f64; 5],
    inputs: [Vec3; 2],
    outputs: [Vec3; 2],
}

impl HighPass {
    /// A filter at rest for a signal of `period_s`.
    pub(super) fn new(period_s: f64) -> Self {
        // Bilinear transform with the corner prewarped.
        let w = libm::tan(0.5 * TAU * CORNER_HZ * period_s);
        let whole = 1.0 + SQRT_2 * w + w * w;
        Self {
            factors: [
                1.0 / whole,
                -2.0 / whole,
                1.0 / whole,
                2.0 * (w * w - 1.0) / whole,
                (1.0 - SQRT_2 * w + w * w) / whole,
            ],
            inputs: [Vec3::zeros(); 2],
            outputs: [Vec3::zeros(); 2],
        }
    }

    /// Fast part of `x`, the value of the next period.
    pub(super) fn of(&mut self, x: &Vec3) -> Vec3 {
        let [b0, b1, b2, a1, a2] = self.factors;
        let y = x * b0 + self.inputs[0] * b1 + self.inputs[1] * b2
            - self.outputs[0] * a1
            - self.outputs[1] * a2;
        self.inputs = [*x, self.inputs[0]];
        self.outputs = [y, self.outputs[0]];
        y
    }
}

/// Measures of a force over a window.
#[derive(Clone, Debug, Default)]
pub(super) struct Window {
    count: u64,
    sum: Vec3,
    squares: f64,
    fast: f64,
    norms: f64,
    sent: f64,
    /// Number of changes of the sign of the fast part, along its largest axis.
    last: Vec3,
    turns: [u64; 3],
    fast_axes: Vec3,
}

impl Window {
    /// Takes a displayed force, its fast part and the magnitude of the force of the link.
    pub(super) fn take(&mut self, force: &Vec3, fast: &Vec3, sent: f64) {
        self.count += 1;
        self.sent += sent;
        self.sum += force;
        self.squares += force.norm_squared();
        self.norms += force.norm();
        self.fast += fast.norm_squared();
        for k in 0..3 {
            self.turns[k] += u64::from(self.last[k] * fast[k] < 0.0);
            self.fast_axes[k] += fast[k] * fast[k];
        }
        self.last = *fast;
    }

    fn mean(&self, sum: f64) -> f64 {
        sum / self.count.max(1) as f64
    }

    /// Number of periods.
    pub(super) fn count(&self) -> u64 {
        self.count
    }

    /// Root mean square of the fast part, newtons.
    pub(super) fn buzz_n(&self) -> f64 {
        self.mean(self.fast).sqrt()
    }

    /// Root mean square of the force about its mean, newtons: a swing of any frequency, and a drift.
    pub(super) fn swing_n(&self) -> f64 {
        let mean = self.sum / self.count.max(1) as f64;
        (self.mean(self.squares) - mean.norm_squared())
            .max(0.0)
            .sqrt()
    }

    /// Mean force, newtons.
    pub(super) fn force_n(&self) -> f64 {
        self.mean(self.norms)
    }

    /// Mean force of the link, newtons.
    pub(super) fn sent_n(&self) -> f64 {
        self.mean(self.sent)
    }

    /// Frequency of the fast part by its changes of sign, Hz, for a signal of `period_s`.
    pub(super) fn hertz(&self, period_s: f64) -> f64 {
        let axis = self.fast_axes.imax();
        self.turns[axis] as f64 / (2.0 * self.count.max(1) as f64 * period_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Window of half a second after a second of a force of 1 N with a swing of `swing` N at `hertz`.
    fn window(swing: f64, hertz: f64, period_s: f64) -> Window {
        let (mut filter, mut window) = (HighPass::new(period_s), Window::default());
        let (from, to) = ((1.0 / period_s) as u64, (1.5 / period_s) as u64);
        for k in 0..to {
            let x = swing * libm::sin(TAU * hertz * k as f64 * period_s);
            let force = Vec3::new(0.6, 0.8 + x, 0.0);
            let fast = filter.of(&force);
            if k >= from {
                window.take(&force, &fast, 1.0);
            }
        }
        window
    }

    #[test]
    fn a_known_swing_is_measured_with_its_size_and_frequency() {
        for period_s in [1e-3, 2.5e-4] {
            for (hertz, share) in [
                (4.0, 0.04),
                (10.0, 0.243),
                (20.0, 0.707),
                (30.0, 0.914),
                (100.0, 0.999),
                (400.0, 1.0),
            ] {
                let found = window(0.2, hertz, period_s);
                let buzz = found.buzz_n() / (0.2 / SQRT_2);
                assert!(
                    (buzz - share).abs() < 0.01,
                    "{hertz} Hz at {period_s} s: {buzz}"
                );
                assert!((found.swing_n() - 0.2 / SQRT_2).abs() < 1e-3);
                assert!(hertz < 20.0 || (found.hertz(period_s) - hertz).abs() <= 2.0);
            }
            let still = window(0.0, 50.0, period_s);
            assert!(still.buzz_n() < 1e-6 && still.swing_n() < 1e-6);
            assert!((still.force_n() - 1.0).abs() < 1e-12);
        }
    }
}
