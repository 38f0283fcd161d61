//! Orientation between two measurements of a slow grip.

use sulcus_core::Quat;
use sulcus_core::math::{exp_rotation, log_rotation};

/// Longest time over which the orientation turns to a new measurement, nanoseconds.
const LONGEST_NS: u64 = 40_000_000;

/// Orientation that turns from one measurement to the next, over the measured interval of both.
#[derive(Clone, Debug, Default)]
pub(super) struct Turning {
    turn: Option<Turn>,
}

#[derive(Clone, Copy, Debug)]
struct Turn {
    from: Quat,
    to: Quat,
    /// Time at which `to` was measured.
    at_ns: u64,
    over_ns: u64,
}

impl Turning {
    /// Takes a measurement. The measurement of a reply that equals the one before is not a new one.
    pub(super) fn take(&mut self, to: Quat, now_ns: u64) {
        self.turn = Some(match &self.turn {
            None => Turn {
                from: to,
                to,
                at_ns: now_ns,
                over_ns: 0,
            },
            Some(turn) if turn.to == to => *turn,
            Some(turn) => Turn {
                from: turn.at(now_ns),
                to,
                at_ns: now_ns,
                over_ns: now_ns.saturating_sub(turn.at_ns).min(LONGEST_NS),
            },
        });
    }

    /// Forgets all measurements: the next one holds at once.
    pub(super) fn forget(&mut self) {
        self.turn = None;
    }

    /// Orientation at `now_ns`; `None` before a measurement.
    pub(super) fn at(&self, now_ns: u64) -> Option<Quat> {
        self.turn.map(|turn| turn.at(now_ns))
    }
}

impl Turn {
    fn at(&self, now_ns: u64) -> Quat {
        let since_ns = now_ns.saturating_sub(self.at_ns);
        if since_ns >= self.over_ns {
            return self.to;
        }
        let share = since_ns as f64 / self.over_ns as f64;
        let way = log_rotation(&(self.to * self.from.inverse()));
        exp_rotation(&(way * share)) * self.from
    }
}

#[cfg(test)]
mod tests {
    use sulcus_core::Vec3;
    use sulcus_core::math::norm;

    use super::*;

    const MS: u64 = 1_000_000;

    fn about_x(angle: f64) -> Quat {
        exp_rotation(&Vec3::new(angle, 0.0, 0.0))
    }

    fn angle(turning: &Turning, ms: u64) -> f64 {
        log_rotation(&turning.at(ms * MS).unwrap()).x
    }

    #[test]
    fn a_steady_turn_at_fifty_hertz_is_steady_at_every_period() {
        let mut turning = Turning::default();
        assert!(turning.at(0).is_none());
        let mut before = 0.0;
        for ms in 0..400 {
            // 1 rad/s, measured each 20 ms; the same measurement arrives in every reply.
            turning.take(about_x((ms / 20) as f64 * 0.02), ms * MS);
            let now = angle(&turning, ms);
            if ms > 40 {
                assert!((now - before - 0.001).abs() < 1e-6, "{ms} {before} {now}");
                assert!((now - ms as f64 * 0.001 + 0.02).abs() < 1e-6, "{ms} {now}");
            }
            before = now;
        }
    }

    #[test]
    fn a_turn_after_a_rest_takes_forty_milliseconds() {
        let mut turning = Turning::default();
        turning.take(about_x(0.0), 0);
        turning.take(about_x(0.4), 1000 * MS);
        assert!((angle(&turning, 1020) - 0.2).abs() < 1e-9);
        assert!((angle(&turning, 1040) - 0.4).abs() < 1e-9);
        turning.forget();
        turning.take(about_x(-1.0), 1050 * MS);
        assert!((angle(&turning, 1050) + 1.0).abs() < 1e-9);
    }

    #[test]
    fn half_a_turn_and_the_other_sign_give_unit_quaternions() {
        let mut turning = Turning::default();
        let q = about_x(0.3);
        turning.take(q, 0);
        turning.take(Quat::new_unchecked(-q.into_inner()), 20 * MS);
        assert!(norm(&log_rotation(&(turning.at(30 * MS).unwrap() * q.inverse()))) < 1e-9);
        turning.take(about_x(0.3 + std::f64::consts::PI), 40 * MS);
        let half = turning.at(50 * MS).unwrap();
        assert!((half.as_ref().norm() - 1.0).abs() < 1e-9);
    }
}
