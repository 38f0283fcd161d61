//! Fate of each packet in one direction.

use std::time::Duration;

use fastrand::Rng;

use crate::Conditions;

/// Headers of IPv4 and UDP, bytes.
const HEADERS: u64 = 28;

/// Fate of a packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fate {
    /// The packet arrives.
    Arrives {
        /// Time of the arrival.
        at_ns: u64,
        /// Time of a second arrival.
        again_ns: Option<u64>,
    },
    /// The packet is lost on the way.
    Lost,
    /// The queue before the slowest link is full.
    Overflow,
    /// The path is cut.
    Cut,
}

/// Packets of a path by their fate. The sum of `arrived`, `lost`, `overflow` and `cut` is the number of packets sent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Packets that arrived, each counted once.
    pub arrived: u64,
    /// Packets that arrived twice.
    pub duplicated: u64,
    /// Packets that arrived before a packet that was sent earlier.
    pub reordered: u64,
    /// Packets lost at random.
    pub lost: u64,
    /// Packets lost at a full queue.
    pub overflow: u64,
    /// Packets lost while the path was cut.
    pub cut: u64,
    /// Bytes of UDP payload that arrived, second copies not counted.
    pub bytes: u64,
}

/// Direction of a network.
#[derive(Clone, Debug)]
pub struct Path {
    conditions: Conditions,
    rng: Rng,
    /// Whether the chain of losses is in its bad state.
    is_bad: bool,
    is_cut: bool,
    /// Time at which the slowest link has sent all packets in its queue.
    free_ns: u64,
    /// Latest arrival so far.
    latest_ns: u64,
    /// Time of the first packet, from which stalls count.
    began_ns: Option<u64>,
    counts: Counts,
}

fn ns(time: Duration) -> u64 {
    u64::try_from(time.as_nanos()).unwrap_or(u64::MAX)
}

impl Counts {
    /// Bytes that arrived with the headers of IPv4 and UDP, second copies not counted.
    pub fn bytes_on_the_wire(&self) -> u64 {
        self.bytes + self.arrived * HEADERS
    }
}

impl Path {
    /// A path of valid `conditions`, see [`Conditions::check`], whose random numbers follow from `seed`.
    pub fn new(conditions: Conditions, seed: u64) -> Self {
        Self {
            conditions,
            rng: Rng::with_seed(seed),
            is_bad: false,
            is_cut: false,
            free_ns: 0,
            latest_ns: 0,
            began_ns: None,
            counts: Counts::default(),
        }
    }

    /// Conditions in force.
    pub fn conditions(&self) -> &Conditions {
        &self.conditions
    }

    /// Replaces the conditions by valid ones. Packets on their way keep their fate.
    pub fn change(&mut self, conditions: Conditions) {
        self.conditions = conditions;
    }

    /// Cuts the path, or joins it again.
    pub fn cut(&mut self, is_cut: bool) {
        self.is_cut = is_cut;
    }

    /// Packets so far.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// Fate of a packet for which there is no place on the way.
    pub fn overflow(&mut self) -> Fate {
        self.counts.overflow += 1;
        Fate::Overflow
    }

    /// Fate of a packet of `bytes` of UDP payload, sent at `now_ns`. Calls come in the order of time.
    pub fn send(&mut self, now_ns: u64, bytes: usize) -> Fate {
        if self.is_cut {
            self.counts.cut += 1;
            return Fate::Cut;
        }
        // Each packet takes the same number of random numbers, so a change of one field leaves the other fates alone.
        let [step, early, late, again] = std::array::from_fn(|_| self.rng.f64());
        self.is_bad = if self.is_bad {
            step >= 1.0 / self.conditions.burst
        } else {
            step < self.conditions.worsening()
        };
        let resumed_ns = self.resumed(now_ns);
        let Some(sent_ns) = self.queued(resumed_ns, bytes) else {
            return self.overflow();
        };
        if self.is_bad {
            self.counts.lost += 1;
            return Fate::Lost;
        }
        let at_ns = if self.conditions.reorder {
            sent_ns + self.delay(early)
        } else {
            self.slot(sent_ns).max(self.latest_ns)
        };
        if at_ns < self.latest_ns {
            self.counts.reordered += 1;
        }
        self.latest_ns = self.latest_ns.max(at_ns);
        let again_ns =
            (again < self.conditions.duplicate).then(|| at_ns.max(sent_ns + self.delay(late)));
        self.counts.arrived += 1;
        self.counts.duplicated += u64::from(again_ns.is_some());
        self.counts.bytes += bytes as u64;
        Fate::Arrives { at_ns, again_ns }
    }

    /// Time at which the slowest link has sent a packet that comes at `now_ns`. `None`: its queue is full.
    fn queued(&mut self, now_ns: u64, bytes: usize) -> Option<u64> {
        let Some(rate) = self.conditions.rate else {
            return Some(now_ns);
        };
        let begins_ns = self.free_ns.max(now_ns);
        if begins_ns - now_ns > ns(self.conditions.queue) {
            return None;
        }
        let bits = u128::from((bytes as u64 + HEADERS) * 8);
        let takes_ns = bits * 1_000_000_000 / u128::from(rate);
        self.free_ns = begins_ns.saturating_add(u64::try_from(takes_ns).unwrap_or(u64::MAX));
        Some(self.free_ns)
    }

    /// End of the stall that `now_ns` lies in, or `now_ns`.
    fn resumed(&mut self, now_ns: u64) -> u64 {
        let began_ns = *self.began_ns.get_or_insert(now_ns);
        let Some((period, length)) = self.conditions.stall else {
            return now_ns;
        };
        let into = now_ns.saturating_sub(began_ns) % ns(period);
        // A stall ends each period, so that a path begins well.
        let begins = ns(period) - ns(length);
        if into < begins {
            now_ns
        } else {
            now_ns + (ns(period) - into)
        }
    }

    /// Arrival of a packet that is sent at `sent_ns` and waits for the next slot.
    fn slot(&self, sent_ns: u64) -> u64 {
        let (mean, half) = (ns(self.conditions.delay), ns(self.conditions.jitter));
        let next_ns = sent_ns.next_multiple_of((2 * half).max(1));
        next_ns + mean.saturating_sub(half)
    }

    /// Delay for a random number of 0 to 1.
    fn delay(&self, random: f64) -> u64 {
        let (mean, half) = (ns(self.conditions.delay), ns(self.conditions.jitter));
        mean.saturating_sub(half) + (2.0 * half as f64 * random) as u64
    }
}

#[cfg(test)]
mod tests;
