//! Command line of `sulcus-sessions`: arguments, output, exit codes.

mod compared;
pub mod drawn;
mod export;
mod grade;
mod info;
pub mod inputs;
mod parallel;
mod picture;
pub mod print;
mod replay;
mod review;
pub mod sibling;
mod viewers;
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
    after_help = "Exit code: 0 success, 1 a finding (a replay differs, an invalid signature, changed channels for viewers, a damaged file, no grade), 2 wrong usage, bad input, or an output that cannot be written. `info` accepts a recording that was cut off with exit code 0; `replay` reports it as a finding."
)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Print the content of recordings: duration, scene, exercise, station, size, ending, signature
    #[command(
        after_long_help = "A recording that was cut off (kill -9, power loss, full disk) is read as far as it goes. --recover writes a new file of every whole chunk, also behind damage, with an index, a proper end, and a note of the missing part. Between the gaps the signatures hold, and a replay continues from the first snapshot behind each gap. A session with a gap or without its end cannot be graded.\n\nExamples:\n  sulcus-sessions info session.mcap\n  sulcus-sessions info recordings/*.mcap --json | tail -n 1 | jq .files[].ending\n  sulcus-sessions info torn.mcap --recover whole.mcap"
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
    /// Draw an instant as the student's screen shows it; starts the program `sulcus-client`
    #[command(
        after_long_help = picture::EXAMPLES
    )]
    Picture(picture::PictureArgs),
    /// Export recordings as tables and meshes for other programs
    #[command(
        long_about = "Writes recorded sessions as tables and meshes for other programs.\n\nTicks and meshes come from a replay, so they are exact. events.csv has the recorded log. A recording with an invalid signature, or one that was cut off, causes a warning and exit code 1. ticks.csv has a line for each tick: poses, wrenches raw and sent, status, pocket depth and floor force, with units in the names of the columns. devices.csv has a line for each pose that a tick used: number, device time, age, and the wrench that the hand felt. Meshes are those of the display, deformed like the tissue; meshes/frames.csv lists file, part and time.",
        after_long_help = "Examples:\n  sulcus-sessions export session.mcap --out session\n  sulcus-sessions export session.mcap --out session --csv --every-ticks 10\n  sulcus-sessions export session.mcap --out session --meshes obj --at 12.5 --at 13"
    )]
    Export(export::ExportArgs),
    /// Grade recordings from their replay: table, JSON, CSV, pages with a periodontal chart
    #[command(long_about = grade::LONG_ABOUT, after_long_help = grade::EXAMPLES)]
    Grade(grade::GradeArgs),
    /// Make the channels for viewers of a recording that has none, or compare them with the signed hash
    #[command(
        long_about = viewers::ABOUT,
        after_long_help = viewers::EXAMPLES
    )]
    Viewers(viewers::ViewersArgs),
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
    let json = match &cli.command {
        Command::Info(args) => args.json,
        Command::Replay(args) => args.json,
        // The child process prints its own objects and errors.
        Command::Review(_) | Command::Picture(_) => false,
        Command::Export(args) => args.json,
        Command::Grade(args) => args.json,
        Command::Viewers(args) => args.json,
    };
    let outcome = match cli.command {
        Command::Export(args) => Ok(export::run(&args)),
        Command::Review(args) => review::run(&args),
        Command::Picture(args) => picture::run(&args),
        Command::Info(args) => info::run(&args),
        Command::Replay(args) => replay::run(&args),
        Command::Grade(args) => grade::run(&args),
        Command::Viewers(args) => viewers::run(&args),
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
