//! Judgement of a force: quiet, or a shake.

use std::f64::consts::TAU;

/// Frequency above which the force counts, Hz: a hand trembles below.
const ABOVE_HZ: f64 = 20.0;
/// Frequency above which a limit cycle counts, Hz.
const CYCLE_HZ: f64 = 4.0;
/// Largest force above [`ABOVE_HZ`], root mean square over the time of [`JUDGED_S`], newtons.
const RMS_N: f64 = 0.05;
/// Root mean square over [`AT_ONCE_S`] at which the force ends at once, newtons.
const AT_ONCE_N: f64 = 0.2;
/// Time constant of the judgement at once, seconds.
const AT_ONCE_S: f64 = 0.1;
/// Time after which a judgement at once is possible, seconds: the push and the fall on the floor count for nothing.
const FALLEN_S: f64 = 0.3;
/// Range of a limit cycle, newtons. The tremor of a hand of 0.1 mm stays below at 1 N/mm.
const CYCLE_N: f64 = 0.2;
/// Time in which the push decays, seconds.
const DECAY_S: f64 = 0.5;
/// Time of the judgement after the decay, seconds.
const JUDGED_S: f64 = 1.0;
/// Parts of [`JUDGED_S`]. A limit cycle lasts through all of them.
const PARTS: usize = 4;

/// Result of a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Verdict {
    /// Not known yet.
    Open,
    /// The force became quiet: its root mean square above 20 Hz, newtons.
    Quiet(f64),
    /// The force shakes.
    Shakes,
}

/// Judgement of a force over time.
#[derive(Clone, Debug)]
pub(super) struct Shake {
    seconds: f64,
    /// Low parts of the two filters in series for [`ABOVE_HZ`], and that for [`CYCLE_HZ`].
    low: Option<[f64; 3]>,
    /// Mean square with a time constant of [`AT_ONCE_S`].
    short: f64,
    square: f64,
    judged: f64,
    ranges: [(f64, f64); PARTS],
}

impl Shake {
    /// Creates a judgement without a sample.
    pub fn new() -> Self {
        Self {
            seconds: 0.0,
            low: None,
            short: 0.0,
            square: 0.0,
            judged: 0.0,
            ranges: [(f64::INFINITY, f64::NEG_INFINITY); PARTS],
        }
    }

    /// Accounts for `force`, newtons, `seconds` after the sample before.
    pub fn see(&mut self, force: f64, seconds: f64) -> Verdict {
        let low = self.low.get_or_insert([force, 0.0, force]);
        let follow = |low: &mut f64, x: f64, hertz: f64| {
            let turns = TAU * hertz * seconds;
            *low += (x - *low) * turns / (1.0 + turns);
            x - *low
        };
        let [first, second, slow] = low;
        let once = follow(first, force, ABOVE_HZ);
        let high = follow(second, once, ABOVE_HZ);
        let cycle = follow(slow, force, CYCLE_HZ);
        self.seconds += seconds;
        if self.seconds > FALLEN_S {
            self.short += (high * high - self.short) * seconds / (seconds + AT_ONCE_S);
        }
        if self.short > AT_ONCE_N * AT_ONCE_N {
            return Verdict::Shakes;
        }
        let since = self.seconds - DECAY_S;
        if since < 0.0 {
            return Verdict::Open;
        }
        if since < JUDGED_S {
            self.square += high * high * seconds;
            self.judged += seconds;
            let part = (since / JUDGED_S * PARTS as f64) as usize;
            let (least, most) = &mut self.ranges[part.min(PARTS - 1)];
            (*least, *most) = (least.min(cycle), most.max(cycle));
            return Verdict::Open;
        }
        let rms = (self.square / self.judged.max(1e-9)).sqrt();
        let cycles = self
            .ranges
            .iter()
            .all(|(least, most)| most - least > CYCLE_N);
        if rms > RMS_N || cycles {
            Verdict::Shakes
        } else {
            Verdict::Quiet(rms)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Verdict on a sine of `hertz` whose amplitude is `newtons` and falls with the rate `decay`.
    fn verdict(hertz: f64, newtons: f64, decay: f64) -> Verdict {
        let mut shake = Shake::new();
        (0..2000)
            .map(|k| f64::from(k) * 1e-3)
            .map(|t| {
                shake.see(
                    0.4 + newtons * (-decay * t).exp() * (TAU * hertz * t).sin(),
                    1e-3,
                )
            })
            .find(|verdict| *verdict != Verdict::Open)
            .expect("a verdict")
    }

    #[test]
    fn a_shake_is_told_from_tremor_and_from_a_decay() {
        assert_eq!(verdict(80.0, 0.1, 0.0), Verdict::Shakes);
        assert_eq!(verdict(7.0, 0.3, 0.0), Verdict::Shakes);
        assert!(matches!(verdict(80.0, 0.04, 0.0), Verdict::Quiet(rms) if rms < 0.03));
        assert!(matches!(verdict(10.0, 0.08, 0.0), Verdict::Quiet(_)));
        assert!(matches!(verdict(60.0, 0.25, 8.0), Verdict::Quiet(_)));
        assert!(matches!(verdict(1.0, 0.3, 0.0), Verdict::Quiet(_)));
    }

    #[test]
    fn a_strong_shake_ends_at_once() {
        let mut shake = Shake::new();
        let samples = (0..2000).take_while(|k| {
            let force = if k % 8 < 4 { 0.0 } else { 1.0 };
            shake.see(force, 1e-3) == Verdict::Open
        });
        assert!(samples.count() < 400);
    }
}
