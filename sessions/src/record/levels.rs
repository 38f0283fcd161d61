//! Pause and force limit in the log: kinds of the events, and the side that set a level.

use std::fmt;

use serde_json::json;

use crate::record::occurrence::Occurrence;

/// Kind: one side pauses.
pub const PAUSED: &str = "paused";
/// Kind: one side ends its pause.
pub const RESUMED: &str = "resumed";
/// Kind: one side sets its force limit.
pub const FORCE_LIMIT: &str = "force_limit";
/// Kinds of the events of a pause or a force limit. Data: `by`, the side ([`By`]); `force_limit_n`, the limit of that
/// side, newtons, 0 for no limit.
pub const LEVELS: [&str; 3] = [PAUSED, RESUMED, FORCE_LIMIT];

/// Side that set a level.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum By {
    /// The station itself, by its options or its console.
    Station,
    /// The student's own connection.
    Student,
    /// An instructor: opaque id of the token. An id that reads `station` or `student` is recorded with a dash before
    /// it.
    Instructor(String),
}

impl fmt::Display for By {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Station => f.write_str("station"),
            Self::Student => f.write_str("student"),
            Self::Instructor(id) if ["", "station", "student"].contains(&id.as_str()) => {
                write!(f, "-{id}")
            }
            Self::Instructor(id) => f.write_str(id),
        }
    }
}

impl Occurrence {
    /// Event `paused`: a side pauses.
    pub fn paused(tick: u64, by: &By) -> Self {
        Self {
            kind: PAUSED.into(),
            tick,
            data: json!({ "by": by.to_string() }),
        }
    }

    /// Event `resumed`: a side ends its pause.
    pub fn resumed(tick: u64, by: &By) -> Self {
        Self {
            kind: RESUMED.into(),
            tick,
            data: json!({ "by": by.to_string() }),
        }
    }

    /// Event `force_limit`: a side sets its limit, newtons; 0 for none.
    pub fn force_limit(tick: u64, by: &By, newtons: f32) -> Self {
        // The shortest decimal number of an f32: 0.2 and not 0.20000000298.
        let decimal = newtons.to_string().parse().unwrap_or(f64::from(newtons));
        Self {
            kind: FORCE_LIMIT.into(),
            tick,
            data: json!({ "by": by.to_string(), "force_limit_n": decimal }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_level_names_its_side_and_no_instructor_passes_for_another_side() {
        let id = |id: &str| By::Instructor(id.to_owned());
        assert_eq!(
            Occurrence::paused(3, &id("t04")).to_string(),
            r#"paused at tick 3: {"by":"t04"}"#
        );
        assert_eq!(
            Occurrence::force_limit(1, &By::Station, 0.2).to_string(),
            r#"force_limit at tick 1: {"by":"station","force_limit_n":0.2}"#
        );
        let said = Occurrence::resumed(9, &id("student"));
        assert_eq!(said.data["by"], "-student");
        assert_eq!(said.kind, RESUMED);
        assert_eq!(Occurrence::resumed(9, &By::Student).data["by"], "student");
    }
}
