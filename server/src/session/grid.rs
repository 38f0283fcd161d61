//! Grid of the ticks' deadlines on the monotonic clock, nanoseconds. The grid itself reads no clock.

/// Number of crowded ticks in a row after which a point is left out: see [`Grid::ended`].
const CROWDED_IN_ROW: u32 = 2;

/// Deadlines of a session's ticks. A missed point is skipped and counted; no tick runs to catch up.
pub(super) struct Grid {
    begin_ns: u64,
    next_ns: u64,
    /// Time between two points.
    tick_ns: u64,
    /// Time since 1970 at `begin_ns`.
    unix_at_begin: u64,
    /// Whether crowded ticks leave points out.
    leaves_out: bool,
    /// Number of crowded ticks in a row.
    crowded: u32,
    /// End of the tick before.
    ended_ns: u64,
    /// Points left out, which the next tick counts as skipped.
    left_out: u16,
}

impl Grid {
    /// Grid with a period, before its begin.
    pub fn new(tick_ns: u64) -> Self {
        Self {
            begin_ns: 0,
            next_ns: 0,
            tick_ns,
            unix_at_begin: 0,
            leaves_out: false,
            crowded: 0,
            ended_ns: 0,
            left_out: 0,
        }
    }

    /// Begins the grid at or within a period after now, so that all points lie `phase_ns` after a multiple of the
    /// period: the first point is one period later. `unix_ns` is the time since 1970. Crowded ticks leave points out if
    /// `real_time`, because only real-time threads keep others from running.
    pub fn begin(&mut self, now_ns: u64, unix_ns: u64, real_time: bool, phase_ns: u64) {
        let early_ns = (self.tick_ns - now_ns % self.tick_ns + phase_ns) % self.tick_ns;
        *self = Self {
            begin_ns: now_ns + early_ns,
            next_ns: now_ns + early_ns + self.tick_ns,
            unix_at_begin: unix_ns + early_ns,
            leaves_out: real_time,
            ..Self::new(self.tick_ns)
        };
    }

    /// Time since 1970 of a monotonic time, nanoseconds. A change of the system's clock in a session has no effect.
    pub fn unix_ns(&self, now_ns: u64) -> u64 {
        self.unix_at_begin + (now_ns - self.begin_ns)
    }

    /// Point of the next tick.
    pub fn next_ns(&self) -> u64 {
        self.next_ns
    }

    /// Point of the tick that begins at `now_ns`, and the number of points skipped before it, at most 65535. The next
    /// tick counts the remaining points.
    pub fn advance(&mut self, now_ns: u64) -> (u64, u16) {
        let missed = self.points_missed(now_ns).min(u16::MAX - self.left_out);
        let point_ns = self.next_ns + u64::from(missed) * self.tick_ns;
        self.next_ns = point_ns + self.tick_ns;
        let left_out = std::mem::take(&mut self.left_out);
        (point_ns, missed + left_out)
    }

    /// Takes begin and end of the tick. Returns whether the tick was late: it ended after the next point.
    ///
    /// A tick is crowded if it was late, or if other threads kept it from its begin for more than half a period: after
    /// its point and after the end of the tick before. After [`CROWDED_IN_ROW`] crowded ticks one point is left out. A
    /// core with too many stations would otherwise never idle: the recorders would starve, and the kernel's throttle
    /// would stop all real-time threads for 50 ms.
    pub fn ended(&mut self, begin_ns: u64, end_ns: u64) -> bool {
        let late = end_ns > self.next_ns;
        let point_ns = self.next_ns - self.tick_ns;
        let crowded = late || begin_ns > point_ns.max(self.ended_ns) + self.tick_ns / 2;
        self.ended_ns = end_ns;
        self.crowded = if crowded { self.crowded + 1 } else { 0 };
        if self.leaves_out && self.crowded >= CROWDED_IN_ROW {
            self.crowded = 0;
            // Points up to the end of the tick are missed in any case.
            self.left_out = self.points_missed(end_ns).saturating_add(1);
            self.next_ns += u64::from(self.left_out) * self.tick_ns;
        }
        late
    }

    /// Leaves out the next point. The next tick counts the point as skipped.
    pub fn leave_out(&mut self) {
        if let Some(left_out) = self.left_out.checked_add(1) {
            self.left_out = left_out;
            self.next_ns += self.tick_ns;
        }
    }

