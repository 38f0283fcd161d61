//! SPARC: spectral arc length of the speed of one discrete movement, without unit. More negative is less smooth.
//!
//! Definition: Balasubramanian et al., J NeuroEng Rehabil 2015, 12:112, with the reference code at
//! github.com/siva82kb/SPARC: zero padding by 2^4, amplitude threshold 0.05.

use super::fft::magnitudes;

/// Exponent of the zero padding, base 2.
const PAD: u32 = 4;
/// Share of the largest magnitude below which both ends of the spectrum are cut off.
const THRESHOLD: f64 = 0.05;

/// SPARC of a speed profile in any unit, sampled at `rate_hz`, from its spectrum up to `cut_off_hz`.
/// None without a movement, or for a movement too short for a spectrum.
pub fn sparc(speed: &[f64], rate_hz: f64, cut_off_hz: f64) -> Option<f64> {
    if speed.len() < 2 || !speed.iter().all(|x| x.is_finite()) {
        return None;
    }
    let n = speed.len().next_power_of_two() << PAD;
    let step = rate_hz / n as f64;
    let spectrum = magnitudes(speed, n);
    let largest = spectrum
        .iter()
        .fold(0.0, |a: f64, b| if *b > a { *b } else { a });
    if largest <= 0.0 {
        return None;
    }
    let below: Vec<f64> = spectrum
        .iter()
        .enumerate()
        .take_while(|(k, _)| *k as f64 * step <= cut_off_hz)
        .map(|(_, magnitude)| magnitude / largest)
        .collect();
    let first = below.iter().position(|x| *x >= THRESHOLD)?;
    let last = below.iter().rposition(|x| *x >= THRESHOLD)?;
    if last == first {
        return None;
    }
    let along = 1.0 / (last - first) as f64;
    let arc = below[first..=last].windows(2).map(|pair| {
        let rise = pair[1] - pair[0];
        (along * along + rise * rise).sqrt()
    });
    Some(-arc.sum::<f64>())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Samples of `exp(-5 t^2) with(t)` at 100 Hz, t from -1 to 1, without 1.
    fn bell(with: impl Fn(f64) -> f64) -> Vec<f64> {
        (0..200)
            .map(|k| -1.0 + 0.01 * f64::from(k))
            .map(|t| libm::exp(-5.0 * t * t) * with(t))
            .collect()
    }

    #[test]
    fn the_published_value_comes_out() {
        let found = sparc(&bell(|_| 1.0), 100.0, 10.0).expect("a movement");
        assert!((found + 1.41403).abs() < 5e-6, "{found}");
    }

    #[test]
    fn six_moves_with_rests_taken_as_one_are_not_smooth() {
        let mut all = Vec::new();
        for k in 0..6 {
            all.extend(bell(|_| 1.0));
            if k < 5 {
                all.extend([0.0; 100]);
            }
        }
        let found = sparc(&all, 100.0, 10.0).expect("movements");
        assert!((found + 6.71).abs() < 0.3, "{found}");
    }

    #[test]
    fn a_tremor_shows_only_where_the_cut_off_lets_it() {
        let tremor = bell(|t| 1.0 + 0.4 * libm::sin(2.0 * std::f64::consts::PI * 11.0 * t));
        let at = |cut_off| sparc(&tremor, 100.0, cut_off).expect("a movement");
        assert!((at(10.0) + 1.414).abs() < 2e-3, "{}", at(10.0));
        assert!(at(20.0) < -1.9, "{}", at(20.0));
    }

    #[test]
    fn faster_or_longer_of_the_same_shape_is_as_smooth() {
        let once = sparc(&bell(|_| 1.0), 100.0, 10.0).expect("a movement");
        let louder = sparc(&bell(|_| 7.0), 100.0, 10.0).expect("a movement");
        assert!((once - louder).abs() < 1e-12);
    }

    #[test]
    fn no_movement_has_no_smoothness() {
        for speed in [&[][..], &[1.0], &[0.0; 50], &[1.0, f64::NAN]] {
            assert_eq!(sparc(speed, 100.0, 10.0), None);
        }
    }
}
