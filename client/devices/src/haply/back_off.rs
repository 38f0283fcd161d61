//! Waiting times between attempts to connect.

/// Waiting time before the first attempt, nanoseconds.
const FIRST_NS: u64 = 50_000_000;
/// Longest waiting time, nanoseconds.
const LONGEST_NS: u64 = 2_000_000_000;

/// Waiting times that double with each failure.
#[derive(Clone, Debug)]
pub(super) struct BackOff {
    next_ns: u64,
}

impl BackOff {
    /// Waiting times from the beginning.
    pub(super) fn new() -> Self {
        Self { next_ns: FIRST_NS }
    }

    /// Returns the next waiting time, nanoseconds.
    pub(super) fn next(&mut self) -> u64 {
        let now = self.next_ns;
        self.next_ns = (now * 2).min(LONGEST_NS);
        now
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_doubles_from_fifty_milliseconds_to_two_seconds() {
        let mut back_off = BackOff::new();
        let ms: Vec<u64> = (0..8).map(|_| back_off.next() / 1_000_000).collect();
        assert_eq!(ms, [50, 100, 200, 400, 800, 1600, 2000, 2000]);
    }
}
