//! Deviation of a replay from the record, in numbers.

use serde::Serialize;
use sulcus_core::State;

use crate::record::row::Row;

/// Largest and mean differences between the record and a replay. A replay that differs continues from the recorded
/// state at every snapshot, so the differences are those within about ten seconds. The replay of a former version does
/// not ([`crate::record::format`]).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Deviation {
    /// Largest difference of a tool's force, newtons.
    pub max_force_n: f64,
    /// Tick of the largest force difference.
    pub max_force_tick: Option<u64>,
    /// Root mean square of the force difference, newtons: over the ticks with a tool under load in the record or in the
    /// replay, in the worst stretch between two snapshots.
    pub rms_force_n: f64,
    /// Largest difference of a tool's torque, newton metres.
    pub max_torque_nm: f64,
    /// Largest distance between recorded and replayed place of a graphic tool, millimetres. Only snapshots have places;
    /// `None` without a differing snapshot.
    pub max_pose_mm: Option<f64>,
    /// Ticks with other status bits.
    pub status_ticks: u64,
    /// Rows with another tick than the replay, and snapshots without a valid state.
    pub out_of_step: u64,
}

/// Sum of differences.
#[derive(Debug, Default)]
pub(super) struct Deviating {
    so_far: Deviation,
    /// Sum of squares of the present stretch; below, its number of ticks and tools under load.
    squares: f64,
    loaded: u64,
}

impl Deviating {
    pub fn row(&mut self, recorded: &Row, replayed: &Row) {
        self.so_far.out_of_step += u64::from(recorded.tick != replayed.tick);
        for (a, b) in recorded.wrench.iter().zip(&replayed.wrench) {
            let force = apart(&a[..3], &b[..3]);
            if [a, b].into_iter().any(|wrench| wrench != &[0.0; 6]) {
                self.squares += force * force;
                self.loaded += 1;
            }
            if force > self.so_far.max_force_n {
                self.so_far.max_force_n = force;
                self.so_far.max_force_tick = Some(recorded.tick);
            }
            self.so_far.max_torque_nm = self.so_far.max_torque_nm.max(apart(&a[3..], &b[3..]));
        }
        self.so_far.status_ticks += u64::from(recorded.status != replayed.status);
    }

    pub fn snapshot(&mut self, recorded: &State, replayed: &State) {
        self.stretch();
        let places = recorded.tools.iter().zip(&replayed.tools);
        let most = places
            .map(|(a, b)| (a.graphic.position - b.graphic.position).norm() * 1e3)
            .fold(0.0, f64::max);
        let before = self.so_far.max_pose_mm.unwrap_or_default();
        self.so_far.max_pose_mm = Some(before.max(finite(most)));
    }

    pub fn unusable(&mut self) {
        self.so_far.out_of_step += 1;
        self.stretch();
    }

    /// Ends the present stretch.
    fn stretch(&mut self) {
        let mean = finite((self.squares / self.loaded.max(1) as f64).sqrt());
        self.so_far.rms_force_n = self.so_far.rms_force_n.max(mean);
        (self.squares, self.loaded) = (0.0, 0);
    }

    pub fn done(mut self) -> Deviation {
        self.stretch();
        self.so_far
    }
}

/// Length of the difference of two vectors.
fn apart(a: &[f32], b: &[f32]) -> f64 {
    let squares = a.iter().zip(b).map(|(a, b)| {
        let off = f64::from(*a) - f64::from(*b);
        off * off
    });
    finite(squares.sum::<f64>().sqrt())
}

/// Number for the largest difference if `x` is not finite. A row may contain any number.
fn finite(x: f64) -> f64 {
    if x.is_finite() { x } else { f64::MAX }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sulcus_core::{MAX_TOOLS, TickInput};

    fn row(tick: u64, force: f32) -> Row {
        Row {
            tick,
            time_unix_ns: 0,
            input: TickInput::IDLE,
            hash: 0,
            wrench: [[force, 0.0, 0.0, 0.0, force, 0.0], [0.0; 6]],
            status: [0; MAX_TOOLS],
            device: [None; MAX_TOOLS],
        }
    }

    #[test]
    fn the_largest_is_kept_with_its_tick_and_the_mean_is_over_what_bears_load() {
        let mut deviating = Deviating::default();
        for (tick, off) in [(1, 0.0), (2, 3.0), (3, 1.0)] {
            deviating.row(&row(tick, 0.0), &row(tick, off));
        }
        // Tool 1 bears no load, and neither does tool 0 in the first tick.
        let found = deviating.done();
        assert_eq!((found.max_force_n, found.max_force_tick), (3.0, Some(2)));
        assert_eq!(found.max_torque_nm, 3.0);
        assert!((found.rms_force_n - 5.0f64.sqrt()).abs() < 1e-12);
        assert_eq!((found.status_ticks, found.max_pose_mm), (0, None));
        assert_eq!(found.out_of_step, 0);
    }

    #[test]
    fn a_bad_stretch_is_not_thinned_by_good_ones() {
        let mut deviating = Deviating::default();
        for tick in 1..=1000 {
            deviating.row(&row(tick, 1.0), &row(tick, 1.0));
        }
        deviating.unusable();
        deviating.row(&row(1001, 1.0), &row(1001, 3.0));
        deviating.row(&row(1003, 1.0), &row(1002, 1.0));
        let found = deviating.done();
        assert!((found.rms_force_n - 2.0f64.sqrt()).abs() < 1e-12);
        assert_eq!(found.out_of_step, 2);
    }

    #[test]
    fn what_is_no_number_is_as_far_off_as_can_be_said() {
        let mut deviating = Deviating::default();
        deviating.row(&row(1, f32::NAN), &row(1, 0.0));
        let found = deviating.done();
        assert_eq!((found.max_force_n, found.rms_force_n), (f64::MAX, f64::MAX));
    }
}
