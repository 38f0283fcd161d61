//! Rates of the channels for viewers.

/// Rate of poses, clouds, contacts and metrics, hertz. Of all whole numbers of ticks at 1 kHz the nearest to a screen's
/// 60 Hz.
pub const FRAMES_HZ: f64 = 62.5;
/// Rate of wrenches, hertz.
pub const WRENCHES_HZ: f64 = 125.0;

/// Grid of due ticks: the first tick at or behind each multiple of a number of ticks, also after skipped ticks.
#[derive(Clone, Copy, Debug)]
pub struct Cadence {
    every: u64,
    next: u64,
}

impl Cadence {
    /// Grid of `hz` per second, with ticks of `tick_s` seconds. With longer ticks every tick is due.
    pub fn new(hz: f64, tick_s: f64) -> Self {
        let every = (1.0 / (hz * tick_s)).round();
        Self {
            every: if every >= 1.0 { every as u64 } else { 1 },
            next: 0,
        }
    }

    /// Whether this tick is due. Ticks come in order.
    pub fn is_due(&mut self, tick: u64) -> bool {
        if tick < self.next {
            return false;
        }
        self.next = (tick / self.every + 1) * self.every;
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_due_on_a_grid_whatever_is_skipped() {
        let mut cadence = Cadence::new(FRAMES_HZ, 1e-3);
        let due: Vec<u64> = (1..=100).filter(|tick| cadence.is_due(*tick)).collect();
        assert_eq!(due, [1, 16, 32, 48, 64, 80, 96]);
        // A hole over three due ticks: the first tick behind the hole is due, then the grid again.
        let due: Vec<u64> = (150..=180).filter(|tick| cadence.is_due(*tick)).collect();
        assert_eq!(due, [150, 160, 176]);
    }

    #[test]
    fn the_rate_is_one_of_time_not_of_ticks() {
        for tick_s in [0.25e-3, 0.5e-3, 1e-3, 2e-3] {
            let mut cadence = Cadence::new(WRENCHES_HZ, tick_s);
            let second = (1.0 / tick_s) as u64;
            let due = (0..second).filter(|tick| cadence.is_due(*tick)).count();
            assert_eq!(due, 125, "ticks of {tick_s} s");
        }
        let mut slow = Cadence::new(WRENCHES_HZ, 0.1);
        assert!((0..10).all(|tick| slow.is_due(tick)));
    }
}