    /// Number of points after the next one up to `now_ns`, at most 65535.
    fn points_missed(&self, now_ns: u64) -> u16 {
        u16::try_from(now_ns.saturating_sub(self.next_ns) / self.tick_ns).unwrap_or(u16::MAX)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TICK_NS: u64 = 250_000;

    fn grid() -> Grid {
        let mut grid = Grid::new(TICK_NS);
        grid.begin(0, 0, true, 0);
        grid
    }

    #[test]
    fn a_missed_grid_point_is_skipped_not_caught_up() {
        for (now, point, skipped) in [
            (TICK_NS, 1, 0),
            (2 * TICK_NS - 1, 1, 0),
            (2 * TICK_NS, 2, 1),
            (8 * TICK_NS + 3, 8, 7),
            (1_000_000 * TICK_NS, 65_536, u16::MAX),
        ] {
            let mut grid = grid();
            assert_eq!(grid.advance(now), (point * TICK_NS, skipped), "{now}");
            assert_eq!(grid.next_ns(), (point + 1) * TICK_NS);
        }
    }

    #[test]
    fn points_have_the_phase_and_the_time_of_the_day_whenever_the_grid_begins() {
        for now in [0, 1, TICK_NS - 1, 7 * TICK_NS + 90_000] {
            for phase in [0, 1, 90_000, TICK_NS - 1] {
                let mut grid = Grid::new(TICK_NS);
                grid.begin(now, 1_000_000_000 + now, true, phase);
                let first = grid.next_ns();
                assert_eq!(first % TICK_NS, phase, "from {now}");
                assert!(
                    (now + TICK_NS..now + 2 * TICK_NS).contains(&first),
                    "{first}"
                );
                assert_eq!(grid.unix_ns(first), 1_000_000_000 + first);
            }
        }
    }

    #[test]
    fn a_late_tick_alone_leaves_nothing_out() {
        // Costs in tenths of a period; the tick after a late one begins at the end of that one.
        for (cost, skipped) in [(11, 0), (17, 0), (25, 1)] {
            let (mut grid, mut now, mut points) = (grid(), 0, Vec::new());
            for cost in [3, cost, 3, 3, 3] {
                now = grid.next_ns().max(now);
                let begin = now;
                points.push(grid.advance(now).1);
                now += TICK_NS * cost / 10;
                assert_eq!(grid.ended(begin, now), cost > 10, "{cost}");
            }
            assert_eq!(points, [0, 0, skipped, 0, 0], "{cost} tenths");
        }
    }

    #[test]
    fn a_point_that_is_left_out_is_counted_by_the_next_tick() {
        let mut grid = grid();
        assert_eq!(grid.advance(TICK_NS), (TICK_NS, 0));
        grid.leave_out();
        assert_eq!(grid.next_ns(), 3 * TICK_NS);
        assert_eq!(grid.advance(3 * TICK_NS), (3 * TICK_NS, 1));
    }

    #[test]
    fn a_long_stop_loses_no_point() {
        let mut grid = grid();
        let mut now = 0;
        for _ in 0..2 {
            grid.advance(grid.next_ns());
            now = grid.next_ns() + 40_000 * TICK_NS;
            grid.ended(now - TICK_NS, now);
        }
        now += 40_000 * TICK_NS;
        let mut points = 0;
        for _ in 0..4 {
            let (point, skipped) = grid.advance(now);
            points += 1 + u64::from(skipped);
            now = now.max(point + TICK_NS);
        }
        // The two ticks before the stop and the points that the first stop made the second tick skip are not counted.
        assert!(points >= 80_000, "{points}");
        assert!(grid.next_ns() > now - TICK_NS, "the grid has caught up");
    }

    /// On a core with more work than time every station must leave out points, so that other threads run.
    #[test]
    fn crowded_ticks_leave_points_out_and_the_next_tick_counts_them() {
        for cost in [TICK_NS * 11 / 10, TICK_NS * 7 / 10] {
            let (mut grid, mut now, mut ticks, mut points) = (grid(), 0, 0, 0);
            while ticks < 1000 {
                // Another thread keeps the core for six tenths of a period after each point.
                now = now.max(grid.next_ns()) + TICK_NS * 6 / 10;
                let (point, skipped) = grid.advance(now);
                points += 1 + u64::from(skipped);
                assert_eq!(point, points * TICK_NS, "every point is a tick or counted");
                grid.ended(now, now + cost);
                now += cost;
                ticks += 1;
            }
            assert!(points - ticks > ticks * 2 / 5, "{points} points");
        }
    }
}
