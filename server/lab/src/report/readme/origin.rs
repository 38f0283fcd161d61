//! Origin of the numbers of a report: machine, program, commit and date.

use std::path::Path;
use std::process::Command;
use std::time::{SystemTime, UNIX_EPOCH};

use sulcus_sessions::Program;
use sulcus_sessions::pages::date;

use crate::report::Machine;

/// Digits of a commit.
const DIGITS: &str = "--short=12";

/// Commit, sources and date, taken before the first measurement.
pub(super) struct Origin {
    /// Commit of the checkout that holds the document; `None` outside of a checkout and without `git`.
    commit: Option<String>,
    /// Hash of the tick's sources in this program.
    tick_source: String,
    /// Date, UTC.
    date: String,
}

impl Origin {
    /// Origin of a report that begins now, for a document in `folder`.
    pub(super) fn now(folder: &Path) -> Self {
        let since = SystemTime::now().duration_since(UNIX_EPOCH);
        let ns = since.map_or(0, |since| since.as_nanos());
        let moment = date(u64::try_from(ns).unwrap_or(u64::MAX));
        Self {
            commit: commit(folder),
            tick_source: Program::this().tick_source,
            date: moment.split(' ').next().unwrap_or_default().to_owned(),
        }
    }

    /// Origin as a list, for the head of the marked part.
    pub(super) fn markdown(&self, machine: &Machine, took_s: f64) -> String {
        format!(
            "- Machine: {}, {} logical cores, {:.1} GiB, {}; load {:.1} at the end of the report\n\
             - Program: {} build, sources of the tick `{}`; commit {}\n\
             - Date: {}; duration of the report {:.0} min\n",
            machine.processor,
            machine.logical_cores,
            machine.memory_gib,
            machine.system,
            machine.load,
            machine.build,
            self.tick_source,
            self.commit.as_deref().unwrap_or("unknown"),
            self.date,
            took_s / 60.0,
        )
    }
}

/// Commit of the checkout around `folder`, and whether its files differ from the commit.
fn commit(folder: &Path) -> Option<String> {
    let git = |arguments: &[&str]| {
        let output = Command::new("git")
            .arg("-C")
            .arg(folder)
            .args(arguments)
            .output()
            .ok()?;
        let text = String::from_utf8(output.stdout).ok()?;
        output.status.success().then(|| text.trim().to_owned())
    };
    let commit = git(&["rev-parse", DIGITS, "HEAD"])?;
    let changed = git(&["status", "--porcelain", "--untracked-files=no"])?;
    Some(match changed.is_empty() {
        true => format!("`{commit}`"),
        false => format!("`{commit}` with uncommitted changes"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_origin_names_machine_commit_sources_and_date() {
        let folder = tempfile::tempdir().expect("a folder");
        let origin = Origin::now(folder.path());
        assert_eq!(origin.commit, None);
        let text = origin.markdown(&Machine::here(), 600.0);
        for part in ["Machine: ", "commit unknown", &origin.tick_source, "10 min"] {
            assert!(text.contains(part), "no {part} in {text}");
        }
        let day: Vec<u32> = origin
            .date
            .split('-')
            .filter_map(|part| part.parse().ok())
            .collect();
        assert!(day.len() == 3 && day[0] >= 2026, "{}", origin.date);
    }
}
