//! The command line: what is asked, what is printed, and the exit code.

mod compared;
mod export;
mod grade;
mod info;
pub mod inputs;
mod parallel;
pub mod print;
mod replay;
mod review;
pub mod sibling;
pub mod written;

use std::ffi::OsString;
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use serde_json::json;

use print::complain;
use sulcus_program::{output, say};

/// Inspect, replay, grade, review and export recorded sessions.
#[derive(Parser)]
#[command(
    name = "sulcus-sessions",
    version,
    after_help = "Exit code: 0 all is well, 1 a finding (a replay differs by more than a former version of the format explains, a signature does not hold, what viewers read was changed, a file is damaged or cut off: not gradable; info takes one that was cut off as it is), 2 usage or bad input."
)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Print the content of recordings: duration, scene, exercise, station, size, ending, signature
    #[command(
        after_long_help = "A recording that was cut off (kill -9, power loss, full disk) is read as far as it goes; --recover makes a whole file of it and of one that is damaged: every whole chunk, behind the damage too, an index, a proper end, and a note of what is missing. Between the gaps its signatures hold, and a replay begins again with the first snapshot behind each gap; a session with a gap or without its end cannot be graded.\n\nExamples:\n  sulcus-sessions info session.mcap\n  sulcus-sessions info recordings/*.mcap --json | tail -n 1 | jq .files[].ending\n  sulcus-sessions info torn.mcap --recover whole.mcap"
    )]
    Info(info::InfoArgs),
    /// Replay recordings and compare every state, wrench, snapshot and signature
    #[command(
        long_about = replay::ABOUT,
        after_long_help = replay::EXAMPLES
    )]
    Replay(replay::ReplayArgs),
    /// Show a session in the Rerun viewer; starts the program `sulcus-review`
    Review(review::ReviewArgs),
    /// Export recordings as tables and meshes for other programs
    #[command(
        long_about = "Writes recorded sessions as tables and meshes for other programs.\n\nTicks and meshes come from a replay, so they are exact; events.csv holds the recorded log, and a recording whose signature does not hold or that was cut off is said to be so (exit code 1). ticks.csv has a line for each tick: poses, wrenches raw and sent, status, pocket depth and floor force, with units in the names of the columns. Meshes are those that people see, deformed as the tissue was; meshes/frames.csv says which file shows which part when.",
        after_long_help = "Examples:\n  sulcus-sessions export session.mcap --out session\n  sulcus-sessions export session.mcap --out session --csv --every-ticks 10\n  sulcus-sessions export session.mcap --out session --meshes obj --at 12.5 --at 13"
    )]
    Export(export::ExportArgs),
    /// Grade recordings from their replay: table, JSON, CSV, pages with a periodontal chart
    #[command(long_about = grade::LONG_ABOUT, after_long_help = grade::EXAMPLES)]
    Grade(grade::GradeArgs),
}

/// Runs the program with these arguments, the first of which is its name.
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
    let json = match &cli.command {
        Command::Info(args) => args.json,
        Command::Replay(args) => args.json,
        // The child process prints its own objects and errors.
        Command::Review(_) => false,
        Command::Export(args) => args.json,
        Command::Grade(args) => args.json,
    };
    let outcome = match cli.command {
        Command::Export(args) => Ok(export::run(&args)),
        Command::Review(args) => review::run(&args),
        Command::Info(args) => info::run(&args),
        Command::Replay(args) => replay::run(&args),
        Command::Grade(args) => grade::run(&args),
    };
    let code = outcome.unwrap_or_else(|error| {
        if json {
            say!("{}", json!({ "error": crate::sentence(&error) }));
        }
        complain(&error);
        ExitCode::from(2)
    });
    output::settle(code)
}
