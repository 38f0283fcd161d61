//! Window of the inputs that are on their way to the server.
//!
//! The congestion window of the connection is constant, because a fall of it would delay poses. The inputs of ticks at
//! the hand are the only data of a client that can fill a thin uplink, and a full queue loses live poses. The window
//! falls as soon as the round trip says that a queue grows, like that of LEDBAT (RFC 6817).

use std::time::{Duration, Instant};

/// Window at the begin of a connection, bytes.
pub(super) const BEGIN: usize = 16 * 1024;
/// Least and largest window, bytes. The largest one carries two hands over a satellite.
const LEAST: usize = 600;
const MOST: usize = 128 * 1024;
/// Wished queueing delay.
const QUEUE: Duration = Duration::from_millis(60);
/// Least time between two changes.
const EVERY: Duration = Duration::from_millis(50);
/// Time after which the least round trip is found anew: a path may become longer.
const MEMORY: Duration = Duration::from_secs(30);
/// Length of a drain beyond two round trips: the smoothed round trip follows within about 25 packets.
const DRAIN: Duration = Duration::from_millis(500);

/// Window of one connection.
#[derive(Debug)]
pub(super) struct Pace {
    window: usize,
    least: Duration,
    /// Whether the window held back data since the newest change.
    limited: bool,
    /// Whether data of this sender were seen in a queue in the present period.
    filled: bool,
    /// Begin of the present period, and time of the newest change.
    times: Option<(Instant, Instant)>,
    /// End of a drain.
    drain: Option<Instant>,
}

impl Pace {
    /// Window at the begin of a connection whose round trip is `rtt`.
    pub fn new(rtt: Duration) -> Self {
        Self {
            window: BEGIN,
            least: rtt,
            limited: false,
            filled: false,
            times: None,
            drain: None,
        }
    }

    /// Bytes that may be on their way.
    pub fn window(&self) -> usize {
        if self.drain.is_some() {
            // One frame at a time.
            1
        } else {
            self.window
        }
    }

    /// Takes the present round trip, and whether the window holds back data now.
    pub fn take(&mut self, now: Instant, rtt: Duration, limited: bool) {
        let (since, changed) = *self.times.get_or_insert((now, now));
        self.limited |= limited;
        if let Some(end) = self.drain {
            if now >= end {
                self.begin_period(now, rtt);
            }
            return;
        }
        self.least = self.least.min(rtt);
        if now - since >= MEMORY {
            if self.filled {
                // A queue of this sender must not be taken for the path.
                self.drain = Some(now + rtt * 2 + DRAIN);
            } else {
                self.begin_period(now, rtt);
            }
            return;
        }
        // A change is seen after a round trip.
        if now - changed < EVERY.max(rtt) {
            return;
        }
        let queue = rtt.saturating_sub(self.least);
        self.filled |= self.limited && queue > QUEUE / 2;
        // A proportional change settles at the wished queue, where a constant one would swing around it.
        let off = 1.0 - queue.as_secs_f64() / QUEUE.as_secs_f64();
        let change = 1.0 + (off / 4.0).max(-0.25);
        // A window that holds back nothing says nothing about the path.
        if change < 1.0 || self.limited {
            self.window = ((self.window as f64 * change) as usize).clamp(LEAST, MOST);
        }
        self.limited = false;
        self.times = Some((since, now));
    }

