//! Rate of datagrams by the quality that their receiver tells.
//!
//! All data of an application is subject to congestion control (RFC 9221, section 5.4). The connection has a fixed
//! window, so its datagrams adapt by their rate: all, every second, fourth or tenth. The ladder has no clock.

use std::time::Duration;

use sulcus_proto::limits;
use sulcus_proto::reception::Reception;

/// Steps of the ladder: one datagram of so many is sent. At 1 kHz: 1000, 500, 250 and 100 Hz.
pub const STEPS: [u32; 4] = [1, 2, 4, 10];

/// Wait in queues above which the rate falls, milliseconds.
const QUEUED_MS: f64 = 5.0;
/// Wait in queues below which the rate may rise, milliseconds.
const FREE_MS: f64 = 2.0;
/// Share of lost datagrams above which the rate falls. Wi-Fi and mobile networks lose up to 5 % at any rate.
const LOST: f64 = 0.15;
/// Share of lost datagrams below which the rate may rise.
const FEW_LOST: f64 = 0.10;
/// Longest time between two datagrams at a lower rate, nanoseconds: half of the silence after which the force falls.
const RAREST_NS: u64 = limits::WRENCH_SILENT.as_nanos() as u64 / 2;
/// Lowest step for losses alone. On a path that loses at random, rarer datagrams have longer gaps.
const LOWEST_FOR_LOSSES: usize = 2;
/// Gap between two reports after which an earlier report says nothing of the time between, nanoseconds.
const SILENT_NS: u64 = 50_000_000;
/// Time that a queue must last before the rate falls, nanoseconds. The packets of a short stall, as in a handover of a
/// mobile network, arrive late and are no sign of a rate that is too high.
const LASTS_NS: u64 = 100_000_000;
/// Time after a change, beyond a round trip, in which the told quality may be that of the former rate, nanoseconds.
const SETTLES_NS: u64 = 130_000_000;
/// Time after a change beyond which no round trip is asked for, nanoseconds. A connection is lost after 3 s.
const LONGEST_SETTLING_NS: u64 = 5_000_000_000;
/// Time that losses must last, nanoseconds: more than the quarter of a second of one share. An outage is no sign of a
/// rate that is too high.
const LOSSES_LAST_NS: u64 = 400_000_000;
/// Time of good quality before the first attempt at a higher rate, nanoseconds.
const PATIENCE_NS: u64 = 10_000_000_000;
/// Longest time before an attempt, nanoseconds. Each failed attempt doubles the time.
const LONGEST_NS: u64 = 160_000_000_000;
/// Time after a rise in which a fall means that the attempt has failed, nanoseconds.
const FAILED_NS: u64 = 3_000_000_000;

/// Ladder of rates of one sender.
#[derive(Clone, Copy, Debug)]
pub struct Ladder {
    step: usize,
    /// Lowest step that the period of the datagrams permits.
    lowest: usize,
    told_ns: u64,
    changed_ns: u64,
    good_since_ns: Option<u64>,
    queued_since_ns: Option<u64>,
    lossy_since_ns: Option<u64>,
    patience_ns: u64,
    /// Whether the last change was a rise.
    has_risen: bool,
    falls: u64,
    /// Number of datagrams offered.
    offered: u32,
}

impl Ladder {
    /// Ladder at the full rate, of one datagram in each period. At the lowest rate datagrams are at most 10 ms apart.
    pub fn new(period_ns: u64) -> Self {
        let is_permitted = |step: &&u32| u64::from(**step) * period_ns <= RAREST_NS;
        Self::with_lowest(STEPS.iter().filter(is_permitted).count().saturating_sub(1))
    }

    fn with_lowest(lowest: usize) -> Self {
        Self {
            step: 0,
            lowest,
            told_ns: 0,
            changed_ns: 0,
            good_since_ns: None,
            queued_since_ns: None,
            lossy_since_ns: None,
            patience_ns: PATIENCE_NS,
            has_risen: false,
            falls: 0,
            offered: 0,
        }
    }

