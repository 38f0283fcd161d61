//! Watchdog of the wrench stream: closes the force gate when no wrench arrives for [`WRENCH_SILENT`].

use std::time::Duration;

use sulcus_proto::limits::WRENCH_SILENT;

/// Time in which the gate falls from one to zero.
const FALL: Duration = Duration::from_millis(20);
/// Time in which the gate rises from zero to one after a gap of at most [`LONG_GAP`].
const RISE: Duration = Duration::from_millis(100);
/// Time in which the gate rises from zero to one after the first wrench, and after a longer gap. The hand may be
/// elsewhere by then, and has time to feel the force before it is whole.
const RISE_ANEW: Duration = Duration::from_millis(500);
/// Longest gap between two wrenches after which the gate rises in [`RISE`].
const LONG_GAP: Duration = Duration::from_millis(50);
/// Largest time step of the gate. After a longer delay of the device thread the gate moves by this step only, so that
/// the displayed force does not jump.
const LONGEST_STEP: Duration = Duration::from_millis(2);

/// Gate of the force: share that may be displayed, from the arrival times of wrenches. Uses no clock of its own; the
/// caller passes the time.
#[derive(Clone, Debug, Default)]
pub struct Watchdog {
    /// Linear position between closed (0) and open (1).
    position: f64,
    heard_ns: Option<u64>,
    stepped_ns: Option<u64>,
    /// Whether the gate rises in [`RISE_ANEW`]: from the first wrench or a long gap until the gate is open.
    anew: bool,
}

impl Watchdog {
    /// Creates a closed watchdog without any arrival.
    pub fn new() -> Self {
        Self::default()
    }

    /// Records the arrival of a wrench at `at_ns`. Earlier times than the latest arrival are ignored.
    pub fn heard(&mut self, at_ns: u64) {
        self.anew |= self
            .heard_ns
            .is_none_or(|last| Duration::from_nanos(at_ns.saturating_sub(last)) > LONG_GAP);
        self.heard_ns = self.heard_ns.max(Some(at_ns));
    }

