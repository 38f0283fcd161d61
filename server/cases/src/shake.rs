//! Shake of a point above the band of a hand's tremor, in which a limit cycle of the loop appears.

use sulcus_core::Vec3;

/// Length of a tick, seconds; the filter is for 1 kHz only.
const TICK_S: f64 = 1e-3;

/// Corner frequency of the filter, Hz.
///
/// A tremor of 10 Hz passes with a twenty-fifth of its size. A limit cycle of 24 Hz, as of a coupling of 2 N/mm with
/// 0.1 kg, passes with a third.
const CORNER_HZ: f64 = 20.0;
/// Number of first-order stages.
const STAGES: usize = 4;

/// High-pass filter of a point.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Shake {
    /// Last input and output of each stage; `None` before the first point.
    stages: Option<[(Vec3, Vec3); STAGES]>,
}

impl Shake {
    /// Fast part of the position of `point`, metres. The first point gives zero; `None` resets the filter and gives
    /// zero.
    pub(crate) fn of(&mut self, point: Option<Vec3>) -> Vec3 {
        let Some(point) = point else {
            self.stages = None;
            return Vec3::zeros();
        };
        let keep = 1.0 / (1.0 + std::f64::consts::TAU * CORNER_HZ * TICK_S);
        let stages = self.stages.get_or_insert_with(|| {
            let mut begin = [(Vec3::zeros(), Vec3::zeros()); STAGES];
            begin[0].0 = point;
            begin
        });
        let mut through = point;
        for (input, output) in stages {
            let next = (*output + through - *input) * keep;
            (*input, *output) = (through, next);
            through = next;
        }
        through
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Share of a sinusoid that passes the filter.
    fn share(hertz: f64) -> f64 {
        let mut shake = Shake::default();
        let mut most = 0.0f64;
        for k in 0..3000 {
            let x = libm::sin(std::f64::consts::TAU * hertz * f64::from(k) * TICK_S);
            let out = shake.of(Some(Vec3::new(x, 0.0, 0.0))).x;
            if k > 2000 {
                most = most.max(out.abs());
            }
        }
        most
    }

    #[test]
    fn tremor_stays_out_and_a_limit_cycle_comes_through() {
        assert!(share(1.0) < 1e-4, "{}", share(1.0));
        assert!(share(10.0) < 0.06, "{}", share(10.0));
        assert!(share(24.0) > 0.2, "{}", share(24.0));
        assert!(share(60.0) > 0.5, "{}", share(60.0));
    }
}
