//! Low-pass filter of second order, Butterworth by the bilinear transform, for the motion of a hand without a
//! device's noise.

use std::f64::consts::{PI, SQRT_2};

use sulcus_core::Vec3;

/// Filter for a point in space.
#[derive(Clone, Copy, Debug)]
pub struct LowPass {
    /// Coefficients of the input: now, one and two samples before.
    b: [f64; 3],
    /// Coefficients of the output: one and two samples before.
    a: [f64; 2],
    /// Last two inputs.
    input: [Vec3; 2],
    /// Last two outputs.
    output: [Vec3; 2],
    /// Whether a sample has come since the last reset.
    begun: bool,
}

impl LowPass {
    /// Filter for samples at `rate_hz`, which is more than twice the cut-off.
    pub fn new(rate_hz: f64, cut_off_hz: f64) -> Self {
        let k = libm::tan(PI * cut_off_hz / rate_hz);
        let norm = 1.0 / (1.0 + SQRT_2 * k + k * k);
        let b = k * k * norm;
        Self {
            b: [b, 2.0 * b, b],
            a: [
                2.0 * (k * k - 1.0) * norm,
                (1.0 - SQRT_2 * k + k * k) * norm,
            ],
            input: [Vec3::zeros(); 2],
            output: [Vec3::zeros(); 2],
            begun: false,
        }
    }

    /// Forgets all samples. The next sample counts as constant before.
    pub fn reset(&mut self) {
        self.begun = false;
    }

    /// Filtered point after one more sample.
    pub fn step(&mut self, x: Vec3) -> Vec3 {
        if !self.begun {
            self.begun = true;
            self.input = [x; 2];
            self.output = [x; 2];
        }
        let y = x * self.b[0] + self.input[0] * self.b[1] + self.input[1] * self.b[2]
            - self.output[0] * self.a[0]
            - self.output[1] * self.a[1];
        self.input = [x, self.input[0]];
        self.output = [y, self.output[0]];
        y
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Amplitude of the settled output for a wave of amplitude 1.
    fn gain(hz: f64) -> f64 {
        let mut filter = LowPass::new(1000.0, 20.0);
        let mut most: f64 = 0.0;
        for k in 0..4000 {
            let wave = libm::sin(2.0 * PI * hz * f64::from(k) * 1e-3);
            let out = filter.step(Vec3::new(wave, 0.0, 0.0)).x;
            if k >= 2000 {
                most = most.max(out.abs());
            }
        }
        most
    }

    #[test]
    fn what_is_slow_passes_and_what_is_fast_does_not() {
        // Butterworth: 1 / sqrt(1 + (f / fc)^4), with the bilinear transform's warped frequencies.
        let exact = |hz: f64| {
            let warped = libm::tan(PI * hz * 1e-3) / libm::tan(PI * 20e-3);
            1.0 / libm::hypot(1.0, warped * warped)
        };
        for hz in [1.0, 5.0, 20.0, 50.0, 200.0] {
            assert!((gain(hz) - exact(hz)).abs() < 2e-3, "{hz}: {}", gain(hz));
        }
        assert!((exact(20.0) - 0.5f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn a_point_that_rests_stays_where_it_is() {
        let mut filter = LowPass::new(1000.0, 20.0);
        let at = Vec3::new(0.05, -0.02, 0.11);
        for _ in 0..500 {
            assert!((filter.step(at) - at).norm() < 1e-12);
        }
    }
}
