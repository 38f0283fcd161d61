//! `sulcus-server init`: the first start of a server, with questions at a terminal.

mod ask;
mod make;

use std::io::ErrorKind;
use std::path::PathBuf;

use anyhow::Context;
use clap::Args;
use serde_json::json;
use sulcus_program::{PathText, ProgressLines, say, tell};

use super::StateArgs;
use crate::check::{CheckInput, Level, check, report};
use crate::plan::StationsFile;

use ask::Wanted;
use make::Made;

/// Long text of the help.
const ABOUT: &str = "\
Prepare this machine for a class: file of stations, folder of recordings, certificate, tickets, first class.

At a terminal the command asks for every value that no option gives. The check of `serve --check` comes first: port, rights,
disk, exercise, capacity. Nothing that exists is changed: a second call makes what is missing.";

/// Text after the options.
const NOTES: &str = "\
Files in FOLDER:
  stations.toml   address, stations, exercise: for `serve --config`
  tickets.csv     a ticket for each station, for an instructor and an administrator; private
  recordings/     one file a session

Examples:
  sulcus-server init /srv/sulcus                                   with questions
  sulcus-server init /srv/sulcus --stations 12 --exercise probing --class \"Year 4\" --yes
  sulcus-server init /srv/sulcus --stations 12 --yes --check       the check alone, nothing is made

Exit codes: 0 success, 1 the check has found a problem, 2 wrong usage or bad input.";

/// Prepare this machine for a class
#[derive(Clone, Debug, Args)]
#[command(long_about = ABOUT, after_long_help = NOTES)]
pub struct InitArgs {
    /// Folder for the file of stations, tickets and recordings
    #[arg(value_name = "FOLDER", default_value = "sulcus")]
    school: PathBuf,
    #[command(flatten)]
    state: StateArgs,
    /// UDP address of the stations [default: 0.0.0.0:4433]
    #[arg(long, value_name = "ADDR:PORT")]
    listen: Option<String>,
    /// Number of stations, 1 to 64 [default: 1]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..=64))]
    stations: Option<u8>,
    /// Exercise of all stations: bimanual, crown, probing, retraction, or `free` without a grade [default: probing]
    #[arg(long, value_name = "NAME")]
    exercise: Option<String>,
    /// Folder for recordings, for example on another disk [default: FOLDER/recordings]
    #[arg(long, value_name = "DIR", value_parser = absolute)]
    recordings: Option<PathBuf>,
    /// Planned hours of each station, for the forecast of the disk [default: 8]
    #[arg(long, value_name = "H")]
    hours: Option<f64>,
    /// Name of the first class; empty: no class [default: no class]
    #[arg(long, value_name = "NAME")]
    class: Option<String>,
    /// Ask nothing: a value without an option is the default
    #[arg(long)]
    yes: bool,
    /// Check this machine and say what would be made, and make nothing
    #[arg(long)]
    check: bool,
    /// Print one JSON object; asks nothing
    #[arg(long)]
    json: bool,
}

/// Absolute form of a path: a file of stations may lie in another folder.
fn absolute(text: &str) -> Result<PathBuf, std::io::Error> {
    std::path::absolute(text)
}

/// Runs the command. The exit code is 0, or 1 if the check has found a problem; nothing is made then.
///
/// # Errors
/// A value is not valid, or a file cannot be written.
pub fn run(args: &InitArgs) -> anyhow::Result<u8> {
    let file = args.school.join("stations.toml");
    let (text, class) = match std::fs::read_to_string(&file) {
        Ok(text) => {
            tell!("{} is kept", file.shown());
            let class = args.class.as_deref().unwrap_or_default();
            (text, class.trim().to_owned())
        }
        Err(error) if error.kind() == ErrorKind::NotFound => {
            let wanted = Wanted::of(args)?;
            (wanted.text(), wanted.class)
        }
        Err(error) => return Err(error).with_context(|| format!("file {}", file.shown())),
    };
    let stations = StationsFile::parse(&text, &file)?;
    let recordings = stations.recordings.clone();
    let input = CheckInput {
        listen: stations
            .listen
            .clone()
            .unwrap_or_else(|| ask::LISTEN.into()),
        state: args.state.folder.clone(),
        recordings: recordings.unwrap_or_else(|| args.school.join("recordings")),
        viewers: stations.viewers.unwrap_or_default(),
        recordings_quota: stations.recordings_quota,
        key: None,
        stations: stations.stations.clone(),
        hours: stations.hours,
        real_time: true,
        // The tickets are made after the check.
        has_own_token: true,
    };
    let progress = ProgressLines::default();
    let mut findings = check(&input, &|stage, share| progress.report(stage, share));
    // A missing state folder is made here, with tokens.
    findings.retain(|one| one.subject != "state" || one.level != Level::Warning);
    let is_ready = findings.iter().all(|one| one.level != Level::Problem);
    if args.check {
        return Ok(report(&findings, args.json));
    }
    if !is_ready {
        report(&findings, args.json);
        tell!("nothing was made: correct the problems first");
        return Ok(1);
    }
    let made = Made::make(args, &file, &text, &input, &class)?;
    if args.json {
        say!(
            "{}",
            json!({ "ready": is_ready, "findings": findings, "made": made.made, "kept": made.kept })
        );
        return Ok(0);
    }
    report(&findings, false);
    made.told(
        &args.school,
        &file,
        args.state.folder.as_deref(),
        &input.listen,
    );
    Ok(0)
}
