//! Fig. 17: the torque of a probe in a pocket against the turn that makes it.

/// Farthest that turn and torque are set against each other, ticks.
const LAGS: usize = 100;

/// Turn (radians) and torque (N mm) about the same axis.
#[derive(Default)]
pub(super) struct Turning {
    pub(super) points: Vec<(f64, f64)>,
}

impl Turning {
    /// Ticks by which the torque follows the turn, where the two are most alike; and their correlation there.
    pub(super) fn lag(&self) -> (usize, f64) {
        let mean = |all: &mut dyn Iterator<Item = f64>| {
            let all: Vec<f64> = all.collect();
            all.iter().sum::<f64>() / all.len().max(1) as f64
        };
        let alike = |lag: usize| {
            let pairs = || self.points.iter().zip(self.points.iter().skip(lag));
            let (x, y) = (
                mean(&mut pairs().map(|(a, _)| a.0)),
                mean(&mut pairs().map(|(_, b)| b.1)),
            );
            let (mut xy, mut xx, mut yy) = (0.0, 0.0, 0.0);
            for (a, b) in pairs() {
                // The torque on the hand is against the turn.
                let (a, b) = (a.0 - x, -(b.1 - y));
                xy += a * b;
                xx += a * a;
                yy += b * b;
            }
            xy / (xx * yy).sqrt().max(1e-30)
        };
        let all = (0..LAGS).map(|lag| (lag, alike(lag)));
        all.fold((0, f64::NEG_INFINITY), |best, now| {
            if now.1 > best.1 { now } else { best }
        })
    }

    /// Share of the ticks with a turn of more than `clear_turn` and a torque of more than a tenth of the largest, each less its mean, in which they are against
    /// each other. (A wall that bears all the time gives a torque of its own.)
    pub(super) fn against(&self, clear_turn: f64) -> f64 {
        let n = self.points.len().max(1) as f64;
        let sums = self
            .points
            .iter()
            .fold((0.0, 0.0), |sum, p| (sum.0 + p.0, sum.1 + p.1));
        let points: Vec<(f64, f64)> = self
            .points
            .iter()
            .map(|p| (p.0 - sums.0 / n, p.1 - sums.1 / n))
            .collect();
        let most = points.iter().map(|p| p.1.abs()).fold(0.0, f64::max);
        let clear = |p: &&(f64, f64)| p.1.abs() > 0.1 * most && p.0.abs() > clear_turn;
        let all = points.iter().filter(clear).count().max(1);
        let against = points
            .iter()
            .filter(clear)
            .filter(|p| p.0 * p.1 < 0.0)
            .count();
        against as f64 / all as f64
    }

    /// Largest torque, N mm.
    pub(super) fn peak(&self) -> f64 {
        self.points
            .iter()
            .map(|(_, torque)| torque.abs())
            .fold(0.0, f64::max)
    }

    /// Largest turn, radians.
    pub(super) fn most_turn(&self) -> f64 {
        self.points
            .iter()
            .map(|(turn, _)| turn.abs())
            .fold(0.0, f64::max)
    }
}
