//! Histogram of times, for the ends of a connection.

use hdrhistogram::Histogram;
use sulcus_proto::Percentiles;

/// Histogram of times from 1 ns to a longest time, with three significant digits.
///
/// All memory is allocated by [`Times::up_to`]. A longer time counts as the longest one.
pub struct Times(Histogram<u64>);

impl Times {
    /// Creates an empty histogram of times up to `longest_s` seconds, at least 1 s.
    pub fn up_to(longest_s: u32) -> Self {
        let longest_ns = u64::from(longest_s.max(1)) * 1_000_000_000;
        let histogram = Histogram::new_with_bounds(1, longest_ns, 3);
        Self(histogram.expect("a longest time of seconds and three digits are valid"))
    }

    /// Records a time, nanoseconds. Allocates nothing.
    pub fn record(&mut self, ns: u64) {
        self.0.saturating_record(ns);
    }

    /// Forgets all times. Allocates nothing.
    pub fn clear(&mut self) {
        self.0.reset();
    }

    /// Number of recorded times.
    pub fn count(&self) -> u64 {
        self.0.len()
    }

    /// Percentiles, microseconds; all zero without times.
    pub fn percentiles(&self) -> Percentiles {
        let us = |ns: u64| ns as f64 / 1e3;
        Percentiles {
            p50: us(self.0.value_at_quantile(0.5)),
            p99: us(self.0.value_at_quantile(0.99)),
            p999: us(self.0.value_at_quantile(0.999)),
            max: us(self.0.max()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_microseconds() {
        let mut times = Times::up_to(1);
        assert_eq!(times.percentiles(), Percentiles::default());
        for us in 1..=1000 {
            times.record(us * 1000);
        }
        times.record(u64::MAX);
        let p = times.percentiles();
        assert_eq!(times.count(), 1001);
        assert!((p.p50 - 501.0).abs() < 2.0, "{p:?}");
        assert!((p.p99 - 991.0).abs() < 2.0, "{p:?}");
        assert!((p.max - 1e6).abs() < 1e3, "{p:?}");
    }
}
