//! Habits: typical errors of students, by name.

use std::str::FromStr;

/// Habit of an operator: a typical error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Habit {
    /// The probe presses with 0.6 N.
    HeavyHand,
    /// The probe is tilted by 27 degrees away from the tooth and never enters the col.
    WrongAngle,
    /// The distolingual zones and every third of the other zones are skipped.
    SkipsSites,
    /// The probe turns back at the first resistance, reads too shortly, and takes large steps.
    Impatient,
    /// The mirror lets the tongue go after half of the tour.
    LetsTongueGo,
    /// The probe is inserted once for each zone, upright and not beyond the line angle, and is withdrawn in between.
    SpotProbes,
    /// The operator confuses marks of the probe: [`crate::bands::Blur`].
    Misreads,
    /// The probe stops 1.2 mm below the margin, before the floor of the pocket.
    StopsShort,
}

impl Habit {
    /// All habits, in the order of messages.
    pub const ALL: [Habit; 8] = [
        Habit::HeavyHand,
        Habit::WrongAngle,
        Habit::SkipsSites,
        Habit::Impatient,
        Habit::LetsTongueGo,
        Habit::SpotProbes,
        Habit::Misreads,
        Habit::StopsShort,
    ];

    /// Share of the tour after which the mirror lets the tongue go, 0 to 1; 1: at the end.
    pub const fn holds_until(habit: Option<Self>) -> f64 {
        match habit {
            Some(Habit::LetsTongueGo) => 0.5,
            _ => 1.0,
        }
    }

    /// Name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Habit::HeavyHand => "heavy-hand",
            Habit::WrongAngle => "wrong-angle",
            Habit::SkipsSites => "skips-sites",
            Habit::Impatient => "impatient",
            Habit::LetsTongueGo => "lets-tongue-go",
            Habit::SpotProbes => "spot-probes",
            Habit::Misreads => "misreads",
            Habit::StopsShort => "stops-short",
        }
    }
}

impl std::fmt::Display for Habit {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

/// Error of an unknown name of a habit.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("habit is `{0}`, expected one of: {names}", names = names())]
pub struct UnknownHabit(pub String);

fn names() -> String {
    Habit::ALL.map(Habit::name).join(", ")
}

impl FromStr for Habit {
    type Err = UnknownHabit;

    fn from_str(name: &str) -> Result<Self, UnknownHabit> {
        let found = Self::ALL.into_iter().find(|habit| habit.name() == name);
        found.ok_or_else(|| UnknownHabit(name.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_go_both_ways_and_the_error_lists_them() {
        for habit in Habit::ALL {
            assert_eq!(habit.name().parse(), Ok(habit));
        }
        let error = "heavy".parse::<Habit>().expect_err("no such habit");
        let said = error.to_string();
        assert!(said.contains("`heavy`"), "{said}");
        assert!(
            Habit::ALL.iter().all(|habit| said.contains(habit.name())),
            "{said}"
        );
    }
}
