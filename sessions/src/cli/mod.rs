//! The command line: what is asked, what is printed, and the exit code.

mod grade;
mod info;
mod print;
mod replay;

use std::ffi::OsString;
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use serde_json::json;

use print::{complain, for_each};

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
        after_long_help = "Examples:\n  sulcus-sessions info session.mcap\n  sulcus-sessions info recordings/*.mcap --json | tail -n 1 | jq .files[].ending"
    )]
    Info(info::InfoArgs),
    /// Runs recorded sessions again and compares every state, wrench, snapshot and signature
    #[command(
        long_about = "Runs recorded sessions again and compares every state, wrench, snapshot and signature.\n\nA recording holds its compiled scene and the input of every tick, so that the same program gives the same bits. The first tick that differs is named. Signatures show whether the recording is what the station recorded: without --signer the key is taken from the recording itself, so compare its fingerprint.",
        after_long_help = "Examples:\n  sulcus-sessions replay session.mcap\n  sulcus-sessions replay session.mcap --signer station.pub --json\n  sulcus-sessions replay session.mcap --solver clarabel    (bits differ; shows by how many newtons)\n  sulcus-sessions replay recordings/*.mcap --audit"
    )]
    Replay(replay::ReplayArgs),
    /// Grades recorded sessions from their replay: table, JSON, CSV, pages with a periodontal chart
    #[command(long_about = grade::LONG_ABOUT, after_long_help = grade::EXAMPLES)]
    Grade(grade::GradeArgs),
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
        Command::Grade(args) => args.json,
    };
    let outcome = match cli.command {
        Command::Info(args) => for_each(&args.files, args.json, "bytes", info::info_of),
        Command::Replay(args) => replay::options(&args).and_then(|options| {
            for_each(&args.files, args.json, "ticks", |path| {
                replay::replay_of(path, &options)
            })
        }),
        Command::Grade(args) => grade::run(&args),
    };
    outcome.unwrap_or_else(|error| {
        if json {
            println!("{}", json!({ "error": format!("{error:#}") }));
        }
        complain(&error);
        ExitCode::from(2)
    })
}
