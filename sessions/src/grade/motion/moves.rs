//! Free moves of a tool, with their smoothness, and the length of the path.
//!
//! A *move* is one discrete movement through the air. It begins at a speed of [`START`], and ends after [`RESTS`] below
//! [`STOP`] or at a contact. Smoothness is defined for such a movement only, not for a session nor for contact
//! (Balasubramanian 2015): a rest in between changes the result by multiples. The place of the tip is low-passed at
//! [`CUT_OFF_HZ`] before its speed is computed.

use sulcus_core::Vec3;
use sulcus_core::math::norm;

use super::lowpass::LowPass;
use super::sparc::sparc;

/// Cut-off of a hand's motion, Hz. Tremor, 8 to 12 Hz, is below it.
pub const CUT_OFF_HZ: f64 = 20.0;
/// Speed at which a move begins, m/s. Chosen.
pub const START: f64 = 10e-3;
/// Speed below which a move ends, m/s. Chosen.
pub const STOP: f64 = 4e-3;
/// Time below [`STOP`] after which a move ends, seconds. Chosen.
pub const RESTS: f64 = 0.1;
/// Longest gap of skipped ticks over which the tip is interpolated, seconds.
const GAP: f64 = 0.1;
/// Largest motion of a tip in a gap of the connection after which a move goes on, metres. Chosen: a hand that holds
/// still trembles less.
pub const MOVED: f64 = 1e-3;
/// Shortest way of a move, metres.
pub const LEAST_WAY: f64 = 5e-3;
/// Shortest time of a move, seconds.
pub const LEAST_TIME: f64 = 0.2;
/// Rate of the kept speeds, Hz.
const RATE_HZ: f64 = 100.0;
/// Largest number of kept speeds of a move: five minutes.
const MOST: usize = 30_000;

/// Moves of one tool's tip.
#[derive(Clone, Debug)]
pub struct Moves {
    filter: LowPass,
    dt: f64,
    /// Number of ticks for each kept speed.
    every: u32,
    /// Number of ticks since the last kept speed.
    since: u32,
    /// Last place of the tip.
    tip: Option<Vec3>,
    /// Last place of the tip after the filter.
    last: Option<Vec3>,
    /// Filtered place at the last kept speed.
    kept: Option<Vec3>,
    speeds: Vec<f64>,
    way: f64,
    slow: f64,
    moving: bool,
    /// SPARC of every move.
    found: Vec<f64>,
    /// Path of the tip through the air, metres.
    free_way: f64,
    /// Path of the tip in all, metres.
    whole_way: f64,
}

impl Moves {
    /// Moves before the first tick. `dt` is the length of a tick, seconds.
    pub fn new(dt: f64) -> Self {
        let every = (1.0 / (RATE_HZ * dt)).round().max(1.0) as u32;
        Self {
            filter: LowPass::new(1.0 / dt, CUT_OFF_HZ),
            dt,
            every,
            since: 0,
            tip: None,
            last: None,
            kept: None,
            speeds: Vec::new(),
            way: 0.0,
            slow: 0.0,
            moving: false,
            found: Vec::new(),
            free_way: 0.0,
            whole_way: 0.0,
        }
    }

    /// Takes in the place of the tip after a tick, metres, and whether the tool is free. None: no hand holds the tool.
    /// After skipped ticks, `ticks` is more than 1, and the tip moved straight. A gap longer than [`GAP`] ends the
    /// move.
    pub fn observe(&mut self, tip: Option<(Vec3, bool)>, ticks: u64) {
        if let (Some((to, free)), Some(from), true) = (tip, self.tip, ticks > 1) {
            if ticks as f64 * self.dt > GAP {
                self.step(None);
            } else {
                for k in 1..ticks {
                    let share = k as f64 / ticks as f64;
                    self.step(Some((from + (to - from) * share, free)));
                }
            }
        }
        self.tip = tip.map(|(at, _)| at);
        self.step(tip);
    }

    /// Takes the end of a gap of the connection, with the present place of the tip. A tip that is where it was goes on.
    /// Of a tip that has moved, neither the way in the gap nor the move that the gap has cut counts.
    pub fn returns(&mut self, tip: Vec3) {
        if self
            .tip
            .is_some_and(|before| norm(&(tip - before)) <= MOVED)
        {
            return;
        }
        self.drop_move();
        self.filter.reset();
        (self.tip, self.last, self.kept) = (None, None, None);
    }

