//! Revisions of a plan: which change, when and by whom.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::state::date::minute;

/// Longest name of an author, characters.
const LONGEST_BY: usize = 64;

/// A state of a plan, and the change that led to it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Revision {
    /// Number of the state, from 1 for the plan of the file or the command line.
    pub number: u32,
    /// Time of the change, nanoseconds since 1970; 0 for the first state.
    pub changed_unix_ns: u64,
    /// Author: the id of a token, `shell (uid N)`, or `file` for the first state.
    pub by: String,
    /// Names of the parts that the change gave other values; empty for the first state.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub fields: Vec<String>,
}

impl Revision {
    /// First state of a plan.
    pub fn first() -> Self {
        Self {
            number: 1,
            changed_unix_ns: 0,
            by: "file".into(),
            fields: Vec::new(),
        }
    }

    /// State after this one.
    pub fn next(&self, by: &str, fields: Vec<String>, now_ns: u64) -> Self {
        let plain = by.chars().filter(|c| !c.is_control());
        Self {
            number: self.number.saturating_add(1),
            changed_unix_ns: now_ns,
            by: plain.take(LONGEST_BY).collect(),
            fields,
        }
    }
}

impl fmt::Display for Revision {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.number <= 1 {
            return f.write_str("revision 1, as first set");
        }
        write!(
            f,
            "revision {}, changed on {} by {}",
            self.number,
            minute(self.changed_unix_ns / 1_000_000_000),
            self.by
        )?;
        if !self.fields.is_empty() {
            write!(f, ": {}", self.fields.join(", "))?;
        }
        Ok(())
    }
}