    /// Returns the gate at `now_ns`, 0 (closed) to 1 (open), and advances it.
    ///
    /// The gate moves by at most 15 % between two calls, and by at most 7.5 % at 1 kHz. Begin and end of the ramp are
    /// smooth. A rise after the first wrench, or after a gap of more than 50 ms, lasts half a second.
    pub fn gate(&mut self, now_ns: u64) -> f64 {
        let step_ns = self
            .stepped_ns
            .map_or(0, |last| now_ns.saturating_sub(last));
        self.stepped_ns = self.stepped_ns.max(Some(now_ns));
        let step_s = Duration::from_nanos(step_ns)
            .min(LONGEST_STEP)
            .as_secs_f64();
        let alive = self.heard_ns.is_some_and(|heard| {
            Duration::from_nanos(now_ns.saturating_sub(heard)) < WRENCH_SILENT
        });
        let rise = if self.anew { RISE_ANEW } else { RISE };
        let change = if alive {
            step_s / rise.as_secs_f64()
        } else {
            -step_s / FALL.as_secs_f64()
        };
        self.position = (self.position + change).clamp(0.0, 1.0);
        self.anew &= self.position < 1.0;
        // Smoothstep: no corner at the begin and the end of the ramp.
        self.position * self.position * (3.0 - 2.0 * self.position)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: u64 = 1_000_000;

    /// Largest change between two calls: steepest slope of the smoothstep times the longest step.
    const BOUND: f64 = 1.5 * 0.1 + 1e-12;

    /// Calls the gate at each of `times`. A wrench arrives at every millisecond that `hears` accepts.
    fn run(times: impl IntoIterator<Item = u64>, hears: impl Fn(u64) -> bool) -> Vec<f64> {
        let mut watchdog = Watchdog::new();
        let mut heard_to = 0;
        times
            .into_iter()
            .map(|now| {
                for ms in heard_to / MS..=now / MS {
                    if hears(ms) {
                        watchdog.heard(ms * MS);
                    }
                }
                heard_to = now;
                watchdog.gate(now)
            })
            .collect()
    }

    fn largest_jump(gates: &[f64]) -> f64 {
        gates
            .windows(2)
            .map(|pair| (pair[1] - pair[0]).abs())
            .fold(gates[0], f64::max)
    }

    #[test]
    fn it_stays_closed_until_something_is_heard() {
        assert!(
            run((0..500).map(|ms| ms * MS), |_| false)
                .iter()
                .all(|&gate| gate == 0.0)
        );
    }

    #[test]
    fn it_opens_in_half_a_second_and_stays_open() {
        let gates = run((0..900).map(|ms| ms * MS), |_| true);
        assert!(gates[250] > 0.4 && gates[250] < 0.6);
        assert!(gates[490] < 1.0);
        assert!(gates[501..].iter().all(|&gate| gate == 1.0));
        assert!(gates.is_sorted());
        assert!(largest_jump(&gates) < 0.0032);
    }

    /// Gates of a stream that is open, silent from 800 ms on for `gap` ms, and then there again.
    fn after_a_gap(gap: u64) -> Vec<f64> {
        let silent = 801..800 + gap;
        run((0..2000).map(|ms| ms * MS), |ms| !silent.contains(&ms))
    }

    /// Number of milliseconds from the lowest gate after 800 ms to the open gate.
    fn rise_ms(gates: &[f64]) -> usize {
        let low = gates[800..].iter().copied().fold(1.0, f64::min);
        let last_low = gates.iter().rposition(|&gate| gate == low).expect("low");
        let open = gates[last_low..].iter().position(|&gate| gate == 1.0);
        open.expect("the gate opens again")
    }

    #[test]
    fn a_gap_of_more_than_fifty_milliseconds_is_followed_by_a_rise_of_half_a_second() {
        for gap in [51, 60, 200, 700] {
            let gates = after_a_gap(gap);
            assert!((498..=501).contains(&rise_ms(&gates)), "{gap}");
            let risen = &gates[801 + gap as usize..];
            assert!(risen.is_sorted() && largest_jump(risen) < 0.0032, "{gap}");
        }
    }

    #[test]
    fn a_gap_of_at_most_fifty_milliseconds_keeps_the_rise_of_a_tenth_of_a_second() {
        for gap in [41, 45, 50] {
            assert!((98..=101).contains(&rise_ms(&after_a_gap(gap))), "{gap}");
        }
    }

    #[test]
    fn a_short_gap_in_a_slow_rise_does_not_hasten_it() {
        let gates = run((0..900).map(|ms| ms * MS), |ms| !(201..230).contains(&ms));
        assert!(gates[400] < 0.9, "{}", gates[400]);
        assert!(gates[700] < 1.0);
        assert!(gates[740..].iter().all(|&gate| gate == 1.0));
    }

    #[test]
    fn silence_of_twenty_milliseconds_closes_it_in_twenty_more() {
        let gates = run((0..900).map(|ms| ms * MS), |ms| ms < 700);
        assert_eq!(gates[718], 1.0);
        assert!(gates[719] < 1.0);
        assert!(gates[740..].iter().all(|&gate| gate == 0.0));
        assert!(largest_jump(&gates) < 0.076);
    }

    #[test]
    fn short_gaps_do_not_move_it() {
        let gates = run((0..900).map(|ms| ms * MS), |ms| ms % 19 == 0);
        assert!(gates[530..].iter().all(|&gate| gate == 1.0));
    }

    #[test]
    fn it_turns_round_without_a_jump() {
        // The stream stops at 700 ms and returns in the middle of the fall.
        let gates = run((0..1000).map(|ms| ms * MS), |ms| !(700..730).contains(&ms));
        let low = gates[700..800].iter().copied().fold(1.0, f64::min);
        assert!(low > 0.2 && low < 0.8, "{low}");
        assert!(gates[860..].iter().all(|&gate| gate == 1.0));
        assert!(largest_jump(&gates) < 0.076);
    }

    #[test]
    fn a_device_thread_that_was_held_up_sees_no_jump() {
        let times = [0, 1, 2, 150, 151, 600, 601, 602, 2000, 2001, 2002, 9000].map(|ms| ms * MS);
        for dies in [1, 150, 500, 601, 5000] {
            assert!(
                largest_jump(&run(times, |ms| ms < dies)) <= BOUND,
                "dies at {dies}"
            );
        }
    }

    #[test]
    fn a_clock_that_stands_or_goes_back_moves_nothing() {
        let mut watchdog = Watchdog::new();
        watchdog.heard(10 * MS);
        watchdog.gate(10 * MS);
        let before = watchdog.gate(12 * MS);
        for now in [12, 12, 5, 0, 11] {
            assert_eq!(watchdog.gate(now * MS), before);
        }
        watchdog.heard(0);
        assert!(watchdog.gate(14 * MS) > before);
    }
}
