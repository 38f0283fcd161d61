//! Identity of a build of the program.

use std::fmt;

use serde::Serialize;

use crate::record::header::SessionHeader;

/// Version, build, target and tick of a program. Equal programs give the same bits. Different programs may, and a
/// replay shows whether the bits differ.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Program {
    /// Version of the program.
    pub version: String,
    /// `debug` or `release`.
    pub build: String,
    /// Processor and system, such as `x86_64-linux`.
    pub target: String,
    /// First hexadecimal digits of a hash over the sources of the tick; empty in recordings from before 24 November
    /// 2026.
    pub tick_source: String,
}

impl Program {
    /// Program that a header names.
    pub fn of(header: &SessionHeader) -> Self {
        Self {
            version: header.program_version.clone(),
            build: header.build.clone(),
            target: header.target.clone(),
            tick_source: header.tick_source.clone(),
        }
    }

    /// The running program.
    pub fn this() -> Self {
        Self::of(&SessionHeader::new(Vec::new()))
    }
}

impl fmt::Display for Program {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Text of a header may contain control characters of a terminal.
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
