//! Wrong attempts to sign in, by address.

use std::collections::BTreeMap;
use std::net::IpAddr;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Wrong attempts of an address within [`WINDOW`] after which it must wait.
pub const MOST: u32 = 10;
/// Time after which the attempts of an address are forgotten.
pub const WINDOW: Duration = Duration::from_secs(60);
/// Largest number of addresses that are remembered.
const ADDRESSES: usize = 4096;

/// Counts of wrong attempts.
#[derive(Default)]
pub struct Attempts(Mutex<BTreeMap<IpAddr, (Instant, u32)>>);

impl Attempts {
    /// Whether an address must wait.
    pub fn must_wait(&self, address: IpAddr, now: Instant) -> bool {
        let map = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let found = map.get(&address);
        found.is_some_and(|(since, wrong)| {
            *wrong >= MOST && now.saturating_duration_since(*since) < WINDOW
        })
    }

    /// Counts a wrong attempt.
    pub fn wrong(&self, address: IpAddr, now: Instant) {
        let mut map = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        map.retain(|_, (since, _)| now.saturating_duration_since(*since) < WINDOW);
        if map.len() < ADDRESSES || map.contains_key(&address) {
            map.entry(address).or_insert((now, 0)).1 += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ten_wrong_attempts_close_an_address_for_a_minute_and_no_other() {
        let (attempts, begin) = (Attempts::default(), Instant::now());
        let [a, b] = [1, 2].map(|k| IpAddr::from([192, 0, 2, k]));
        for k in 0..MOST {
            assert!(!attempts.must_wait(a, begin), "{k}");
            attempts.wrong(a, begin);
        }
        assert!(attempts.must_wait(a, begin) && !attempts.must_wait(b, begin));
        assert!(!attempts.must_wait(a, begin + WINDOW));
    }
}
