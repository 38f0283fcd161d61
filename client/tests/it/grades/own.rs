//! Which metrics name a habit, and what it costs: for the test of the grades and for the example that runs it over many seeds.

use sulcus_operator::Habit;

/// Fewest points that a bad habit costs.
pub const COSTS: f64 = 15.0;
/// A metric under this score names a habit.
pub const NAMED: f64 = 50.0;

/// The metrics that name a habit: the first in whatever mouth, the others in that of the exercise.
pub fn own(habit: Habit) -> &'static [&'static str] {
    match habit {
        Habit::HeavyHand => &["touches_too_heavy", "readings_too_heavy", "trauma_events"],
        Habit::WrongAngle => &["angle_mid"],
        Habit::SkipsSites => &["zones_charted"],
        Habit::Impatient => &["readings_held", "touches_too_light"],
        Habit::LetsTongueGo => &["coordination", "target_visible"],
        Habit::SpotProbes => &["withdrawals", "walking_step"],
        Habit::Misreads => &["misread"],
        Habit::StopsShort => &["floor_reached"],
    }
}
