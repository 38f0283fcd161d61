//! Time of a session, with and without the gaps in which its student is gone.

use std::time::{Duration, Instant};

/// Clock of a session. The caller passes the time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SessionClock {
    began: Instant,
    /// Sum of the closed gaps.
    gaps: Duration,
    /// Number of gaps, with the open one.
    count: u32,
    /// Begin of the open gap.
    open: Option<Instant>,
    /// Whether the session's time runs in gaps.
    runs_in_gaps: bool,
}

impl SessionClock {
    /// Clock of a session that begins at `now`.
    pub fn begin(now: Instant, runs_in_gaps: bool) -> Self {
        Self {
            began: now,
            gaps: Duration::ZERO,
            count: 0,
            open: None,
            runs_in_gaps,
        }
    }

    /// Opens a gap. An open gap stays as it is.
    pub fn detach(&mut self, now: Instant) {
        if self.open.is_none() {
            self.open = Some(now);
            self.count += 1;
        }
    }

    /// Closes the open gap and returns its length; zero without one.
    pub fn attach(&mut self, now: Instant) -> Duration {
        let length = self.gap(now);
        self.gaps += length;
        self.open = None;
        length
    }

    /// Length of the open gap; zero without one.
    pub fn gap(&self, now: Instant) -> Duration {
        self.open
            .map_or(Duration::ZERO, |begin| now.saturating_duration_since(begin))
    }

    /// Whether the student is gone.
    pub fn is_open(&self) -> bool {
        self.open.is_some()
    }

    /// Number of gaps.
    pub fn count(&self) -> u32 {
        self.count
    }

    /// Time of the session: without gaps, unless it runs in gaps.
    pub fn elapsed(&self, now: Instant) -> Duration {
        let whole = now.saturating_duration_since(self.began);
        if self.runs_in_gaps {
            whole
        } else {
            whole.saturating_sub(self.gaps + self.gap(now))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gap_stops_the_clock_unless_the_plan_lets_it_run() {
        let begin = Instant::now();
        let at = |s| begin + Duration::from_secs(s);
        for (runs, elapsed) in [(false, 25), (true, 40)] {
            let mut clock = SessionClock::begin(begin, runs);
            clock.detach(at(10));
            clock.detach(at(12));
            assert!(clock.is_open());
            assert_eq!(clock.gap(at(20)), Duration::from_secs(10));
            assert_eq!(clock.attach(at(25)), Duration::from_secs(15));
            assert_eq!(clock.attach(at(30)), Duration::ZERO);
            assert_eq!((clock.count(), clock.is_open()), (1, false));
            assert_eq!(clock.elapsed(at(40)), Duration::from_secs(elapsed));
        }
    }
}
