//! Force that the hand felt, against the force that the station sent: facts beside a grade, which no metric uses.
//!
//! A sample tells what the device displayed when it measured a pose. The displayed wrench was sent some ticks before. A
//! sample is therefore compared with all forces sent in the time of [`BEFORE_S`] up to its tick: less than the least of
//! them, or more than the largest.

use std::collections::VecDeque;

use serde::Serialize;
use sulcus_core::MAX_TOOLS;

use super::stats::rounded;
use crate::record::row::Row;

/// Longest way of a wrench to the hand and back, seconds: the timeout of poses. A longer delay is a gap.
pub const BEFORE_S: f64 = 0.05;
/// Least sent force that is compared, newtons: a weaker one is near the friction of a device. Chosen.
pub const LEAST_N: f64 = 0.05;
/// Share of the sent force below which the hand felt less, and its inverse above which the hand felt more.
pub const SHARE: f64 = 0.9;
/// Share of the compared time from which a grade has a reservation, percent. Chosen.
pub const MUCH_PERCENT: f64 = 20.0;
/// Least compared time for a reservation, seconds. Chosen.
pub const LEAST_S: f64 = 1.0;

/// Force that the hand felt over a session.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Felt {
    /// Number of samples.
    pub samples: u64,
    /// Samples with a number that is not finite. They are not compared.
    pub invalid: u64,
    /// Largest displayed force, newtons.
    pub largest_force_n: f64,
    /// Compared time: with a sent force of [`LEAST_N`] or more, seconds.
    pub compared_s: f64,
    /// Share of that time with less than 90 % of the sent force, percent. None without compared time.
    pub below_percent: Option<f64>,
    /// Share of that time with more than 111 % of the sent force, percent. None without compared time.
    pub above_percent: Option<f64>,
}

impl Felt {
    /// Reservation about a grade, in words; empty if the hand felt about what was sent.
    pub fn reservation(&self) -> String {
        let much = |percent: Option<f64>| {
            percent.filter(|percent| self.compared_s >= LEAST_S && *percent > MUCH_PERCENT)
        };
        let of = [
            (self.below_percent, "less than 90 %"),
            (self.above_percent, "more than 111 %"),
        ];
        let said = of.into_iter().filter_map(|(percent, what)| {
            let percent = much(percent)?;
            Some(format!(
                "{what} of the sent force in {percent:.0} % of {:.0} s",
                self.compared_s
            ))
        });
        said.collect::<Vec<_>>().join("; ")
    }
}

/// Comparison of the rows of a session, one after another.
#[derive(Clone, Debug)]
pub(super) struct Feeling {
    tick_s: f64,
    /// Tick and force sent in it, newtons, of the last [`BEFORE_S`], for each tool.
    sent: [VecDeque<(u64, f64)>; MAX_TOOLS],
    /// Tick of the last sample of each tool.
    last: [Option<u64>; MAX_TOOLS],
    felt: Felt,
    below_s: f64,
    above_s: f64,
}

impl Feeling {
    /// Comparison before the first row, at `tick_s` seconds per tick.
    pub fn new(tick_s: f64) -> Self {
        Self {
            tick_s,
            sent: Default::default(),
            last: [None; MAX_TOOLS],
            felt: Felt::default(),
            below_s: 0.0,
            above_s: 0.0,
        }
    }

    /// Takes in a row.
    pub fn row(&mut self, row: &Row) {
        let ticks = (BEFORE_S / self.tick_s).round() as u64;
        for t in 0..MAX_TOOLS {
            let [x, y, z, ..] = row.wrench[t].map(f64::from);
            let force = (x * x + y * y + z * z).sqrt();
            let sent = &mut self.sent[t];
            while sent
                .front()
                .is_some_and(|(tick, _)| tick + ticks < row.tick)
            {
                sent.pop_front();
            }
            sent.push_back((row.tick, force));
            let Some(sample) = row.device[t] else {
                continue;
            };
            let last = self.last[t].replace(row.tick);
            self.felt.samples += 1;
            if !sample.is_finite() {
                self.felt.invalid += 1;
                continue;
            }
            let felt = sample.force_n();
            if felt > self.felt.largest_force_n {
                self.felt.largest_force_n = felt;
            }
            let since = last.map_or(1, |last| row.tick.saturating_sub(last).clamp(1, ticks));
            let dt = since as f64 * self.tick_s;
            let forces = || sent.iter().map(|(_, force)| *force);
            let least = forces().fold(f64::INFINITY, |a, b| if b < a { b } else { a });
            let most = forces().fold(0.0, |a, b| if b > a { b } else { a });
            // A NaN is not compared.
            if least >= LEAST_N && most.is_finite() {
                self.felt.compared_s += dt;
                self.below_s += if felt < SHARE * least { dt } else { 0.0 };
                self.above_s += if felt > most / SHARE { dt } else { 0.0 };
            }
        }
    }

