//! Times of the periods of a device's thread.

/// Deadlines at a fixed period.
#[derive(Clone, Copy, Debug)]
pub struct Pace {
    period_ns: u64,
    next_ns: u64,
}

impl Pace {
    /// Deadlines from `now_ns` on.
    pub fn new(period_ns: u64, now_ns: u64) -> Self {
        Self {
            period_ns,
            next_ns: now_ns,
        }
    }

    /// Time of the next period, at least half a period after `now_ns`. Periods that are missed are left out.
    pub fn next(&mut self, now_ns: u64) -> u64 {
        self.next_ns += self.period_ns;
        if self.next_ns + self.period_ns < now_ns {
            self.next_ns = now_ns;
        }
        self.next_ns.max(now_ns + self.period_ns / 2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rate_is_bounded_after_a_stall() {
        let mut pace = Pace::new(250, 1000);
        assert_eq!(pace.next(1010), 1250);
        // One late period is caught up, at no more than twice the rate.
        assert_eq!(pace.next(1500), 1625);
        assert_eq!(pace.next(1625), 1750);
        assert_eq!(pace.next(1750), 2000);
        let mut now = 9000;
        let mut count = 0;
        while now < 10_000 {
            now = pace.next(now);
            count += 1;
        }
        assert!(count <= 5, "{count}");
    }
}