    fn step(&mut self, tip: Option<(Vec3, bool)>) {
        let Some((tip, free)) = tip else {
            self.end();
            self.filter.reset();
            (self.last, self.kept) = (None, None);
            return;
        };
        let at = self.filter.step(tip);
        let step = self.last.map_or(0.0, |last| norm(&(at - last)));
        self.last = Some(at);
        self.whole_way += step;
        if !free {
            self.end();
            self.kept = None;
            return;
        }
        self.free_way += step;
        let Some(kept) = self.kept else {
            (self.kept, self.since) = (Some(at), 0);
            return;
        };
        self.since += 1;
        if self.since < self.every {
            return;
        }
        let period = f64::from(self.every) * self.dt;
        let speed = norm(&(at - kept)) / period;
        (self.kept, self.since) = (Some(at), 0);
        self.sample(speed, period);
    }

    fn sample(&mut self, speed: f64, period: f64) {
        if !self.moving && speed < START {
            return;
        }
        self.moving = true;
        self.slow = if speed < STOP {
            self.slow + period
        } else {
            0.0
        };
        self.way += speed * period;
        if self.speeds.len() < MOST {
            self.speeds.push(speed);
        }
        if self.slow >= RESTS {
            self.end();
        }
    }

    /// Ends the present move.
    fn end(&mut self) {
        let period = f64::from(self.every) * self.dt;
        let slow = (self.slow / period).round() as usize;
        let moved = self.speeds.len().saturating_sub(slow);
        if self.way >= LEAST_WAY && moved as f64 * period >= LEAST_TIME {
            // The rest at the end is no part of the move.
            self.found
                .extend(sparc(&self.speeds[..moved], 1.0 / period, CUT_OFF_HZ));
        }
        self.drop_move();
    }

    /// Forgets the present move.
    fn drop_move(&mut self) {
        self.speeds.clear();
        (self.way, self.slow, self.moving) = (0.0, 0.0, false);
    }

    /// Median SPARC and number of the moves. None without a move.
    pub fn smoothness(&mut self) -> Option<(f64, usize)> {
        self.end();
        let mut all = self.found.clone();
        all.sort_by(f64::total_cmp);
        Some((crate::grade::stats::median(&all)?, all.len()))
    }

