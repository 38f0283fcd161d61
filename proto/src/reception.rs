//! Quality of one direction, measured by its receiver and told to its sender.
//!
//! The receiver sees which packets are missing, and how much longer than the fastest ones they take. The sender's own
//! figures, from acknowledgements, count a reordered packet as lost and do not tell the directions apart.

use serde::{Deserialize, Serialize};

use crate::newest::ArrivalCounts;

/// Quality of a direction over the last windows: at 1 kHz of 60 ms for delays and 240 ms for losses, at lower rates of
/// 30 and 200 packets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Reception {
    /// Share of the packets that did not arrive in a window, in 255ths.
    pub lost: u8,
    /// Least delay of a window above the least delay of the last 4 to 8 seconds, in tenths of a millisecond. A
    /// queue on the way has this length.
    pub queue_100us: u16,
}

impl Reception {
    /// Share of the packets that did not arrive, 0 to 1.
    pub fn lost_share(&self) -> f64 {
        f64::from(self.lost) / 255.0
    }

    /// Wait in queues on the way, milliseconds.
    pub fn queue_ms(&self) -> f64 {
        f64::from(self.queue_100us) / 10.0
    }
}

/// Least length of a window of delays, nanoseconds.
const WINDOW_NS: u64 = 60_000_000;
/// Least number of packets in a window of delays. The least of few delays says more of the jitter than of queues.
const LEAST_DELAYS: u32 = 30;
/// Least length of a window of losses, nanoseconds.
const LOSSES_NS: u64 = 240_000_000;
/// Least number of packets in a window of losses: a share of less says little.
const LEAST_PACKETS: u64 = 200;
/// Time after which a least delay is forgotten, nanoseconds: once to twice this time. A clock that runs wrong by 500
/// parts in a million, the kernel's limit, then looks like a queue of 4 ms at most.
const FORGOTTEN_NS: u64 = 4_000_000_000;

/// Measurement of a direction at its receiver. The clocks of both ends need no common zero.
#[derive(Clone, Copy, Debug, Default)]
pub struct Meter {
    window: Window,
    /// Counts of arrivals at the begin of the window of losses, and its time.
    counts: ArrivalCounts,
    counts_ns: u64,
    /// Least delay of this and the previous four seconds, on an unknown zero.
    least: [Option<i64>; 2],
    least_began_ns: u64,
    value: Reception,
}

#[derive(Clone, Copy, Debug, Default)]
struct Window {
    began_ns: u64,
    packets: u32,
    least_delay: Option<i64>,
}

impl Meter {
    /// A meter without any arrival.
    pub fn new() -> Self {
        Self::default()
    }

    /// Takes a packet that was sent at `sent_ns` of the sender's clock and arrived at `now_ns` of the receiver's.
    /// `counts` are those of all arrivals so far.
    pub fn arrived(&mut self, now_ns: u64, sent_ns: u64, counts: ArrivalCounts) {
        // The difference of two unrelated clocks wraps without harm: only differences of it are used.
        let delay = now_ns.wrapping_sub(sent_ns).cast_signed();
        let is_less = |least: Option<i64>| least.is_none_or(|least| delay < least);
        if self.least[0].is_none() {
            self.least_began_ns = now_ns;
            self.window.began_ns = now_ns;
            (self.counts, self.counts_ns) = (counts, now_ns);
        }
        if now_ns.saturating_sub(self.least_began_ns) >= FORGOTTEN_NS {
            self.least = [None, self.least[0]];
            self.least_began_ns = now_ns;
        }
        if is_less(self.least[0]) {
            self.least[0] = Some(delay);
        }
        if is_less(self.window.least_delay) {
            self.window.least_delay = Some(delay);
        }
        self.window.packets += 1;
        let is_long = now_ns.saturating_sub(self.window.began_ns) >= WINDOW_NS;
        if is_long && self.window.packets >= LEAST_DELAYS {
            self.close(now_ns);
        }
        if now_ns.saturating_sub(self.counts_ns) >= LOSSES_NS {
            self.count(now_ns, counts);
        }
    }

