//! Command line of `sulcus-review`.

mod live;
mod review;
mod tree;

use std::ffi::OsString;
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use serde_json::json;
use sulcus_program::{output, say};
use sulcus_sessions::cli::print::complain;
use sulcus_sessions::sentence;

/// Replays a recorded session and writes it for the Rerun viewer: mouth, tools, forces, plots, log.
#[derive(Parser)]
#[command(
    name = "sulcus-review",
    version,
    long_about = "Replays a recorded session and writes it as a file for the Rerun viewer, laid out for review: the mouth from outside, the pocket close up, the tongue as the operator sees it, force and depth over time, the log.\n\nOpens the viewer if `rerun` of the right version is on PATH. A recording whose replay differs is refused. A recording of a former version of the format is shown if its replay stays close.",
    after_long_help = "Examples:\n  sulcus-review session.mcap\n  sulcus-review session.mcap --from 20 --to 30 --out part.rrd --no-open\n  sulcus-review session.mcap --no-open --json | tail -n 1 | jq .rows",
    after_help = "Exit code: 0 success, 1 a finding (the replay differs, or the recording is unsound), 2 wrong usage, bad input, or an output that cannot be written.",
    args_conflicts_with_subcommands = true,
    subcommand_negates_reqs = true
)]
struct Cli {
    #[command(flatten)]
    review: Option<review::ReviewArgs>,
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Subcommand)]
enum Command {
    /// Writes a sphere tree for the viewer; `sulcus-server tree --out` calls this
    Tree(tree::TreeArgs),
    /// Draws a running session; the console of `sulcus-server serve` calls this. Standard input has the scene and the
    /// state of the tools, standard output gets parts for the web viewer
    Live,
    /// Writes the files of the web viewer to standard output; the console of `sulcus-server serve` calls this
    Viewer,
}

/// Runs the program with these arguments. The first argument is the program's name.
pub fn run<I, T>(args: I) -> ExitCode
where
    I: IntoIterator<Item = T>,
    T: Into<OsString> + Clone,
{
    sulcus_program::begin();
    let cli = match Cli::try_parse_from(args) {
        Ok(cli) => cli,
        Err(message) => return output::usage(message.print(), message.use_stderr()),
    };
    let (json, outcome) = match (&cli.command, &cli.review) {
        (Some(Command::Tree(args)), _) => (false, tree::run(args)),
        (Some(Command::Live), _) => (false, live::run()),
        (Some(Command::Viewer), _) => (false, live::viewer()),
        (None, Some(args)) => (args.json, review::run(args)),
        (None, None) => (
            false,
            Err(anyhow::anyhow!("FILE is missing, expected a recording")),
        ),
    };
    let code = outcome.unwrap_or_else(|error| {
        if json {
            say!("{}", json!({ "error": sentence(&error) }));
        }
        complain(&error);
        ExitCode::from(2)
    });
    output::settle(code)
}