    /// Path of the tip, metres: through the air, and in all.
    pub fn ways(&self) -> (f64, f64) {
        (self.free_way, self.whole_way)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A move of 40 mm along x in `seconds` with a bell-shaped speed, then a rest.
    fn reach(moves: &mut Moves, from: f64, seconds: f64, shake: f64) -> f64 {
        let ticks = (seconds * 1e3) as u32;
        let mut x = from;
        for k in 0..ticks + 400 {
            let s = (f64::from(k) / f64::from(ticks)).min(1.0);
            // Minimum jerk.
            x = from + 0.04 * s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
            let t = f64::from(k) * 1e-3;
            // The rest at the end has no tremor.
            let shake = if s < 1.0 { shake } else { 0.0 };
            let tremor = shake * libm::sin(2.0 * std::f64::consts::PI * 10.0 * t);
            moves.observe(Some((Vec3::new(x + tremor, 0.0, 0.0), true)), 1);
        }
        x
    }

    #[test]
    fn three_reaches_with_rests_are_three_moves_each_as_smooth_as_one() {
        let mut one = Moves::new(1e-3);
        reach(&mut one, 0.0, 1.0, 0.0);
        let (alone, count) = one.smoothness().expect("a move");
        assert_eq!(count, 1);
        assert!((-2.0..-1.3).contains(&alone), "{alone}");
        let mut three = Moves::new(1e-3);
        let mut x = 0.0;
        for _ in 0..3 {
            x = reach(&mut three, x, 1.0, 0.0);
        }
        let (median, count) = three.smoothness().expect("moves");
        assert_eq!(count, 3);
        assert!((median - alone).abs() < 0.02, "{median} {alone}");
        // 120 mm, less the hundredth of a millimetre that the filter lags.
        assert!((three.ways().0 - 0.12).abs() < 1e-4, "{:?}", three.ways());
    }

    #[test]
    fn smoothness_is_the_median_of_unequal_moves() {
        let alone = |seconds: f64, shake: f64| {
            let mut moves = Moves::new(1e-3);
            reach(&mut moves, 0.0, seconds, shake);
            moves.smoothness().expect("a move").0
        };
        let all = [(1.0, 0.0), (1.0, 0.4e-3), (1.0, 0.2e-3)];
        let mut each = all.map(|(seconds, shake)| alone(seconds, shake));
        each.sort_by(f64::total_cmp);
        assert!(
            each[1] - each[0] > 0.05 && each[2] - each[1] > 0.05,
            "{each:?}"
        );
        let (mut moves, mut x) = (Moves::new(1e-3), 0.0);
        for (seconds, shake) in all {
            x = reach(&mut moves, x, seconds, shake);
        }
        let (median, count) = moves.smoothness().expect("moves");
        assert_eq!(count, 3);
        assert!((median - each[1]).abs() < 0.02, "{median} {each:?}");
    }

    /// Skipped ticks in the middle of a move. Earlier versions gave their whole way to one tick, as a jerk.
    #[test]
    fn ticks_that_were_skipped_are_no_jerk_of_the_hand() {
        let run = |skips: bool| {
            let mut moves = Moves::new(1e-3);
            let mut since = 0;
            for k in 0..1400u32 {
                since += 1;
                if skips && (490..510).contains(&k) {
                    continue;
                }
                let s = (f64::from(k) / 1e3).min(1.0);
                let x = 0.04 * s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
                moves.observe(Some((Vec3::new(x, 0.0, 0.0), true)), since);
                since = 0;
            }
            let (smooth, count) = moves.smoothness().expect("a move");
            (smooth, count, moves.ways().0)
        };
        let (whole, holed) = (run(false), run(true));
        assert_eq!(holed.1, 1);
        assert!((holed.0 - whole.0).abs() < 0.01, "{holed:?} {whole:?}");
        assert!((holed.2 - whole.2).abs() < 1e-5, "{holed:?} {whole:?}");
        // A gap longer than `GAP` separates two moves.
        let mut moves = Moves::new(1e-3);
        moves.observe(Some((Vec3::zeros(), true)), 1);
        moves.observe(Some((Vec3::new(1.0, 0.0, 0.0), true)), 500);
        assert!(moves.ways().0 < 1e-12, "{:?}", moves.ways());
    }

    #[test]
    fn a_gap_of_the_connection_is_no_way_and_cuts_a_move_only_if_the_hand_moved() {
        let run = |jump: f64| {
            let mut moves = Moves::new(1e-3);
            let mut shift = 0.0;
            for k in 0..1400u32 {
                if k == 500 {
                    shift = jump;
                    moves.returns(Vec3::new(0.02 + shift, 0.0, 0.0));
                }
                let s = (f64::from(k) / 1e3).min(1.0);
                let x = 0.04 * s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
                moves.observe(Some((Vec3::new(x + shift, 0.0, 0.0), true)), 1);
            }
            (moves.smoothness(), moves.ways().0)
        };
        let mut whole = Moves::new(1e-3);
        reach(&mut whole, 0.0, 1.0, 0.0);
        let (still, way) = run(0.0);
        assert_eq!(still, whole.smoothness());
        assert!((way - 0.04).abs() < 1e-4, "{way}");
        // The half of a move behind the gap counts as it was made.
        let (moved, way) = run(0.3);
        assert_eq!(moved.expect("a move").1, 1);
        assert!((way - 0.04).abs() < 1e-3, "{way}");
    }

    #[test]
    fn a_tremor_makes_a_reach_less_smooth() {
        let smooth = {
            let mut moves = Moves::new(1e-3);
            reach(&mut moves, 0.0, 1.0, 0.0);
            moves.smoothness().expect("a move").0
        };
        let mut moves = Moves::new(1e-3);
        reach(&mut moves, 0.0, 1.0, 0.3e-3);
        let shaken = moves.smoothness().expect("a move").0;
        assert!(shaken < smooth - 0.3, "{shaken} {smooth}");
    }

    #[test]
    fn contact_is_no_move_and_neither_is_a_jump_between_two_presences() {
        let mut moves = Moves::new(1e-3);
        for k in 0..2000 {
            moves.observe(Some((Vec3::new(f64::from(k) * 4e-5, 0.0, 0.0), false)), 1);
        }
        moves.observe(None, 1);
        moves.observe(Some((Vec3::new(5.0, 0.0, 0.0), true)), 1);
        moves.observe(Some((Vec3::new(5.0, 0.0, 0.0), true)), 1);
        assert_eq!(moves.smoothness(), None);
        let (free, whole) = moves.ways();
        assert!(free < 1e-12, "{free}");
        // 1,999 steps of 40 um, less the lag.
        assert!((whole - 0.07996).abs() < 1e-3, "{whole}");
    }
}
