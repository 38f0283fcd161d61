//! Rates of a connection: a client that sends far more than its session needs is dropped.

use std::time::{Duration, Instant};

/// Multiple of the expected rate at which a connection is dropped.
const MANY: u32 = 4;
/// Window of the count.
const WINDOW: Duration = Duration::from_secs(1);
/// Control messages per second that a client may send at most. A person causes a few, a test bench thousands.
pub(super) const MESSAGES_PER_S: u32 = 50_000;

/// Counter of arrivals in windows of one second.
#[derive(Debug)]
pub(super) struct Rate {
    most: u32,
    count: u32,
    since: Option<Instant>,
}

impl Rate {
    /// Counter of datagrams at an expected rate per second.
    pub fn of_datagrams(per_s: u16) -> Self {
        Self::most(u32::from(per_s) * MANY)
    }

    /// Counter with a largest number per second.
    pub fn most(most: u32) -> Self {
        Self {
            most,
            count: 0,
            since: None,
        }
    }

    /// Counts an arrival. The error is a sentence: more than the largest number arrived within a second.
    pub fn count(&mut self, now: Instant, of: &str) -> Result<(), String> {
        let since = *self.since.get_or_insert(now);
        if now.saturating_duration_since(since) >= WINDOW {
            (self.since, self.count) = (Some(now), 0);
        }
        self.count = self.count.saturating_add(1);
        if self.count > self.most {
            return Err(format!(
                "the client sent more than {} {of} within a second",
                self.most
            ));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_times_the_rate_is_the_limit_and_a_burst_after_an_outage_is_none() {
        let begin = Instant::now();
        let mut rate = Rate::of_datagrams(1000);
        for second in 0..3 {
            let now = begin + Duration::from_secs(second);
            for _ in 0..4000 {
                assert_eq!(rate.count(now, "datagrams"), Ok(()));
            }
        }
        let now = begin + Duration::from_millis(2500);
        let error = rate.count(now, "datagrams").expect_err("too many");
        assert!(error.contains("4000 datagrams"), "{error}");
    }
}