    /// Begins a period on a path whose round trip without a queue of this sender is `rtt`.
    fn begin_period(&mut self, now: Instant, rtt: Duration) {
        *self = Self {
            window: self.window,
            times: Some((now, now)),
            ..Self::new(rtt)
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sender that always has data, on a link with a rate, bytes per millisecond, a delay there and back, and a queue
    /// of `room_ms`. Returns the share of the link that is used, and of the data that is lost.
    fn fill(rate: f64, delay_ms: f64, room_ms: f64, seconds: u64) -> (f64, f64) {
        let begin = Instant::now();
        let at = |ms: f64| begin + Duration::from_secs_f64(ms / 1e3);
        let smooth = |old: f64, new: f64| old + (new - old) / 8.0;
        let (mut srtt, mut queue) = (delay_ms, 0.0f64);
        let mut pace = Pace::new(Duration::from_secs_f64(srtt / 1e3));
        let (mut carried, mut lost, mut sent) = (0.0, 0.0, 0.0);
        // Arrivals of answers: time, bytes, and round trip unless it is the answer to a repetition.
        let mut answers: std::collections::VecDeque<(f64, f64, Option<f64>)> = Default::default();
        let mut on_the_way = 0.0;
        for ms in 0..seconds * 1000 {
            if ms == 5000 {
                // The first seconds find the window.
                (carried, lost, sent) = (0.0, 0.0, 0.0);
            }
            let ms = ms as f64;
            carried += rate.min(queue);
            queue = (queue - rate).max(0.0);
            while answers.front().is_some_and(|(due, _, _)| *due <= ms) {
                let (_, bytes, rtt) = answers.pop_front().expect("an answer");
                on_the_way -= bytes;
                srtt = rtt.map_or(srtt, |rtt| smooth(srtt, rtt));
            }
            let limited = on_the_way >= pace.window() as f64;
            pace.take(at(ms), Duration::from_secs_f64(srtt / 1e3), limited);
            while on_the_way < pace.window() as f64 {
                let bytes = 100.0;
                on_the_way += bytes;
                sent += bytes;
                let wait = queue / rate;
                if wait > room_ms {
                    // The loss is found after a round trip.
                    lost += bytes;
                    answers.push_back((ms + room_ms + delay_ms, bytes, None));
                    break;
                }
                queue += bytes;
                answers.push_back((ms + wait + delay_ms, bytes, Some(wait + delay_ms)));
            }
        }
        (carried / (rate * (seconds - 5) as f64 * 1e3), lost / sent)
    }

    #[test]
    fn a_thin_link_is_used_and_its_queue_stays_short() {
        for (rate, delay_ms) in [(18.75, 20.0), (18.75, 120.0), (6.0, 40.0), (40.0, 60.0)] {
            let (used, lost) = fill(rate, delay_ms, 200.0, 600);
            assert!(used > 0.9, "{rate} bytes/ms, {delay_ms} ms: {used}");
            assert!(lost < 0.05, "{rate} bytes/ms, {delay_ms} ms: {lost}");
        }
    }

    /// Window after `seconds` on a path whose round trip becomes 600 ms after 10 s.
    fn on_a_longer_path(limited: bool, seconds: u64) -> usize {
        let begin = Instant::now();
        let mut pace = Pace::new(Duration::from_millis(20));
        for ms in 0..seconds * 1000 {
            let rtt = Duration::from_millis(if ms < 10_000 { 20 } else { 600 });
            pace.take(begin + Duration::from_millis(ms), rtt, limited);
        }
        pace.window()
    }

    #[test]
    fn a_longer_path_is_no_queue_for_ever() {
        assert_eq!(on_a_longer_path(true, 10), MOST);
        assert!(on_a_longer_path(true, 25) < BEGIN);
        assert_eq!(on_a_longer_path(true, 58), MOST);
    }

    /// A drain on such a path would hold the recording back for more than a second in each period.
    #[test]
    fn a_path_without_a_queue_is_not_drained() {
        let begin = Instant::now();
        let mut pace = Pace::new(Duration::from_millis(280));
        for ms in 0..300_000 {
            // Jitter, and losses that fill the window for a while.
            let rtt = Duration::from_millis(280 + ms % 17);
            pace.take(begin + Duration::from_millis(ms), rtt, ms % 5000 < 600);
            assert!(pace.window() >= BEGIN, "{ms} ms");
        }
    }

    #[test]
    fn a_window_that_holds_back_nothing_does_not_grow() {
        assert_eq!(on_a_longer_path(false, 10), BEGIN);
    }
}
