//! Check before the start of a server: what is missing, in sentences, with what to do.
//!
//! The check changes nothing that a start would not change: it binds the port and releases it, writes a file into the
//! folder of recordings and removes it, and compiles the scenes of all plans into the cache.

mod disk;
mod plans;
mod state;
mod system;

use std::path::PathBuf;

use serde::Serialize;
use serde_json::json;
use sulcus_program::say;
use sulcus_sessions::ViewersPolicy;

use crate::plan::Station;

/// Weight of a finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Level {
    /// Fit for a lesson.
    Ok,
    /// The server starts, and something is worse than it could be.
    Warning,
    /// The server does not start, or a lesson will fail.
    Problem,
}

/// Result of the check for a part of the server.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// Part of the server, such as `port`.
    pub subject: &'static str,
    /// Weight.
    pub level: Level,
    /// Sentence with the state found.
    pub text: String,
    /// Action that helps; empty for [`Level::Ok`].
    pub advice: String,
}

impl Finding {
    fn ok(subject: &'static str, text: impl Into<String>) -> Self {
        Self::new(subject, Level::Ok, text, "")
    }

    fn warning(subject: &'static str, text: impl Into<String>, advice: impl Into<String>) -> Self {
        Self::new(subject, Level::Warning, text, advice)
    }

    fn problem(subject: &'static str, text: impl Into<String>, advice: impl Into<String>) -> Self {
        Self::new(subject, Level::Problem, text, advice)
    }

    fn new(
        subject: &'static str,
        level: Level,
        text: impl Into<String>,
        advice: impl Into<String>,
    ) -> Self {
        Self {
            subject,
            level,
            text: text.into(),
            advice: advice.into(),
        }
    }
}

/// Configuration to check: that of `serve`.
#[derive(Clone, Debug, PartialEq)]
pub struct CheckInput {
    /// UDP address to listen on, `ADDRESS:PORT` or `NAME:PORT`.
    pub listen: String,
    /// State folder; `None`: the default one.
    pub state: Option<PathBuf>,
    /// Folder for recordings.
    pub recordings: PathBuf,
    /// Policy of the recordings about the channels for viewers.
    pub viewers: ViewersPolicy,
    /// Bytes that the folder of recordings may have; `None`: no quota.
    pub recordings_quota: Option<u64>,
    /// File of the key that signs recordings; `None`: the key of the state folder.
    pub key: Option<PathBuf>,
    /// Stations with their plans.
    pub stations: Vec<Station>,
    /// Planned hours of each station.
    pub hours: f64,
    /// Whether the server will request real-time scheduling and locked memory.
    pub real_time: bool,
    /// Whether the command line or the environment gives a token besides the stored ones.
    pub has_own_token: bool,
}

/// Checks a configuration on this machine. `progress` gets stages and their share of the whole, 0 to 1.
pub fn check(input: &CheckInput, progress: &dyn Fn(&str, f64)) -> Vec<Finding> {
    let mut findings = vec![system::port(&input.listen)];
    findings.extend(state::state(input));
    if input.real_time {
        findings.push(system::real_time());
        findings.push(system::locked_memory());
    }
    let (plans, loads) = plans::plans(&input.stations, progress);
    findings.extend(plans);
    findings.push(plans::capacity(&loads, input.stations.len()));
    findings.push(disk::recordings(&input.recordings));
    findings.push(disk::room(
        &input.recordings,
        input.viewers,
        &loads,
        input.stations.len(),
        input.hours,
    ));
    findings.push(disk::quota(
        &input.recordings,
        input.recordings_quota,
        input.viewers,
        &loads,
        input.hours,
    ));
    findings
}

/// Prints the findings, as lines or as one JSON object. The exit code is 1 with a problem, else 0.
pub fn report(findings: &[Finding], json: bool) -> u8 {
    let is_ready = findings.iter().all(|one| one.level != Level::Problem);
    if json {
        say!("{}", json!({ "ready": is_ready, "findings": findings }));
        return u8::from(!is_ready);
    }
    for one in findings {
        let level = match one.level {
            Level::Ok => "ok",
            Level::Warning => "warning",
            Level::Problem => "PROBLEM",
        };
        say!("{level:8} {:13} {}", one.subject, one.text);
        if !one.advice.is_empty() {
            say!("{:22} {}", "", one.advice);
        }
    }
    say!(
        "{}",
        if is_ready {
            "The server can start."
        } else {
            "The server is not ready."
        }
    );
    u8::from(!is_ready)
}

/// Number with its noun, such as `2 stations`.
fn number(n: usize, noun: &str) -> String {
    let ending = if n == 1 { "" } else { "s" };
    format!("{n} {noun}{ending}")
}

#[cfg(test)]
mod tests;
