//! Persons who may see a session.

use sulcus_proto::Role;

use crate::house::register::Sight as Register;
use crate::house::{Holder, Recorded};

/// Extent to which a person may see a session's grade.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sight {
    /// Not at all; the session does not appear.
    Nothing,
    /// The existence of the session. The learner of a self-assessment gives the own score first; the result of an exam
    /// is still sealed.
    Entry,
    /// The grade.
    Grade,
}

/// Extent to which a person may see a session, from the rule of learners and exams: a teacher of one station sees that
/// station, and a learner gives the own score of a self-assessment first.
pub fn sight(holder: &Holder, one: &Recorded, register: Register) -> Sight {
    match (holder.role, register) {
        (_, Register::Nothing) | (Role::Display, _) => Sight::Nothing,
        (Role::Student, Register::Existence) => Sight::Entry,
        (Role::Student, Register::All) if one.waits_for_own_score() => Sight::Entry,
        (Role::Student, Register::All) => Sight::Grade,
        _ if !holder.includes(&one.station) => Sight::Nothing,
        (_, Register::Existence) => Sight::Entry,
        (_, Register::All) => Sight::Grade,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_person_sees_what_station_and_own_score_admit() {
        use Sight::{Entry, Grade, Nothing};
        let session = |mode: &str, own_score: Option<f64>| Recorded {
            station: "a".into(),
            mode: mode.into(),
            score: Some(61.0),
            own_score,
            ..Recorded::default()
        };
        let (practice, exam) = (session("practice", None), session("exam", None));
        let (own, given) = (
            session("self-assessment", None),
            session("self-assessment", Some(70.0)),
        );
        let (all, existence, nothing) = (Register::All, Register::Existence, Register::Nothing);
        let rows = [
            (Role::Student, Some("b"), &practice, all, Grade),
            (Role::Student, Some("a"), &practice, nothing, Nothing),
            (Role::Student, Some("a"), &own, all, Entry),
            (Role::Student, Some("a"), &given, all, Grade),
            (Role::Student, Some("a"), &exam, existence, Entry),
            (Role::Instructor, None, &practice, all, Grade),
            (Role::Instructor, None, &own, all, Grade),
            (Role::Instructor, Some("a"), &practice, all, Grade),
            (Role::Instructor, Some("b"), &practice, all, Nothing),
            (Role::Instructor, None, &exam, existence, Entry),
            (Role::Examiner, Some("b"), &exam, all, Nothing),
            (Role::Admin, None, &exam, all, Grade),
            (Role::Display, None, &practice, all, Nothing),
        ];
        for (role, station, one, register, expected) in rows {
            let holder = Holder {
                id: "t".into(),
                role,
                station: station.map(str::to_owned),
            };
            let found = sight(&holder, one, register);
            assert_eq!(found, expected, "{role} {station:?} {}", one.mode);
        }
    }
}
