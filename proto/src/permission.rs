//! Permissions: which role may send which message to which station.
//!
//! The table is data, so that a test can walk every message for every role. A server checks each message and each
//! datagram against it, and ends a connection that sends a message without permission.

use crate::control::{ClientMessage, Instruction};
use crate::role::Role;

/// Kind of a client's message, the unit of permission.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Start of a session.
    Start,
    /// Pause of the student, its end, or the student's lower force limit.
    Command,
    /// Edge of a button.
    Button,
    /// Event for the recording.
    Event,
    /// End of a session.
    Stop,
    /// Exact inputs of ticks that ran at the hand.
    Inputs,
    /// Pose datagram.
    Pose,
    /// Subscription to a display's shapes.
    Show,
    /// Subscription to the status of stations.
    Watch,
    /// Pause of the station, its end, or the station's force limit.
    Levels,
    /// Note, flag, message or ghost for the student.
    Words,
    /// End of a session by an instructor.
    End,
    /// Plan of practice for the next session.
    Plan,
    /// Plan of an exam for the next session.
    ExamPlan,
}

/// Stations at which a message is permitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scope {
    /// No station.
    None,
    /// The stations that the token names.
    Own,
    /// Every station.
    Any,
}

/// Row of the table: a kind, and the scope of each role in the order of [`Role::ALL`].
pub type Permission = (Kind, [Scope; 5]);

/// Permissions of all kinds.
pub const TABLE: [Permission; 14] = {
    use Scope::{Any, None, Own};
    [
        // kind             student display instructor examiner admin
        (Kind::Start, [Own, None, None, None, None]),
        (Kind::Command, [Own, None, None, None, None]),
        (Kind::Button, [Own, None, None, None, None]),
        (Kind::Event, [Own, None, None, None, None]),
        (Kind::Stop, [Own, None, None, None, None]),
        (Kind::Inputs, [Own, None, None, None, None]),
        (Kind::Pose, [Own, None, None, None, None]),
        (Kind::Show, [None, Own, None, None, None]),
        (Kind::Watch, [None, None, Own, Own, Any]),
        (Kind::Levels, [None, None, Own, Own, Any]),
        (Kind::Words, [None, None, Own, Own, Any]),
        (Kind::End, [None, None, Own, Own, Any]),
        (Kind::Plan, [None, None, Own, Own, Any]),
        (Kind::ExamPlan, [None, None, None, Own, Any]),
    ]
};

/// Whether a connection of `role` may send a message of `kind` to a station. `own`: the token names the station.
pub fn may(role: Role, kind: Kind, own: bool) -> bool {
    let column = Role::ALL.iter().position(|other| *other == role);
    let row = TABLE.iter().find(|row| row.0 == kind);
    match row.zip(column).map(|((_, scopes), column)| scopes[column]) {
        Some(Scope::Any) => true,
        Some(Scope::Own) => own,
        Some(Scope::None) | None => false,
    }
}

/// Kind of a message; `None` for a hello, which precedes every role.
///
/// A plan counts as [`Kind::Plan`]. Only the server knows whether its text is that of an exam.
pub fn kind(message: &ClientMessage) -> Option<Kind> {
    Some(match message {
        ClientMessage::Hello(_) => return None,
        ClientMessage::Start => Kind::Start,
        ClientMessage::Command(_) => Kind::Command,
        ClientMessage::Button(_) => Kind::Button,
        ClientMessage::Event(_) => Kind::Event,
        ClientMessage::Stop => Kind::Stop,
        ClientMessage::Inputs(_) | ClientMessage::LastTick(_) => Kind::Inputs,
        ClientMessage::Show(_) => Kind::Show,
        ClientMessage::Watch => Kind::Watch,
        ClientMessage::Instruct(instruct) => match instruct.instruction {
            Instruction::Pause | Instruction::Resume | Instruction::ForceLimit(_) => Kind::Levels,
            Instruction::Note(_)
            | Instruction::Flag(_)
            | Instruction::Say(_)
            | Instruction::Ghost(_) => Kind::Words,
            Instruction::End => Kind::End,
            Instruction::Plan(_) => Kind::Plan,
        },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_has_one_row_and_someone_who_may_send_it() {
        for (kind, scopes) in TABLE {
            assert_eq!(
                TABLE.iter().filter(|row| row.0 == kind).count(),
                1,
                "{kind:?}"
            );
            assert!(scopes.iter().any(|scope| *scope != Scope::None), "{kind:?}");
        }
    }

    #[test]
    fn a_student_reaches_no_other_station_and_no_level_of_the_station() {
        for (kind, _) in TABLE {
            assert!(!may(Role::Student, kind, false), "{kind:?}");
            assert!(!may(Role::Display, kind, false), "{kind:?}");
        }
        for kind in [
            Kind::Watch,
            Kind::Levels,
            Kind::Words,
            Kind::End,
            Kind::Plan,
            Kind::ExamPlan,
            Kind::Show,
        ] {
            assert!(!may(Role::Student, kind, true), "{kind:?}");
        }
    }

    #[test]
    fn no_instructor_moves_a_tool_or_sets_an_exam() {
        for role in [Role::Instructor, Role::Examiner, Role::Admin] {
            for kind in [Kind::Pose, Kind::Start, Kind::Event, Kind::Inputs] {
                assert!(!may(role, kind, true), "{role} {kind:?}");
            }
        }
        assert!(!may(Role::Instructor, Kind::ExamPlan, true));
        assert!(may(Role::Examiner, Kind::ExamPlan, true));
    }
}
