//! Changes of pause and force limit as events of a recording, each with its side and the first tick in force.

use serde_json::json;
use sulcus_sessions::Occurrence;
use sulcus_sessions::exercise::events::{FORCE_LIMIT, PAUSED, RESUMED};

use crate::session::levels::{InForce, Level};

/// Largest number of a student's changes that become events in one session.
///
/// A client that switches a thousand times a second must not fill the disk. The inputs of the ticks hold every change.
const BY_STUDENT: u64 = 1000;

/// Finds changes from tick to tick. Before the first tick neither side has a pause or a limit.
#[derive(Debug, Default)]
pub(crate) struct Changes {
    before: InForce,
    by_student: u64,
}

impl Changes {
    /// Events of a tick with the levels `in_force`; empty in nearly all ticks.
    pub fn take(&mut self, tick: u64, in_force: InForce) -> Vec<Occurrence> {
        // An empty vector allocates nothing.
        let mut said = Vec::new();
        if in_force == self.before {
            return said;
        }
        let before = std::mem::replace(&mut self.before, in_force);
        changed(tick, "station", before.station, in_force.station, &mut said);
        let by_station = said.len();
        changed(tick, "student", before.student, in_force.student, &mut said);
        let room = BY_STUDENT.saturating_sub(self.by_student);
        self.by_student += (said.len() - by_station) as u64;
        said.truncate(by_station.saturating_add(usize::try_from(room).unwrap_or(usize::MAX)));
        said
    }

    /// Number of the student's changes that became no event.
    pub fn unsaid(&self) -> u64 {
        self.by_student.saturating_sub(BY_STUDENT)
    }
}

fn changed(tick: u64, by: &str, before: Level, now: Level, said: &mut Vec<Occurrence>) {
    let mut say = |kind: &str, data| {
        said.push(Occurrence {
            kind: kind.into(),
            tick,
            data,
        });
    };
    if before.paused != now.paused {
        let kind = if now.paused { PAUSED } else { RESUMED };
        say(kind, json!({ "by": by }));
    }
    if before.force_limit_n != now.force_limit_n {
        say(
            FORCE_LIMIT,
            json!({ "by": by, "force_limit_n": decimal(now.force_limit_n) }),
        );
    }
}

/// The shortest decimal number of an f32: 0.2 and not 0.20000000298.
fn decimal(number: f32) -> f64 {
    number.to_string().parse().unwrap_or(f64::from(number))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn asked(paused: bool, force_limit_n: f32) -> Level {
        Level {
            paused,
            force_limit_n,
        }
    }

    fn texts(said: &[Occurrence]) -> Vec<String> {
        said.iter().map(ToString::to_string).collect()
    }

    #[test]
    fn a_level_from_before_the_session_is_an_event_of_its_first_tick() {
        let mut changes = Changes::default();
        let mut now = InForce {
            station: asked(true, 0.2),
            student: asked(false, 0.0),
            ..InForce::default()
        };
        assert_eq!(
            texts(&changes.take(1, now)),
            [
                r#"paused at tick 1: {"by":"station"}"#,
                r#"force_limit at tick 1: {"by":"station","force_limit_n":0.2}"#
            ]
        );
        assert!(changes.take(2, now).is_empty());
        now.station.paused = false;
        now.student.paused = true;
        assert_eq!(
            texts(&changes.take(3, now)),
            [
                r#"resumed at tick 3: {"by":"station"}"#,
                r#"paused at tick 3: {"by":"student"}"#
            ]
        );
    }

    /// A flood of the student's changes must not displace those of the station's side.
    #[test]
    fn a_student_that_switches_all_the_time_has_a_bounded_log_and_the_station_has_its_own() {
        let mut changes = Changes::default();
        let mut now = InForce::default();
        let mut said = 0;
        for tick in 1..=3000 {
            now.student.paused = !now.student.paused;
            said += changes.take(tick, now).len() as u64;
        }
        assert_eq!((said, changes.unsaid()), (BY_STUDENT, 2000));
        now.station.paused = true;
        assert_eq!(changes.take(3001, now).len(), 1);
    }
}
