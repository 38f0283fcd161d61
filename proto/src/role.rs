//! Roles: the groups of rights that an access token grants.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// Role of a token, and of every connection that the token opens.
///
/// The table of [`crate::permission`] says which message each role may send to which station. A message that the table
/// does not grant is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// A learner at one station: sends poses, buttons and calls, receives wrenches, may pause the own session. A
    /// student cannot change plans, and cannot lift a pause or a force limit of an instructor.
    Student,
    /// A screen of one station: receives the display scene and moving shapes. A display commands nothing.
    Display,
    /// A teacher of any number of stations: reads status and events, pauses, resumes, limits forces, sets plans. A plan
    /// of an exam cannot be changed by an instructor or any other role while its session runs.
    Instructor,
    /// An instructor who conducts exams: the rights of an instructor, and results of exams before their release.
    Examiner,
    /// The administrator of the server: the rights of an examiner, and tokens, certificate and settings of the server.
    Admin,
}

impl Role {
    /// All roles, from the fewest rights to the most.
    pub const ALL: [Role; 5] = [
        Role::Student,
        Role::Display,
        Role::Instructor,
        Role::Examiner,
        Role::Admin,
    ];

    /// Name on the command line, in files and in JSON.
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

    /// Whether the role belongs to one station. Any other role may be given for every station of a server.
    pub fn is_of_one_station(self) -> bool {
        matches!(self, Role::Student | Role::Display)
    }
}

impl fmt::Display for Role {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // `pad` takes the width of a table's column into account.
        f.pad(self.name())
    }
}

/// Error of a text that names no role.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("role is `{found}`, expected student, display, instructor, examiner or admin")]
pub struct RoleError {
    /// Text found, without control characters.
    pub found: String,
}

impl FromStr for Role {
    type Err = RoleError;

    fn from_str(text: &str) -> Result<Self, RoleError> {
        let named = Role::ALL.into_iter().find(|role| role.name() == text);
        named.ok_or_else(|| RoleError {
            found: text.escape_debug().to_string(),
        })
    }
}

#[cfg(test)]
mod tests {
    use serde::de::IntoDeserializer;
    use serde::de::value::Error;

    use super::*;

    #[test]
    fn a_role_has_one_name_everywhere() {
        for role in Role::ALL {
            assert_eq!(role.to_string().parse(), Ok(role));
            let read = Role::deserialize(IntoDeserializer::<Error>::into_deserializer(role.name()));
            assert_eq!(read, Ok(role));
        }
        let error = "Student\n".parse::<Role>().expect_err("capital, line feed");
        assert!(error.to_string().contains("`Student\\n`"), "{error}");
    }

    #[test]
    fn roles_are_in_the_order_of_their_rights() {
        assert!(Role::ALL.is_sorted());
        assert_eq!(
            Role::ALL.map(Role::is_of_one_station),
            [true, true, false, false, false]
        );
    }
}
