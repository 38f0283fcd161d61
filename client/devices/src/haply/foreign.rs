//! Comparison of the force that the service displays with the forces sent.
//!
//! Forces of several programs add up in the service, and a factor of the service multiplies them. A force beyond the
//! ones sent is foreign. A smaller force in the same direction is none: the service may limit a force.

use std::fmt;

use sulcus_core::Vec3;
use sulcus_core::math::{fclamp, fmin, norm};

/// Largest difference that is no foreign force, newtons.
const FOREIGN_N: f64 = 0.05;
/// Time for which a force must be foreign, nanoseconds.
const FOREIGN_NS: u64 = 20_000_000;
/// Force sent from which the service must display some, newtons.
const ASKED_N: f64 = 0.1;
/// Displayed force that counts as none, newtons.
const NONE_N: f64 = 0.02;
/// Time for which the service must display none, nanoseconds.
const NONE_NS: u64 = 100_000_000;
/// Age of the forces sent that a reported force may belong to, nanoseconds.
const WINDOW_NS: u64 = 20_000_000;
/// Number of forces kept: 20 ms at 4 kHz, and some more.
const KEPT: usize = 96;

/// Difference between the forces sent and the force displayed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Difference {
    /// Another force acts, newtons.
    Foreign(f64),
    /// The service displays no force.
    Nothing,
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Foreign(newtons) => write!(
                f,
                "a force of {newtons:.2} N of another program or setting acts at the arm, expected none above \
                 {FOREIGN_N} N: close other programs that use the device, and press a button"
            ),
            Self::Nothing => f.write_str(
                "the service displays none of the force, expected the force sent: look at the brake and the power \
                 supply of the arm, and press a button",
            ),
        }
    }
}

/// Comparison for one arm.
#[derive(Clone, Debug)]
pub(super) struct Comparison {
    sent: [(u64, Vec3); KEPT],
    next: usize,
    foreign_since: Option<u64>,
    none_since: Option<u64>,
}

impl Comparison {
    /// Comparison before the first force.
    pub(super) fn new() -> Self {
        Self {
            sent: [(0, Vec3::zeros()); KEPT],
            next: 0,
            foreign_since: None,
            none_since: None,
        }
    }

    /// Accounts for a force sent.
    pub(super) fn sent(&mut self, force: &Vec3, now_ns: u64) {
        self.sent[self.next] = (now_ns, *force);
        self.next = (self.next + 1) % KEPT;
    }

    /// Compares a reported force with the forces sent.
    pub(super) fn reported(&mut self, force: &Vec3, now_ns: u64) -> Option<Difference> {
        // The service reports zero before the first message.
        let mut distance = norm(force);
        let mut least = f64::INFINITY;
        for (at_ns, sent) in &self.sent {
            if *at_ns > 0 && now_ns.saturating_sub(*at_ns) <= WINDOW_NS {
                distance = fmin(distance, beyond(force, sent));
                least = fmin(least, norm(sent));
            }
        }
        let foreign = distance > FOREIGN_N;
        let none = least.is_finite() && least > ASKED_N && norm(force) < NONE_N;
        let lasts = |since: &mut Option<u64>, is: bool, most: u64| {
            *since = is.then(|| since.unwrap_or(now_ns));
            since.is_some_and(|since| now_ns.saturating_sub(since) >= most)
        };
        let none = lasts(&mut self.none_since, none, NONE_NS);
        if lasts(&mut self.foreign_since, foreign, FOREIGN_NS) {
            Some(Difference::Foreign(distance))
        } else {
            none.then_some(Difference::Nothing)
        }
    }
}

/// Distance of `force` from the forces between zero and `sent`.
fn beyond(force: &Vec3, sent: &Vec3) -> f64 {
    let square = sent.norm_squared();
    let share = if square > 0.0 {
        fclamp(force.dot(sent) / square, 0.0, 1.0)
    } else {
        0.0
    };
    norm(&(force - sent * share))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TICK: u64 = 250_000;

    /// Differences over `ticks` periods, with a force `sent` and the report of `shown` for it two periods later.
    fn differences(
        ticks: u64,
        sent: impl Fn(u64) -> Vec3,
        shown: impl Fn(Vec3) -> Vec3,
    ) -> Vec<(u64, Difference)> {
        let mut comparison = Comparison::new();
        let mut found = Vec::new();
        for tick in 1..ticks {
            let reported = shown(sent(tick.saturating_sub(3)));
            found.extend(
                comparison
                    .reported(&reported, tick * TICK)
                    .map(|difference| (tick, difference)),
            );
            comparison.sent(&sent(tick), tick * TICK);
        }
        found
    }

    fn swing(tick: u64) -> Vec3 {
        Vec3::new((tick as f64 * 0.01).sin() * 2.0, 0.0, 0.3)
    }

    #[test]
    fn own_forces_and_shortened_ones_are_not_foreign() {
        assert_eq!(differences(4000, swing, |force| force), []);
        assert_eq!(differences(4000, swing, |force| force * 0.5), []);
        assert_eq!(
            differences(4000, |_| Vec3::zeros(), |_| Vec3::new(0.04, 0.0, 0.0)),
            []
        );
    }

    #[test]
    fn a_second_source_and_a_factor_are_foreign_after_twenty_milliseconds() {
        let second = differences(
            400,
            |_| Vec3::zeros(),
            |force| force + Vec3::new(0.0, 0.2, 0.0),
        );
        assert_eq!(second[0].0, 81);
        assert!(matches!(second[0].1, Difference::Foreign(n) if (n - 0.2).abs() < 1e-9));
        let steady = |_| Vec3::new(0.3, 0.0, 0.0);
        assert!(!differences(400, steady, |force| force * 2.0).is_empty());
    }

    #[test]
    fn a_service_without_force_is_seen_after_a_tenth_of_a_second() {
        let none = differences(1000, |_| Vec3::new(0.3, 0.0, 0.0), |_| Vec3::zeros());
        assert_eq!(none[0].1, Difference::Nothing);
        assert!((400..500).contains(&none[0].0), "{none:?}");
    }
}
