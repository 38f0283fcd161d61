//! How a point shakes above the band of a hand's tremor: where a loop that drives itself shows.

use sulcus_core::Vec3;

/// Length of a tick of the study, seconds.
const TICK_S: f64 = 1e-3;

/// Corner of the filter, Hz. A tremor at 10 Hz comes through with a twenty-fifth of its size, a limit cycle at 24 Hz (a
/// tool of 2 N/mm before 0.1 kg) with a third.
const CORNER_HZ: f64 = 20.0;
/// First-order stages.
const STAGES: usize = 4;

/// A high-pass filter of a point.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Shake {
    /// Per stage what it took in and gave out last.
    stages: Option<[(Vec3, Vec3); STAGES]>,
}

impl Shake {
    /// The fast part of the motion of `point`, metres; zero where there is none, and when it is first seen.
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

    /// Share of a sinusoid that comes through.
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