    /// Begins again at the full rate, for another path.
    pub fn restart(&mut self) {
        *self = Self {
            falls: self.falls,
            ..Self::with_lowest(self.lowest)
        };
    }

    /// Number of offered datagrams for each one that is sent.
    pub fn divisor(&self) -> u32 {
        STEPS[self.step]
    }

    /// Number of falls so far.
    pub fn falls(&self) -> u64 {
        self.falls
    }

    /// Whether the datagram offered now is sent.
    pub fn sends(&mut self) -> bool {
        let sends = self.offered.is_multiple_of(self.divisor());
        self.offered = self.offered.wrapping_add(1);
        sends
    }

    /// Takes the quality that the receiver told, at `now_ns`. The round trip of the path is asked for after a change
    /// alone, because the question takes a lock.
    pub fn told(&mut self, now_ns: u64, reception: Reception, rtt: impl FnOnce() -> Duration) {
        let (queue_ms, lost) = (reception.queue_ms(), reception.lost_share());
        let since_ns = now_ns.saturating_sub(self.changed_ns);
        if now_ns.saturating_sub(self.told_ns) > SILENT_NS {
            (self.queued_since_ns, self.lossy_since_ns) = (None, None);
        }
        self.told_ns = now_ns;
        since(&mut self.queued_since_ns, queue_ms > QUEUED_MS, now_ns);
        since(&mut self.lossy_since_ns, lost > LOST, now_ns);
        if self.changed_ns != 0 && since_ns < LONGEST_SETTLING_NS {
            let rtt_ns = u64::try_from(rtt().as_nanos()).unwrap_or(u64::MAX);
            if since_ns < SETTLES_NS.saturating_add(rtt_ns) {
                return;
            }
        }
        let lasts = |since_ns: Option<u64>, least_ns| {
            since_ns.is_some_and(|since_ns| now_ns.saturating_sub(since_ns) >= least_ns)
        };
        let is_queued = lasts(self.queued_since_ns, LASTS_NS);
        let is_lossy = lasts(self.lossy_since_ns, LOSSES_LAST_NS);
        if is_queued || is_lossy {
            self.good_since_ns = None;
            let lowest = if is_queued {
                self.lowest
            } else {
                self.lowest.min(LOWEST_FOR_LOSSES)
            };
            if self.step < lowest {
                let has_failed = self.has_risen && since_ns < FAILED_NS;
                self.patience_ns = if has_failed {
                    (self.patience_ns * 2).min(LONGEST_NS)
                } else {
                    PATIENCE_NS
                };
                self.falls += 1;
                self.change(now_ns, self.step + 1, false);
            }
        } else if queue_ms < FREE_MS && lost < FEW_LOST {
            let good_since_ns = *self.good_since_ns.get_or_insert(now_ns);
            if self.step > 0 && now_ns.saturating_sub(good_since_ns) >= self.patience_ns {
                self.change(now_ns, self.step - 1, true);
            }
        } else {
            self.good_since_ns = None;
        }
    }

    fn change(&mut self, now_ns: u64, step: usize, has_risen: bool) {
        self.step = step;
        self.changed_ns = now_ns;
        self.good_since_ns = None;
        // The share of losses is that of the former rate for a quarter of a second.
        self.lossy_since_ns = None;
        self.has_risen = has_risen;
        self.offered = 0;
    }
}

