//! The command line: what is asked, what is printed, and the exit code.

mod compared;
mod info;
mod parallel;
mod print;
mod replay;

use std::ffi::OsString;
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use serde_json::json;

use print::complain;

/// Looks at recorded sessions: what they are, and whether they are what happened.
#[derive(Parser)]
#[command(
    name = "sulcus-sessions",
    version,
    after_help = "Exit code: 0 all is well, 1 a finding (a replay differs, a signature does not hold, a file is damaged or cut off: not gradable), 2 usage or bad input."
)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Says what recordings hold: duration, scene, exercise, station, size, ending, signature
    #[command(
        after_long_help = "A recording that was cut off (kill -9, power loss, full disk) is read as far as it goes; --recover makes a whole file of it: every whole chunk, an index, a proper end, and a note that it was recovered and what is missing. Its signatures hold as far as they went; a session without its end cannot be graded.\n\nExamples:\n  sulcus-sessions info session.mcap\n  sulcus-sessions info recordings/*.mcap --json | tail -n 1 | jq .files[].ending\n  sulcus-sessions info torn.mcap --recover whole.mcap"
    )]
    Info(info::InfoArgs),
    /// Runs recorded sessions again and compares every state, wrench, snapshot and signature
    #[command(
        long_about = replay::ABOUT,
        after_long_help = replay::EXAMPLES
    )]
    Replay(replay::ReplayArgs),
}

/// Runs the program with these arguments, the first of which is its name.
pub fn run<I, T>(args: I) -> ExitCode
where
    I: IntoIterator<Item = T>,
    T: Into<OsString> + Clone,
{
    let cli = match Cli::try_parse_from(args) {
        Ok(cli) => cli,
        Err(message) => {
            // Help and version go to standard output with code 0, mistakes to standard error.
            let _ = message.print();
            return ExitCode::from(if message.use_stderr() { 2 } else { 0 });
        }
    };
    let json = match &cli.command {
        Command::Info(args) => args.json,
        Command::Replay(args) => args.json,
    };
    let outcome = match cli.command {
        Command::Info(args) => info::run(&args),
        Command::Replay(args) => replay::run(&args),
    };
    outcome.unwrap_or_else(|error| {
        if json {
            println!("{}", json!({ "error": format!("{error:#}") }));
        }
        complain(&error);
        ExitCode::from(2)
    })
}
