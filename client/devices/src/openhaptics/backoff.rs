//! Times between the trials to open a device that was lost.

/// Shortest time, nanoseconds.
const FIRST_NS: u64 = 500_000_000;

/// Longest time, nanoseconds.
const LONGEST_NS: u64 = 8_000_000_000;

/// Time in use after which a loss is a new one, nanoseconds.
const STEADY_NS: u64 = 3_000_000_000;

/// Times of the trials of one device.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Backoff {
    due_ns: u64,
    wait_ns: u64,
    opened_ns: Option<u64>,
}

impl Backoff {
    /// The device was lost at `now_ns`. Returns false if it had returned shortly before: the times then go on.
    pub fn lost(&mut self, now_ns: u64) -> bool {
        if self
            .opened_ns
            .is_some_and(|opened| now_ns.saturating_sub(opened) < STEADY_NS)
        {
            self.failed(now_ns);
            return false;
        }
        (self.due_ns, self.wait_ns) = (now_ns + FIRST_NS, FIRST_NS);
        true
    }

    /// The device has returned at `now_ns`.
    pub fn opened(&mut self, now_ns: u64) {
        self.opened_ns = Some(now_ns);
    }

    /// Whether a trial is due.
    pub fn is_due(&self, now_ns: u64) -> bool {
        now_ns >= self.due_ns
    }

    /// A trial failed at `now_ns`: the next one comes after twice the time.
    pub fn failed(&mut self, now_ns: u64) {
        self.wait_ns = (self.wait_ns * 2).min(LONGEST_NS);
        self.due_ns = now_ns + self.wait_ns;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_double_up_to_eight_seconds() {
        let mut backoff = Backoff::default();
        assert!(backoff.lost(0));
        let mut now = 0;
        let mut waits = Vec::new();
        for _ in 0..6 {
            let from = now;
            while !backoff.is_due(now) {
                now += 100_000_000;
            }
            waits.push((now - from) / 100_000_000);
            backoff.failed(now);
        }
        assert_eq!(waits, [5, 10, 20, 40, 80, 80]);
        // A device that returns for a moment does not start the times anew.
        backoff.opened(now);
        assert!(!backoff.lost(now + 1_000_000));
        assert!(!backoff.is_due(now + LONGEST_NS));
        backoff.opened(now);
        assert!(backoff.lost(now + STEADY_NS));
        assert!(backoff.is_due(now + STEADY_NS + FIRST_NS));
    }
}