/// Keeps the time since which a condition holds.
fn since(since_ns: &mut Option<u64>, holds: bool, now_ns: u64) {
    if holds {
        since_ns.get_or_insert(now_ns);
    } else {
        *since_ns = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sulcus_proto::newest::ArrivalCounts;
    use sulcus_proto::reception::Meter;

    const MS: u64 = 1_000_000;

    fn queued(queue_ms: u16) -> Reception {
        Reception {
            lost: 0,
            queue_100us: queue_ms * 10,
        }
    }

    #[test]
    fn the_share_that_is_sent_is_that_of_the_step() {
        let mut ladder = Ladder::new(MS);
        let mut now = MS;
        for divisor in STEPS {
            assert_eq!(ladder.divisor(), divisor);
            let sent = (0..1000).filter(|_| ladder.sends()).count() as u32;
            assert_eq!(sent, 1000 / divisor);
            let falls = ladder.falls();
            while ladder.falls() == falls && ladder.divisor() < 10 {
                now += MS;
                ladder.told(now, queued(100), || Duration::from_nanos(MS));
            }
        }
        assert_eq!((ladder.divisor(), ladder.falls()), (10, 3));
    }

    #[test]
    fn loss_and_jitter_of_a_radio_network_change_nothing() {
        let mut ladder = Ladder::new(MS);
        for k in 0..10_000 {
            let reception = Reception {
                lost: (k % 20) as u8,
                queue_100us: (k % 50) as u16,
            };
            ladder.told(k * MS, reception, || Duration::from_nanos(40 * MS));
        }
        assert_eq!(ladder.divisor(), 1);
    }

    #[test]
    fn losses_that_last_lower_the_rate_and_an_outage_does_not() {
        let lossy = |lost| Reception {
            lost,
            queue_100us: 0,
        };
        let mut ladder = Ladder::new(MS);
        for k in 0..5000 {
            // After an outage of half a second: one share of three quarters.
            let lost = if (1000..1240).contains(&k) { 190 } else { 5 };
            ladder.told(k * MS, lossy(lost), || Duration::from_nanos(10 * MS));
        }
        assert_eq!(ladder.falls(), 0);
        for k in 5000..5900 {
            ladder.told(k * MS, lossy(60), || Duration::from_nanos(10 * MS));
        }
        assert_eq!(ladder.falls(), 2);
    }

    /// After 20 ms without a wrench the force falls, so at the lowest rate one wrench may be lost.
    #[test]
    fn at_the_lowest_rate_a_lost_wrench_leaves_the_force() {
        for (rate_hz, lowest) in [(250, 2), (500, 4), (1000, 10), (2000, 10), (8000, 10)] {
            let mut ladder = Ladder::new(1_000_000_000 / rate_hz);
            for k in 1..2000 {
                ladder.told(k * MS, queued(100), || Duration::from_nanos(0));
            }
            assert_eq!(ladder.divisor(), lowest, "{rate_hz} Hz");
            let gap_ns = 2 * u64::from(lowest) * 1_000_000_000 / rate_hz;
            assert!(u128::from(gap_ns) <= limits::WRENCH_SILENT.as_nanos());
        }
    }

    #[test]
    fn losses_alone_do_not_lead_to_the_lowest_rate() {
        let mut ladder = Ladder::new(MS);
        let lossy = Reception {
            lost: 100,
            queue_100us: 0,
        };
        for k in 1..10_000 {
            ladder.told(k * MS, lossy, || Duration::from_nanos(0));
        }
        assert_eq!(ladder.divisor(), 4);
    }

    /// Reports at the lowest rate come every 10 ms; a stall of 150 ms lies between two that tell of a queue.
    #[test]
    fn a_gap_between_two_reports_is_no_queue_that_lasts() {
        let mut ladder = Ladder::new(MS);
        for k in 1..100 {
            let begin = k * 1000 * MS;
            ladder.told(begin, queued(6), || Duration::from_nanos(0));
            ladder.told(begin + 150 * MS, queued(6), || Duration::from_nanos(0));
            for good in 1..80 {
                ladder.told(begin + (150 + good * 10) * MS, queued(0), || {
                    Duration::from_nanos(0)
                });
            }
        }
        assert_eq!(ladder.falls(), 0);
    }

    /// Wi-Fi with a jitter of 3 ms and bursts of losses, after a second in which another flow has filled the queue.
    #[test]
    fn on_a_radio_network_the_full_rate_comes_back() {
        let mut rng = 1_u64;
        let mut random = || {
            rng = rng
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (rng >> 33) as f64 / (1_u64 << 31) as f64
        };
        let (mut ladder, mut meter) = (Ladder::new(MS), Meter::new());
        let mut counts = ArrivalCounts::default();
        let mut is_bad = false;
        let mut lowest = 1;
        for k in 1..120_000_u64 {
            if !ladder.sends() {
                continue;
            }
            is_bad = random() < if is_bad { 0.66 } else { 0.007 };
            let queue_ns = if (10_000..11_000).contains(&k) {
                60 * MS
            } else {
                0
            };
            let jitter_ns = (random() * 6e6) as u64;
            if is_bad {
                counts.lost += 1;
            } else {
                counts.accepted += 1;
                let now_ns = k * MS + 4 * MS + queue_ns + jitter_ns;
                meter.arrived(now_ns, k * MS, counts);
                ladder.told(now_ns, meter.value(), || Duration::from_nanos(8 * MS));
            }
            lowest = lowest.max(ladder.divisor());
        }
        assert!(lowest > 1, "the queue was not seen");
        assert_eq!(ladder.divisor(), 1);
    }

    #[test]
    fn a_stall_of_a_moment_changes_nothing() {
        let mut ladder = Ladder::new(MS);
        for k in 0..10_000 {
            let queue_ms = if k % 1000 < 90 { 150 } else { 0 };
            ladder.told(k * MS, queued(queue_ms), || Duration::from_nanos(50 * MS));
        }
        assert_eq!((ladder.divisor(), ladder.falls()), (1, 0));
    }

    #[test]
    fn a_fall_waits_for_its_effect_before_the_next_one() {
        let mut ladder = Ladder::new(MS);
        let divisor_at: Vec<u32> = (0..401)
            .map(|k| {
                ladder.told((1000 + k) * MS, queued(50), || {
                    Duration::from_nanos(20 * MS)
                });
                ladder.divisor()
            })
            .collect();
        assert_eq!((divisor_at[99], divisor_at[100]), (1, 2));
        assert_eq!((divisor_at[249], divisor_at[250]), (2, 4));
        assert_eq!((divisor_at[399], divisor_at[400]), (4, 10));
    }

    /// A link of half the full rate: each attempt at the full rate makes a queue, and the next one waits twice as long.
    #[test]
    fn attempts_at_a_rate_that_is_too_high_become_rare() {
        let mut ladder = Ladder::new(MS);
        let mut attempts = Vec::new();
        let mut before = 1;
        for k in 1..400_000_u64 {
            let queue_ms = if ladder.divisor() == 1 { 20 } else { 0 };
            ladder.told(k * MS, queued(queue_ms), || Duration::from_nanos(20 * MS));
            if before == 2 && ladder.divisor() == 1 {
                attempts.push(k);
            }
            before = ladder.divisor();
        }
        let waits: Vec<u64> = attempts.windows(2).map(|pair| pair[1] - pair[0]).collect();
        assert!(attempts.len() >= 4, "{attempts:?}");
        assert!(
            waits.windows(2).all(|pair| pair[1] > pair[0] * 3 / 2),
            "{waits:?}"
        );
    }

    #[test]
    fn a_better_path_has_the_full_rate_again() {
        let mut ladder = Ladder::new(MS);
        for k in 1..1000 {
            ladder.told(k * MS, queued(50), || Duration::from_nanos(20 * MS));
        }
        assert_eq!(ladder.divisor(), 10);
        for k in 1000..35_000 {
            ladder.told(k * MS, queued(0), || Duration::from_nanos(20 * MS));
        }
        assert_eq!(ladder.divisor(), 1);
        for k in 35_000..35_200 {
            ladder.told(k * MS, queued(50), || Duration::from_nanos(0));
        }
        ladder.restart();
        assert_eq!((ladder.divisor(), ladder.falls()), (1, 4));
    }
}
