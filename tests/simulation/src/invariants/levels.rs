//! Levels of both sides, pause and force limit: invariant 10.
//!
//! `SECURITY.md`: every tick reads the levels. The first tick behind an accepted order obeys it: no tick of delay.

use sulcus_proto::control::Command;

use crate::seen::{Side, Tick};

use super::Found;
use super::bounds::Bounds;

/// Pause and force limit of one side.
#[derive(Clone, Copy, Default)]
struct Level {
    paused: bool,
    limit_n: f64,
}

/// Levels that the accepted orders give.
///
/// The station's levels may be older than the session: orders before the first epoch count. Neither a lost connection
/// nor an order of the other side changes a level.
#[derive(Default)]
pub(super) struct Levels {
    station: Level,
    student: Level,
}

impl Levels {
    /// Takes an accepted order. Returns whether the order ends a pause of its side.
    pub(super) fn order(&mut self, side: Side, command: Command) -> bool {
        let level = match side {
            Side::Station => &mut self.station,
            Side::Student => &mut self.student,
        };
        let was_paused = level.paused;
        match command {
            Command::Pause => level.paused = true,
            Command::Resume => level.paused = false,
            // `Command`: a negative, infinite or NaN value is ignored.
            Command::ForceLimit(limit_n) if limit_n.is_finite() && limit_n >= 0.0 => {
                level.limit_n = f64::from(limit_n);
            }
            Command::ForceLimit(_) => {}
        }
        was_paused && !level.paused
    }

    /// Compares a tick with the levels.
    pub(super) fn tick(&self, bounds: &Bounds, tick: &Tick, found: &mut Found) {
        let paused = self.station.paused || self.student.paused;
        found.must(tick.paused == paused, 10, || {
            format!(
                "tick {}: paused {}; orders: station {}, student {}",
                tick.tick, tick.paused, self.station.paused, self.student.paused
            )
        });
        let limits = [
            self.station.limit_n,
            self.student.limit_n,
            bounds.facts.plan_limit_n,
        ];
        // A limit above the scene's has no effect, so the effective limits are compared.
        let expected = limits
            .into_iter()
            .map(|limit| bounds.limit_n(limit))
            .fold(f64::INFINITY, f64::min);
        let effective = bounds.limit_n(tick.force_limit_n);
        // The levels are exact values of f32; a plan's limit may be rounded to f32.
        found.must((effective - expected).abs() <= super::bounds::ROUNDING, 10, || {
            format!(
                "tick {}: limit {effective} N; expected {expected} N of station, student, plan {limits:?}",
                tick.tick
            )
        });
    }
}
