//! Pause and force limit as levels: atomic words that every tick reads. No queue delays a command.
//!
//! The station's side and the student each have a level. The station's level lives as long as the station: before,
//! between and after sessions. The student's level lives as long as the session. A tick obeys the pause of either side
//! and the smaller of the two limits: a student can lower the force, never raise it.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use sulcus_proto::control::Command;
use sulcus_proto::datagram::{WireLevels, smaller_limit};
use tokio::sync::Notify;

/// Pause and force limit of one side.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Level {
    /// Whether the side has paused: all forces ramp to zero.
    pub paused: bool,
    /// Largest force, newtons; 0: the scene's limit.
    pub force_limit_n: f32,
}

/// Levels of both sides in one tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InForce {
    /// Level of the station's side.
    pub station: Level,
    /// Level of the student.
    pub student: Level,
    /// Force limit of the plan, newtons; 0 for none.
    pub plan_limit_n: f32,
}

impl InForce {
    /// Whether either side has paused.
    pub fn paused(&self) -> bool {
        self.station.paused || self.student.paused
    }

    /// The smallest limit, newtons; 0: the scene's limit.
    pub fn force_limit_n(&self) -> f32 {
        let sides = smaller_limit(self.station.force_limit_n, self.student.force_limit_n);
        smaller_limit(sides, self.plan_limit_n)
    }

    /// The levels on the wire, after `commands` commands of the station's side.
    pub fn on_the_wire(&self, commands: u64) -> WireLevels {
        WireLevels {
            paused_by_station: self.station.paused,
            paused_by_student: self.student.paused,
            force_limit_n: self.force_limit_n(),
            // Wraps, as the wire's number does.
            commands: commands as u32,
        }
    }
}

/// Outcome of a command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Taken {
    /// The level has the value of the command.
    Set,
    /// The command ended a pause of the side: a new session epoch begins, even if the other side still has a pause.
    Lifted,
    /// The limit is negative, infinite or not a number. The level is unchanged.
    NoForce(f32),
}

/// Level of one side in one word: bit 32 is the pause, the low half holds the bits of the limit.
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
                // The addition turns -0.0 into 0.
                let limit = u64::from((newtons + 0.0).to_bits());
                let with = |word: u64| word & !Self::LIMIT | limit;
                self.0.update(Ordering::AcqRel, Ordering::Acquire, with);
                Taken::Set
            }
            Command::ForceLimit(newtons) => Taken::NoForce(newtons),
        }
    }
}

/// Whether a number of newtons is a valid limit: 0 for the scene's limit, or a finite positive force.
pub(crate) fn is_limit(newtons: f32) -> bool {
    newtons.is_finite() && newtons >= 0.0
}

/// Level of the station and level of one student. Clones share both.
#[derive(Clone, Debug, Default)]
pub(crate) struct Levels {
    station: Arc<Word>,
    student: Arc<Word>,
    /// Number of commands of the station's side so far. A tick that has read number n obeys the first n commands.
    commands: Arc<AtomicU64>,
    /// Wakes the connection of a student whose ticks run at the hand.
    changed: Arc<Notify>,
    /// Force limit of the session's plan, newtons; 0 for none.
    plan_limit_n: f32,
}

impl Levels {
    /// Levels of a new session: the same station, a student without pause and limit, and the limit of the plan.
    pub fn of_new_session(&self, plan_limit_n: f32) -> Self {
        Self {
            student: Arc::default(),
            plan_limit_n,
            ..self.clone()
        }
    }

    /// Applies a command of the station's side.
    pub fn station(&self, command: Command) -> Taken {
        let taken = self.station.take(command);
        // After the word: a tick that reads the new number reads the new word too.
        self.commands.fetch_add(1, Ordering::AcqRel);
        self.changed.notify_one();
        taken
    }

    /// Waits for a command of the station's side that has not been awaited yet.
    pub async fn changed(&self) {
        self.changed.notified().await;
    }

    /// Number of commands of the station's side so far.
    pub fn commands(&self) -> u64 {
        self.commands.load(Ordering::Acquire)
    }

    /// Applies a command of the student.
    pub fn student(&self, command: Command) -> Taken {
        self.student.take(command)
    }

    /// Levels for a tick that begins now. Wait-free.
    pub fn in_force(&self) -> InForce {
        InForce {
            station: self.station.load(),
            student: self.student.load(),
            plan_limit_n: self.plan_limit_n,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A client could once lift the instructor's pause and limit.
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
    fn the_stations_level_outlives_a_session_and_the_students_does_not() {
        let server = Levels::default();
        server.station(Command::ForceLimit(1.5));
        let first = server.of_new_session(0.0);
        first.student(Command::Pause);
        first.student(Command::ForceLimit(0.1));
        assert!(first.in_force().paused());
        let second = server.of_new_session(0.0);
        server.station(Command::Pause);
        let now = second.in_force();
        assert_eq!((now.paused(), now.force_limit_n()), (true, 1.5));
        assert_eq!(now.student, Level::default());
        assert_eq!(first.in_force().force_limit_n(), 0.1);
    }

    #[test]
    fn nobody_raises_the_limit_of_a_plan() {
        let levels = Levels::default().of_new_session(0.4);
        assert_eq!(levels.in_force().force_limit_n(), 0.4);
        levels.station(Command::ForceLimit(2.0));
        levels.student(Command::ForceLimit(1.0));
        assert_eq!(levels.in_force().force_limit_n(), 0.4);
        levels.station(Command::ForceLimit(0.1));
        assert_eq!(levels.in_force().force_limit_n(), 0.1);
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

    /// Limit and pause share a word: simultaneous changes must keep both.
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
