//! Physiological tremor of the hand: 8 to 12 Hz (Elble and Koller 1990; in microsurgery about
//! 0.05 to 0.1 mm rms, Singh and Riviere 2002, doi:10.1109/NEBC.2002.999527).

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use sulcus_core::Vec3;

/// Sinusoids per axis.
const PARTIALS: usize = 4;

/// A sum of sinusoids between 8 and 12 Hz with random phases: band-limited, endless, and a pure
/// function of time.
#[derive(Clone, Debug)]
pub struct Tremor {
    /// Per axis and partial: angular frequency (rad/s) and phase (rad).
    partials: [[(f64, f64); PARTIALS]; 3],
    amplitude: f64,
}

impl Tremor {
    /// Tremor of `rms` (metres or radians) per axis.
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
        // N sinusoids of amplitude a have an rms of a sqrt(N/2).
        Self {
            partials,
            amplitude: rms / (PARTIALS as f64 / 2.0).sqrt(),
        }
    }

    /// Displacement at `t` seconds.
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
