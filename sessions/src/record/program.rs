//! Which build of the program did something.

use std::fmt;

use serde::Serialize;

use crate::record::header::SessionHeader;

/// Version, build, target and tick of a program. Two that are equal give the same bits; two that differ should, and whether
/// they did is what a replay shows.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Program {
    /// Version.
    pub version: String,
    /// `debug` or `release`.
    pub build: String,
    /// Processor and system, such as `x86_64-linux`.
    pub target: String,
    /// Beginning of a hash over the tick's sources; empty where the recording is of before it was said.
    pub tick_source: String,
}

impl Program {
    /// The one that a header names.
    pub fn of(header: &SessionHeader) -> Self {
        Self {
            version: header.program_version.clone(),
            build: header.build.clone(),
            target: header.target.clone(),
            tick_source: header.tick_source.clone(),
        }
    }

    /// This one.
    pub fn this() -> Self {
        Self::of(&SessionHeader::new(Vec::new()))
    }
}

impl fmt::Display for Program {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // A header's text may hold anything, also what a terminal obeys.
        let [version, build, target, tick] =
            [&self.version, &self.build, &self.target, &self.tick_source]
                .map(|text| text.escape_debug());
        write!(f, "{version} {build} {target}")?;
        if self.tick_source.is_empty() {
            return Ok(());
        }
        write!(f, " (tick {tick})")
    }
}
