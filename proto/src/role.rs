//! Roles of connections.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// Role of a token or of a connection. [`crate::permission`] lists the messages that each role may send.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// Hand at a device: poses, the student's own pause, buttons, calls and the end of the own session.
    Student,
    /// Screen: shapes of one station. A display moves nothing and says nothing.
    Display,
    /// Instructor: status of stations, pause, force limit, notes, messages, end, plans of practice.
    Instructor,
    /// Examiner: everything of an instructor, and plans of exams.
    Examiner,
    /// Administrator: everything of an examiner, at every station.
    Admin,
}

impl Role {
    /// All roles.
    pub const ALL: [Role; 5] = [
        Role::Student,
        Role::Display,
        Role::Instructor,
        Role::Examiner,
        Role::Admin,
    ];

    /// Name, as in files and options.
    pub fn name(self) -> &'static str {
        match self {
            Role::Student => "student",
            Role::Display => "display",
            Role::Instructor => "instructor",
            Role::Examiner => "examiner",
            Role::Admin => "admin",
        }
    }

    /// Whether a token of this role may open a connection as `asked`. Each token opens its own role and a display.
    pub fn may_act_as(self, asked: Role) -> bool {
        self == asked || asked == Role::Display
    }
}

impl fmt::Display for Role {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Role {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|role| role.name() == text);
        found.ok_or_else(|| {
            let names = Self::ALL.map(Role::name).join(", ");
            format!("role is `{text}`, expected one of {names}")
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_role_survives_its_name() {
        for role in Role::ALL {
            assert_eq!(role.to_string().parse(), Ok(role));
        }
        let error = "teacher".parse::<Role>().expect_err("unknown");
        assert!(error.contains("`teacher`") && error.contains("examiner"), "{error}");
    }

    #[test]
    fn a_student_opens_no_other_connection_than_his_hand_and_his_screen() {
        for role in Role::ALL {
            assert_eq!(
                Role::Student.may_act_as(role),
                matches!(role, Role::Student | Role::Display)
            );
        }
    }
}
