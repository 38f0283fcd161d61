//! Phase of a loop against the server's ticks.
//!
//! A pose waits at the server for the next tick, half a period on average. The server states the wait of each pose in
//! its wrench. A first-order control loop moves the passes of the device's loop until the pose arrives shortly before
//! the tick that uses it. The change of a period is at most 0.2 %, which no device notices.

use serde::Serialize;

/// Least wait that the loop aims at, as a share of the period. The pose must arrive before the tick reads it.
const LEAST: f64 = 0.06;
/// Longest wait that the loop aims at, as a share of the period.
const MOST: f64 = 0.25;
/// Number of mean deviations between the wait aimed at and a pose that misses its tick.
const DEVIATIONS: f64 = 3.0;
/// Gain of the control loop for each pose. The loop is stable while gain times delay, in periods, is below pi / 2.
const GAIN: f64 = 1.0 / 256.0;
/// Delay above which the gain falls in proportion, periods.
const LONG: f64 = 100.0;
/// Weight of a new deviation in the mean deviation.
const WEIGHT: f64 = 1.0 / 128.0;
/// Largest change of a period, as a share of the period.
const LARGEST: f64 = 0.002;

/// Control loop of the phase.
#[derive(Clone, Copy, Debug)]
pub struct Phase {
    period_ns: f64,
    /// Mean difference of the waits to the wait aimed at, nanoseconds.
    mean_ns: f64,
    /// Mean deviation of this difference from its mean, nanoseconds. A deviation from the wait aimed at, which depends
    /// on it, would grow by itself.
    deviation_ns: f64,
    /// Correction that no pass has made yet, nanoseconds.
    owed_ns: f64,
    /// Number of the reading of the newest wait.
    last: Option<u32>,
    report: PhaseReport,
}

/// Report of the control loop.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct PhaseReport {
    /// Number of waits heard.
    pub waits: u64,
    /// Number of poses that missed the tick before which they should have arrived.
    pub missed: u64,
    /// Wait aimed at, microseconds.
    pub aim_us: f64,
    /// Mean deviation of the waits over about the last 128 poses, microseconds.
    pub deviation_us: f64,
    /// Sum of all corrections, microseconds. Positive values delay the passes.
    pub moved_us: f64,
}

impl PhaseReport {
    /// Fields as JSON, for an event of the recording.
    pub fn json(&self) -> String {
        let Self {
            waits,
            missed,
            aim_us,
            deviation_us,
            moved_us,
        } = self;
        format!(
            r#"{{"waits":{waits},"missed":{missed},"aim_us":{aim_us:.1},"deviation_us":{deviation_us:.1},"moved_us":{moved_us:.1}}}"#
        )
    }
}

impl Phase {
    /// Control loop for a period, nanoseconds.
    pub fn new(period_ns: u64) -> Self {
        let period_ns = period_ns as f64;
        Self {
            period_ns,
            // Nothing is known: a quarter of a period is the mean deviation of any phase.
            mean_ns: 0.0,
            deviation_ns: period_ns / 4.0,
            owed_ns: 0.0,
            last: None,
            report: PhaseReport::default(),
        }
    }

    /// Wait aimed at, nanoseconds.
    fn aim_ns(&self) -> f64 {
        let aim = LEAST * self.period_ns + DEVIATIONS * self.deviation_ns;
        aim.min(MOST * self.period_ns)
    }

    /// Takes the wait of the reading `number` at the server, answered `age_ns` after its measurement. A second wait of
    /// one reading is ignored, and a wait of a period or more, which does not tell the phase.
    pub fn heard(&mut self, number: u32, wait_us: u32, age_ns: u64) {
        let wait_ns = f64::from(wait_us) * 1e3;
        if self.last == Some(number) || wait_ns >= self.period_ns {
            return;
        }
        self.last = Some(number);
        let early_ns = wait_ns - self.aim_ns();
        // A pose that waits for more than half a period longer has missed the tick before.
        let has_missed = early_ns > self.period_ns / 2.0;
        let error_ns = if has_missed {
            early_ns - self.period_ns
        } else {
            early_ns
        };
        self.mean_ns += (error_ns - self.mean_ns) * WEIGHT;
        let deviation_ns = (error_ns - self.mean_ns).abs();
        self.deviation_ns += (deviation_ns - self.deviation_ns) * WEIGHT;
        let delay = age_ns as f64 / self.period_ns;
        self.owed_ns = error_ns * GAIN / (delay / LONG).max(1.0);
        self.report.waits += 1;
        self.report.missed += u64::from(has_missed);
    }

    /// Next correction, nanoseconds: positive values delay the next pass.
    pub fn correction_ns(&mut self) -> i64 {
        let most_ns = LARGEST * self.period_ns;
        let correction_ns = self.owed_ns.clamp(-most_ns, most_ns).round();
        self.owed_ns = 0.0;
        self.report.moved_us += correction_ns / 1e3;
        correction_ns as i64
    }

