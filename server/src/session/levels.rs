//! Pause and force limit as levels: atomic words that every tick reads, so that no queue stands between a command and
//! the hand.
//!
//! The station's side and the student's connection each hold a level of their own. The station's level lives as long as
//! the server: before, between and after sessions. The student's level lives as long as the connection. In force is
//! the pause of either side and the smaller of the two limits: a student can make a session gentler, never rougher.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use sulcus_proto::control::Command;

/// Pause and limit that one side asks for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Level {
    /// Forces are to be zero.
    pub paused: bool,
    /// Largest force, newtons; 0: the scene's limit.
    pub force_limit_n: f32,
}

/// Levels of both sides in one tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct InForce {
    /// Asked for by the station's side.
    pub station: Level,
    /// Asked for by the student's connection.
    pub student: Level,
}

impl InForce {
    /// Whether either side has paused.
    pub fn paused(&self) -> bool {
        self.station.paused || self.student.paused
    }

    /// The smaller limit, newtons; 0: the scene's limit.
    pub fn force_limit_n(&self) -> f32 {
        match (self.station.force_limit_n, self.student.force_limit_n) {
            (0.0, only) | (only, 0.0) => only,
            (a, b) if a < b => a,
            (_, b) => b,
        }
    }
}

/// Outcome of a command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Taken {
    /// The level is what was asked for.
    Set,
    /// The side's pause has ended: a new session epoch begins.
    Lifted,
    /// The limit is no force: negative, infinite or not a number. The level is as before.
    NoForce(f32),
}

/// A side's level in one word: bit 32 is the pause, the low half the limit's bits.
#[derive(Debug, Default)]
struct Word(AtomicU64);

impl Word {
    const PAUSED: u64 = 1 << 32;
    const LIMIT: u64 = u32::MAX as u64;

    fn load(&self) -> Level {
        let word = self.0.load(Ordering::Acquire);
        Level {
            paused: word & Self::PAUSED != 0,
            force_limit_n: f32::from_bits((word & Self::LIMIT) as u32),
        }
    }

    fn take(&self, command: Command) -> Taken {
        match command {
            Command::Pause => {
                self.0.fetch_or(Self::PAUSED, Ordering::AcqRel);
                Taken::Set
            }
            Command::Resume => {
                let before = self.0.fetch_and(!Self::PAUSED, Ordering::AcqRel);
                if before & Self::PAUSED == 0 {
                    Taken::Set
                } else {
                    Taken::Lifted
                }
            }
            Command::ForceLimit(newtons) if is_limit(newtons) => {
                // Adding makes a zero of -0.0.
                let limit = u64::from((newtons + 0.0).to_bits());
                let with = |word: u64| word & !Self::LIMIT | limit;
                self.0.update(Ordering::AcqRel, Ordering::Acquire, with);
                Taken::Set
            }
            Command::ForceLimit(newtons) => Taken::NoForce(newtons),
        }
    }
}

/// Whether a number of newtons can be a limit: 0 (the scene's) or a finite positive force.
pub(crate) fn is_limit(newtons: f32) -> bool {
    newtons.is_finite() && newtons >= 0.0
}

/// The station's level and that of one connection. Clones share both.
#[derive(Clone, Debug, Default)]
pub(crate) struct Levels {
    station: Arc<Word>,
    student: Arc<Word>,
}

impl Levels {
    /// The same station, and a connection that has asked for nothing yet.
    pub fn of_new_connection(&self) -> Self {
        Self {
            station: self.station.clone(),
            student: Arc::default(),
        }
    }

    /// A command of the station's side.
    pub fn station(&self, command: Command) -> Taken {
        self.station.take(command)
    }

    /// A request of the student's connection.
    pub fn student(&self, command: Command) -> Taken {
        self.student.take(command)
    }

    /// Levels that a tick which begins now keeps to. Wait-free.
    pub fn in_force(&self) -> InForce {
        InForce {
            station: self.station.load(),
            student: self.student.load(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A client could resume what the instructor had paused, and take back the limit.
    #[test]
    fn a_student_adds_to_what_the_station_asks_for_and_takes_nothing_away() {
        let levels = Levels::default();
        levels.station(Command::Pause);
        levels.station(Command::ForceLimit(0.5));
        for (asked, limit) in [
            (Command::Resume, 0.5),
            (Command::ForceLimit(0.0), 0.5),
            (Command::ForceLimit(9.0), 0.5),
            (Command::ForceLimit(f32::NAN), 0.5),
            (Command::ForceLimit(-1.0), 0.5),
            (Command::ForceLimit(0.2), 0.2),
            (Command::ForceLimit(0.0), 0.5),
        ] {
            levels.student(asked);
            let now = levels.in_force();
            assert!(now.paused(), "{asked:?}");
            assert_eq!(now.force_limit_n(), limit, "{asked:?}");
        }
    }

    #[test]
    fn each_side_lifts_its_own_pause() {
        let levels = Levels::default();
        levels.student(Command::Pause);
        assert_eq!(levels.station(Command::Resume), Taken::Set);
        assert!(levels.in_force().paused());
        levels.station(Command::Pause);
        assert_eq!(levels.student(Command::Resume), Taken::Lifted);
        assert!(levels.in_force().paused());
        assert_eq!(levels.station(Command::Resume), Taken::Lifted);
        assert!(!levels.in_force().paused());
    }

    #[test]
    fn the_stations_level_outlives_a_connection_and_the_students_does_not() {
        let server = Levels::default();
        server.station(Command::ForceLimit(1.5));
        let first = server.of_new_connection();
        first.student(Command::Pause);
        first.student(Command::ForceLimit(0.1));
        assert!(first.in_force().paused());
        let second = server.of_new_connection();
        server.station(Command::Pause);
        let now = second.in_force();
        assert_eq!((now.paused(), now.force_limit_n()), (true, 1.5));
        assert_eq!(now.student, Level::default());
        assert_eq!(first.in_force().force_limit_n(), 0.1);
    }

    #[test]
    fn a_limit_that_is_no_force_changes_nothing() {
        let levels = Levels::default();
        levels.station(Command::ForceLimit(0.3));
        for newtons in [f32::NAN, f32::INFINITY, -0.1] {
            let taken = levels.station(Command::ForceLimit(newtons));
            assert!(matches!(taken, Taken::NoForce(_)), "{taken:?}");
            assert_eq!(levels.in_force().force_limit_n(), 0.3);
        }
        levels.station(Command::ForceLimit(-0.0));
        assert_eq!(levels.in_force().force_limit_n().to_bits(), 0);
    }

    /// The limit and the pause share a word: a change of one beside the other must not lose either.
    #[test]
    fn changes_of_pause_and_limit_at_once_lose_neither() {
        let levels = Levels::default();
        std::thread::scope(|scope| {
            scope.spawn(|| {
                for k in 0..10_000 {
                    levels.station(Command::ForceLimit(k as f32));
                }
            });
            for _ in 0..10_000 {
                levels.station(Command::Resume);
                levels.station(Command::Pause);
                assert!(levels.in_force().paused());
            }
        });
        assert_eq!(levels.in_force().force_limit_n(), 9_999.0);
    }
}