    /// Begins another recording of the session, whose ticks begin anew.
    pub fn begin(&mut self) {
        self.sent.iter_mut().for_each(VecDeque::clear);
        self.last = [None; MAX_TOOLS];
    }

    /// Facts so far; `None` without a sample.
    pub fn felt(&self) -> Option<Felt> {
        let felt = self.felt;
        let share =
            |part: f64| (felt.compared_s > 0.0).then(|| rounded(100.0 * part / felt.compared_s, 1));
        (felt.samples > 0).then(|| Felt {
            largest_force_n: rounded(felt.largest_force_n, 3),
            compared_s: rounded(felt.compared_s, 2),
            below_percent: share(self.below_s),
            above_percent: share(self.above_s),
            ..felt
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::sample::DeviceSample;
    use sulcus_core::TickInput;

    /// Facts of 4 s in which `sent` newtons rise and fall, and the hand feels `share` of them `late` ticks later.
    fn session(share: f64, late: usize) -> Felt {
        let mut feeling = Feeling::new(1e-3);
        let sent: Vec<f32> = (0..4000)
            .map(|k| (0.5 + 0.4 * libm::sin(f64::from(k) * 3e-3)) as f32)
            .collect();
        for k in 0..4000_usize {
            let displayed = k.checked_sub(late).map_or(0.0, |k| sent[k] * share as f32);
            let sample = DeviceSample {
                sequence: k as u32,
                displayed: [0.0, 0.0, displayed, 0.0, 0.0, 0.0],
                ..DeviceSample::default()
            };
            feeling.row(&Row {
                tick: k as u64 + 1,
                time_unix_ns: 0,
                input: TickInput::IDLE,
                hash: 0,
                wrench: [[0.0, 0.0, sent[k], 0.0, 0.0, 0.0], [0.0; 6]],
                status: [0; MAX_TOOLS],
                device: [(k % 2 == 0).then_some(sample), None],
            });
        }
        feeling.felt().expect("samples")
    }

    #[test]
    fn a_late_hand_feels_what_was_sent_and_a_weak_device_does_not() {
        for late in [0, 3, 40] {
            let felt = session(1.0, late);
            assert_eq!(felt.samples, 2000);
            assert!((felt.compared_s - 4.0).abs() < 2e-3, "{felt:?}");
            assert!(felt.below_percent <= Some(1.0), "{late}: {felt:?}");
            assert_eq!(
                (felt.above_percent, felt.reservation().as_str()),
                (Some(0.0), "")
            );
            assert!((felt.largest_force_n - 0.9).abs() < 1e-3);
        }
        let weak = session(0.5, 3);
        assert!(weak.below_percent > Some(99.0), "{weak:?}");
        let said = weak.reservation();
        assert_eq!(said, "less than 90 % of the sent force in 100 % of 4 s");
        let strong = session(2.0, 3);
        assert!(strong.above_percent > Some(95.0), "{strong:?}");
        assert!(strong.reservation().starts_with("more than 111 %"));
        assert_eq!(Feeling::new(1e-3).felt(), None);
    }

    #[test]
    fn a_sample_that_is_no_number_is_counted_and_not_compared() {
        let mut feeling = Feeling::new(1e-3);
        let sample = DeviceSample {
            displayed: [f32::NAN; 6],
            ..DeviceSample::default()
        };
        let bytes = [0; Row::BYTES];
        let row = Row::from_bytes(&bytes).expect("a row");
        feeling.row(&row.with_device([Some(sample), None]));
        let felt = feeling.felt().expect("a sample");
        assert_eq!(
            (felt.samples, felt.invalid, felt.largest_force_n),
            (1, 1, 0.0)
        );
        assert_eq!(felt.below_percent, None);
    }
}