    /// Quality of the last full window; zero before the first one.
    pub fn value(&self) -> Reception {
        self.value
    }

    /// Ends a window of delays.
    fn close(&mut self, now_ns: u64) {
        let least = self.least.into_iter().flatten().min();
        let queue_ns = match (self.window.least_delay, least) {
            (Some(delay), Some(least)) => delay.saturating_sub(least).max(0),
            _ => 0,
        };
        self.value.queue_100us = u16::try_from(queue_ns / 100_000).unwrap_or(u16::MAX);
        self.window = Window {
            began_ns: now_ns,
            packets: 0,
            least_delay: None,
        };
    }

    /// Ends a window of losses, if it has enough packets.
    fn count(&mut self, now_ns: u64, counts: ArrivalCounts) {
        let arrived =
            (counts.accepted + counts.late).saturating_sub(self.counts.accepted + self.counts.late);
        let lost = counts.lost.saturating_sub(self.counts.lost);
        let sent = arrived + lost;
        if sent >= LEAST_PACKETS {
            self.value.lost = (lost as f64 / sent as f64 * 255.0).round() as u8;
            (self.counts, self.counts_ns) = (counts, now_ns);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const MS: u64 = 1_000_000;

    /// Values after each of `count` packets, one a millisecond, with a delay in milliseconds; `None` is a lost packet.
    fn play(count: u64, delay_ms: impl Fn(u64) -> Option<u64>) -> Vec<Reception> {
        let mut meter = Meter::new();
        let mut counts = ArrivalCounts::default();
        let arrive = |k| match delay_ms(k) {
            Some(delay) => {
                counts.accepted += 1;
                // The sender's clock is an hour ahead.
                meter.arrived((k + delay) * MS, (k + 3_600_000) * MS, counts);
                meter.value()
            }
            None => {
                counts.lost += 1;
                meter.value()
            }
        };
        (0..count).map(arrive).collect()
    }

    #[test]
    fn a_quiet_path_has_neither_loss_nor_queue() {
        let values = play(1000, |k| Some(20 + k % 3));
        assert!(values.iter().all(|value| *value == Reception::default()));
    }

    #[test]
    fn a_queue_is_told_within_two_windows_by_its_length() {
        let values = play(1000, |k| Some(if k < 500 { 20 } else { 50 + k % 4 }));
        assert_eq!(values[499], Reception::default());
        assert_eq!(values[650].queue_100us, 300);
        assert_eq!(values[999].queue_100us, 300);
    }

    #[test]
    fn every_fifth_packet_lost_is_a_fifth() {
        let values = play(2000, |k| (k % 5 != 0).then_some(10));
        let share = values[1999].lost_share();
        assert!((share - 0.2).abs() < 0.02, "{share}");
    }

    /// The clock of one end runs too slow by 500 parts in a million, the largest correction of the kernel.
    #[test]
    fn a_clock_that_runs_wrong_is_a_short_queue() {
        let mut meter = Meter::new();
        let mut counts = ArrivalCounts::default();
        for k in 0..60_000 {
            counts.accepted += 1;
            meter.arrived(k * (MS + 500), k * MS, counts);
            assert!(meter.value().queue_ms() <= 4.1, "{:?}", meter.value());
        }
    }

    /// A longer route is no queue.
    #[test]
    fn a_longer_path_is_the_new_least_after_eight_seconds() {
        let values = play(12_000, |k| Some(if k < 1000 { 10 } else { 40 }));
        assert_eq!(values[3000].queue_100us, 300);
        assert_eq!(values[11_999].queue_100us, 0);
    }

    proptest! {
        #[test]
        fn any_times_and_counts_give_a_value(
            packets in prop::collection::vec(any::<(u64, u64, u32, u32)>(), 0..200),
        ) {
            let mut meter = Meter::new();
            for (now_ns, sent_ns, accepted, lost) in packets {
                let counts = ArrivalCounts {
                    accepted: accepted.into(),
                    lost: lost.into(),
                    ..ArrivalCounts::default()
                };
                meter.arrived(now_ns, sent_ns, counts);
                prop_assert!(meter.value().lost_share() <= 1.0);
            }
        }
    }
}
