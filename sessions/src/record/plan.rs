//! Plan of a session, as far as a grade and an examiner need it.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::record::sane::{no_less_than_zero, text_of};
use crate::record::utc::utc;

/// Facts of the plan by which a station ran the session.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlanFacts {
    /// Name of the plan.
    pub name: String,
    /// Revision of the plan, as text.
    pub revision: String,
    /// Time for which a session waits for a student who is gone, seconds.
    pub resume_within_s: f64,
    /// Whether the session's clock runs while the student is gone.
    pub clock_runs_in_gaps: bool,
    /// Last change of the plan before the session; `None` for a plan that nobody changed since it was made.
    pub changed: Option<PlanChange>,
}

/// Change of a plan.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlanChange {
    /// Time of the change, nanoseconds since the Unix epoch.
    pub unix_ns: u64,
    /// Opaque id of the token that changed the plan, or `station`.
    pub by: String,
}

impl PlanFacts {
    /// Checks every value: field, value found, value expected.
    pub(crate) fn check(&self) -> Result<(), String> {
        text_of("plan name", &self.name)?;
        text_of("plan revision", &self.revision)?;
        no_less_than_zero("plan resume_within_s", self.resume_within_s)?;
        self.changed
            .as_ref()
            .map_or(Ok(()), |changed| text_of("plan changed by", &changed.by))
    }
}

impl fmt::Display for PlanFacts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}, revision {}; a student may return within {} s, and the clock {} meanwhile",
            self.name.escape_debug(),
            self.revision.escape_debug(),
            self.resume_within_s,
            if self.clock_runs_in_gaps {
                "runs"
            } else {
                "stops"
            }
        )?;
        if let Some(PlanChange { unix_ns, by }) = &self.changed {
            let at = utc(*unix_ns);
            write!(f, "; changed at {at} by {}", by.escape_debug())?;
        }
        Ok(())
    }
}
