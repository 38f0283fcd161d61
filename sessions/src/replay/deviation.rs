//! How far a replay is from the record, where it is not the same: a number instead of a bare no.

use serde::Serialize;
use sulcus_core::{MAX_TOOLS, State};

use crate::row::Row;

/// Largest and mean differences between what was recorded and what a replay gave. A replay that differs is led back to the
/// recorded state at every snapshot, so that this is what differs within some ten seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Deviation {
    /// Largest difference of a tool's force, newtons.
    pub max_force_n: f64,
    /// The tick of it.
    pub max_force_tick: Option<u64>,
    /// Root mean square over all ticks and tools, newtons.
    pub rms_force_n: f64,
    /// Largest difference of a tool's torque, newton metres.
    pub max_torque_nm: f64,
    /// Largest distance between recorded and replayed place of a graphic tool, millimetres: at snapshots, the only places on
    /// record; `None` where none differed.
    pub max_pose_mm: Option<f64>,
    /// Ticks whose status bits differ.
    pub status_ticks: u64,
}

/// Sums a [`Deviation`] up.
#[derive(Debug, Default)]
pub(super) struct Deviating {
    so_far: Deviation,
    squares: f64,
    ticks: u64,
}

impl Deviating {
    pub fn row(&mut self, recorded: &Row, replayed: &Row) {
        self.ticks += 1;
        for (a, b) in recorded.wrench.iter().zip(&replayed.wrench) {
            let force = apart(&a[..3], &b[..3]);
            self.squares += force * force;
            if force > self.so_far.max_force_n {
                self.so_far.max_force_n = force;
                self.so_far.max_force_tick = Some(recorded.tick);
            }
            self.so_far.max_torque_nm = self.so_far.max_torque_nm.max(apart(&a[3..], &b[3..]));
        }
        self.so_far.status_ticks += u64::from(recorded.status != replayed.status);
    }

    pub fn snapshot(&mut self, recorded: &State, replayed: &State) {
        let places = recorded.tools.iter().zip(&replayed.tools);
        let most = places
            .map(|(a, b)| (a.graphic.position - b.graphic.position).norm() * 1e3)
            .fold(0.0, f64::max);
        let before = self.so_far.max_pose_mm.unwrap_or_default();
        self.so_far.max_pose_mm = Some(before.max(finite(most)));
    }

    pub fn done(&self) -> Deviation {
        let mean = self.squares / (self.ticks.max(1) * MAX_TOOLS as u64) as f64;
        Deviation {
            rms_force_n: finite(mean.sqrt()),
            ..self.so_far
        }
    }
}

/// Distance between two vectors.
fn apart(a: &[f32], b: &[f32]) -> f64 {
    let squares = a.iter().zip(b).map(|(a, b)| {
        let off = f64::from(*a) - f64::from(*b);
        off * off
    });
    finite(squares.sum::<f64>().sqrt())
}

/// A row may claim anything; what is no number is as far off as can be said.
fn finite(x: f64) -> f64 {
    if x.is_finite() { x } else { f64::MAX }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sulcus_core::TickInput;

    fn row(tick: u64, force: f32) -> Row {
        Row {
            tick,
            time_unix_ns: 0,
            input: TickInput::IDLE,
            hash: 0,
            wrench: [[force, 0.0, 0.0, 0.0, force, 0.0], [0.0; 6]],
            status: [0; MAX_TOOLS],
        }
    }

    #[test]
    fn the_largest_is_kept_with_its_tick_and_the_mean_is_over_both_tools() {
        let mut deviating = Deviating::default();
        for (tick, off) in [(1, 0.0), (2, 3.0), (3, 1.0)] {
            deviating.row(&row(tick, 0.0), &row(tick, off));
        }
        let found = deviating.done();
        assert_eq!((found.max_force_n, found.max_force_tick), (3.0, Some(2)));
        assert_eq!(found.max_torque_nm, 3.0);
        assert!((found.rms_force_n - (10.0f64 / 6.0).sqrt()).abs() < 1e-12);
        assert_eq!((found.status_ticks, found.max_pose_mm), (0, None));
    }

    #[test]
    fn what_is_no_number_is_as_far_off_as_can_be_said() {
        let mut deviating = Deviating::default();
        deviating.row(&row(1, f32::NAN), &row(1, 0.0));
        assert_eq!(deviating.done().max_force_n, f64::MAX);
        assert_eq!(deviating.done().rms_force_n, f64::MAX);
    }
}
