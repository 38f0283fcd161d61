//! Physiological tremor of the hand, 8 to 12 Hz (Elble and Koller 1990).
//!
//! In microsurgery the tremor is about 0.05 to 0.1 mm rms (Singh and Riviere 2002, doi:10.1109/NEBC.2002.999527).

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use sulcus_core::Vec3;

/// Number of sinusoids for each axis.
const PARTIALS: usize = 4;

/// A sum of sinusoids of 8 to 12 Hz with random frequencies and phases: a pure function of time.
#[derive(Clone, Debug)]
pub struct Tremor {
    /// Angular frequency, rad/s, and phase, rad, by axis and sinusoid.
    partials: [[(f64, f64); PARTIALS]; 3],
    amplitude: f64,
}

impl Tremor {
    /// Tremor with the root mean square `rms` for each axis, metres or radians. `seed` decides frequencies and phases.
    pub fn new(rms: f64, seed: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut unit = || (rng.next_u64() >> 11) as f64 / (1u64 << 53) as f64;
        let partials = std::array::from_fn(|_| {
            std::array::from_fn(|_| {
                (
                    std::f64::consts::TAU * (8.0 + 4.0 * unit()),
                    std::f64::consts::TAU * unit(),
                )
            })
        });
        // N sinusoids of amplitude a have an rms of a sqrt(N / 2).
        Self {
            partials,
            amplitude: rms / (PARTIALS as f64 / 2.0).sqrt(),
        }
    }

    /// Displacement at `t` seconds, in the unit of the rms.
    pub fn at(&self, t: f64) -> Vec3 {
        let axis = |k: usize| {
            let sum: f64 = self.partials[k]
                .iter()
                .map(|(omega, phase)| libm::sin(omega * t + phase))
                .sum();
            sum * self.amplitude
        };
        Vec3::new(axis(0), axis(1), axis(2))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rms_is_as_asked_and_the_seed_decides() {
        let (a, b) = (Tremor::new(1e-4, 1), Tremor::new(1e-4, 2));
        assert_ne!(a.at(0.3), b.at(0.3));
        assert_eq!(a.at(0.3), Tremor::new(1e-4, 1).at(0.3));
        let n = 60_000;
        let mean_square: f64 = (0..n)
            .map(|k| a.at(f64::from(k) * 1e-3).norm_squared())
            .sum::<f64>()
            / f64::from(n);
        assert!((mean_square.sqrt() / (1e-4 * 3f64.sqrt()) - 1.0).abs() < 0.1);
    }
}