    /// Report so far.
    pub fn report(&self) -> PhaseReport {
        PhaseReport {
            aim_us: self.aim_ns() / 1e3,
            deviation_us: self.deviation_ns / 1e3,
            ..self.report
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::VecDeque;

    const PERIOD_NS: u64 = 1_000_000;

    /// Poses of `passes` passes that begin `offset_ns` after a tick, each on its way for `up_ns` of a pass, and
    /// answered `delay` passes later. Returns the control loop and the waits of the last 500 poses, nanoseconds.
    fn play(
        offset_ns: u64,
        passes: u64,
        delay: usize,
        up_ns: impl Fn(u64) -> u64,
    ) -> (Phase, Vec<u64>) {
        let mut phase = Phase::new(PERIOD_NS);
        let (mut now, mut answers, mut waits) = (offset_ns, VecDeque::new(), Vec::new());
        for pass in 0..passes {
            let arrived = now + up_ns(pass);
            let wait = (PERIOD_NS - arrived % PERIOD_NS) % PERIOD_NS;
            answers.push_back((pass as u32, (wait / 1000) as u32));
            if pass + 500 >= passes {
                waits.push(wait);
            }
            if answers.len() > delay
                && let Some((number, wait_us)) = answers.pop_front()
            {
                phase.heard(number, wait_us, delay as u64 * PERIOD_NS);
            }
            let correction = phase.correction_ns();
            assert!(correction.unsigned_abs() <= PERIOD_NS / 500);
            now = now
                .checked_add(PERIOD_NS)
                .and_then(|next| next.checked_add_signed(correction))
                .expect("a time");
        }
        (phase, waits)
    }

    #[test]
    fn from_any_phase_every_pose_comes_shortly_before_its_tick() {
        for offset_us in (0..1000).step_by(50) {
            let (phase, waits) = play(offset_us * 1000, 4000, 1, |_| 40_000);
            let (least, most) = (waits.iter().min(), waits.iter().max());
            assert!(least >= Some(&40_000), "from {offset_us}: {least:?}");
            assert!(most <= Some(&90_000), "from {offset_us}: {most:?}");
            assert!(phase.report().deviation_us < 10.0, "{:?}", phase.report());
        }
    }

    /// Round trips of 40 to 500 ms: the correction acts on the pose that is answered that much later.
    #[test]
    fn a_late_answer_makes_no_oscillation() {
        for delay in [40, 100, 280, 500] {
            let (_, waits) = play(500_000, 30_000, delay, |_| 300_000);
            let (least, most) = (waits.iter().min(), waits.iter().max());
            assert!(
                least >= Some(&30_000) && most <= Some(&100_000),
                "{delay} passes: {least:?} to {most:?}"
            );
        }
    }

    #[test]
    fn with_jitter_the_wait_grows_until_hardly_a_pose_misses_its_tick() {
        // An even spread of 100 us: its mean deviation is 25 us.
        let up_ns = |pass: u64| 100_000 + pass * 7919 % 100 * 1000;
        let (phase, waits) = play(0, 6000, 1, up_ns);
        let missed = waits.iter().filter(|wait| **wait > PERIOD_NS / 2).count();
        assert_eq!(missed, 0, "{:?}", phase.report());
        let mean = waits.iter().sum::<u64>() / waits.len() as u64;
        assert!((100_000..200_000).contains(&mean), "{mean}");
    }

    /// The clocks of two machines differ by up to 100 parts in a million.
    #[test]
    fn a_drift_of_the_clocks_is_followed() {
        for drift in [-100_i64, 100] {
            let up_ns = |pass: u64| {
                let drifted = 10_000_000 + drift * pass as i64;
                drifted as u64
            };
            let (_, waits) = play(0, 20_000, 1, up_ns);
            let (least, most) = (waits.iter().min(), waits.iter().max());
            assert!(
                least >= Some(&10_000) && most <= Some(&200_000),
                "{drift}: {least:?} to {most:?}"
            );
        }
    }

    proptest! {
        #[test]
        fn any_waits_keep_the_correction_small(
            waits in prop::collection::vec(any::<(u32, u32, u64)>(), 0..500),
            period_ns in 125_000u64..4_000_000,
        ) {
            let mut phase = Phase::new(period_ns);
            for (number, wait_us, age_ns) in waits {
                phase.heard(number, wait_us, age_ns);
                let correction = phase.correction_ns();
                prop_assert!(correction.unsigned_abs() <= period_ns / 500 + 1);
                prop_assert!(phase.report().aim_us * 1e3 <= 0.25 * period_ns as f64 + 1.0);
            }
        }
    }
}
