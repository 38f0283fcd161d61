//! Samples of a touch: a sum of decaying modes.
//!
//! Frequencies and decays are chosen by ear-like reasoning, not measured: a thin steel instrument on enamel is bright
//! and short, soft tissue dull. A faster touch is louder, and excites the higher modes more.

use super::surface::Surface;

/// Samples of a second.
pub const RATE: u32 = 44_100;
/// Speed of the loudest touch, mm/s. Chosen: a probe in use moves at 5 to 50 mm/s.
const FULL_MM_S: f64 = 60.0;
/// Time after which a mode counts as silent, in its decay times: 60 dB.
const SILENT: f64 = 6.9;
/// Largest sum of all amplitudes, as a share of the range of a sample.
const LOUDEST: f64 = 0.7;

/// Mode: frequency, Hz; decay time to 1/e, seconds; amplitude at full speed.
struct Mode(f64, f64, f64);

const ENAMEL: [Mode; 4] = [
    Mode(2350.0, 0.020, 0.30),
    Mode(3900.0, 0.014, 0.35),
    Mode(6100.0, 0.009, 0.22),
    Mode(8800.0, 0.005, 0.13),
];
const SOFT: [Mode; 3] = [
    Mode(95.0, 0.024, 0.55),
    Mode(170.0, 0.016, 0.30),
    Mode(310.0, 0.009, 0.15),
];

/// Samples of a touch at a speed, mm/s; none at rest.
pub fn strike(surface: Surface, speed_mm_s: f64) -> Vec<i16> {
    let level = (speed_mm_s / FULL_MM_S).clamp(0.0, 1.0);
    let modes: &[Mode] = match surface {
        Surface::Enamel => &ENAMEL,
        Surface::Soft => &SOFT,
    };
    if level.is_nan() || level == 0.0 {
        return Vec::new();
    }
    let longest = modes.iter().map(|mode| mode.1).fold(0.0, f64::max);
    let count = (longest * SILENT * f64::from(RATE)) as usize;
    let sample = |k: usize| {
        let time = k as f64 / f64::from(RATE);
        let parts = modes
            .iter()
            .enumerate()
            .map(|(number, Mode(hz, decay, amplitude))| {
                let excited = level.powf(0.7 + 0.3 * number as f64);
                // A sine begins at zero: no step at the begin.
                let wave = (std::f64::consts::TAU * hz * time).sin();
                amplitude * excited * (-time / decay).exp() * wave
            });
        (LOUDEST * f64::from(i16::MAX) * parts.sum::<f64>()) as i16
    };
    (0..count).map(sample).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Power of a frequency (Goertzel 1958), as the square of its amplitude in the whole sound.
    fn power(samples: &[i16], hz: f64) -> f64 {
        let w = std::f64::consts::TAU * hz / f64::from(RATE);
        let (mut one, mut two) = (0.0, 0.0);
        for sample in samples {
            let next = f64::from(*sample) + 2.0 * w.cos() * one - two;
            (two, one) = (one, next);
        }
        one * one + two * two - 2.0 * w.cos() * one * two
    }

    /// Mean frequency, weighted by power, Hz.
    fn centre(samples: &[i16]) -> f64 {
        let grid: Vec<f64> = (1..400).map(|k| 30.0 * f64::from(k)).collect();
        let powers: Vec<f64> = grid.iter().map(|hz| power(samples, *hz)).collect();
        let sum: f64 = powers.iter().sum();
        grid.iter().zip(&powers).map(|(hz, p)| hz * p).sum::<f64>() / sum
    }

    fn loudness(samples: &[i16]) -> f64 {
        let squares = samples.iter().map(|sample| f64::from(*sample).powi(2));
        squares.sum::<f64>().sqrt()
    }

    #[test]
    fn enamel_is_bright_and_soft_tissue_dull() {
        let enamel = strike(Surface::Enamel, 30.0);
        let soft = strike(Surface::Soft, 30.0);
        let (bright, dull) = (centre(&enamel), centre(&soft));
        assert!((2500.0..6000.0).contains(&bright), "{bright} Hz");
        assert!((60.0..300.0).contains(&dull), "{dull} Hz");
        for Mode(hz, ..) in &ENAMEL[..3] {
            let beside = power(&enamel, hz - 700.0).max(power(&enamel, hz + 700.0));
            assert!(power(&enamel, *hz) > 2.0 * beside, "a peak at {hz} Hz");
        }
    }

    #[test]
    fn a_faster_touch_is_louder_and_brighter() {
        for surface in [Surface::Enamel, Surface::Soft] {
            let sounds = [5.0, 20.0, 60.0].map(|speed| strike(surface, speed));
            let loud = sounds.each_ref().map(|sound| loudness(sound));
            assert!(
                loud[0] > 100.0 && loud[1] > 1.5 * loud[0] && loud[2] > 1.5 * loud[1],
                "{loud:?}"
            );
            let [slow, _, fast] = sounds.each_ref().map(|sound| centre(sound));
            assert!(fast > 1.02 * slow, "{slow} {fast}");
            assert_eq!(strike(surface, 500.0), sounds[2]);
        }
    }

    #[test]
    fn a_sound_begins_and_ends_silent_and_never_reaches_the_range() {
        for surface in [Surface::Enamel, Surface::Soft] {
            let sound = strike(surface, 60.0);
            let peak = sound.iter().map(|sample| sample.unsigned_abs()).max();
            assert!(
                peak.is_some_and(|peak| (5_000..30_000).contains(&peak)),
                "{peak:?}"
            );
            let end = &sound[sound.len() - 50..];
            assert_eq!(sound[0], 0);
            assert!(end.iter().all(|sample| sample.unsigned_abs() < 50));
            assert!(sound.len() < RATE as usize / 4, "{} samples", sound.len());
        }
        for still in [0.0, -3.0, f64::NAN] {
            assert!(strike(Surface::Enamel, still).is_empty());
        }
    }
}
