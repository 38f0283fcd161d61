//! The command line of `sulcus-server`: what is asked, and the exit code.

use std::ffi::OsString;
use std::io::IsTerminal;
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use tracing_subscriber::EnvFilter;

use crate::commands::{patient, report, scene, serve, tissue, tree};

/// Simulates a mouth at 1 kHz for the station that connects, and compiles what is simulated.
#[derive(Parser)]
#[command(
    name = "sulcus-server",
    version,
    after_help = "Exit code: 0 all is well, 1 a finding (a recording is not complete), 2 usage or bad input.\nLogs go to standard error; SULCUS_LOG=debug says more."
)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Serve(Box<serve::ServeArgs>),
    Scene(scene::SceneArgs),
    Tree(tree::TreeArgs),
    Patient(patient::PatientArgs),
    Tissue(tissue::TissueArgs),
    Report(report::ReportArgs),
}

/// An error and its causes as one sentence; a cause with which the outer error already ends is left
/// out.
fn sentence(error: &anyhow::Error) -> String {
    error
        .chain()
        .map(ToString::to_string)
        .fold(String::new(), |told, cause| match told.is_empty() {
            true => cause,
            false if told.ends_with(&cause) => told,
            false => format!("{told}: {cause}"),
        })
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
    let filter = EnvFilter::try_from_env("SULCUS_LOG").unwrap_or_else(|_| EnvFilter::new("info"));
    // A program that embeds this one may have set its own.
    let _ = tracing_subscriber::fmt()
        .with_env_filter(filter)
        .with_writer(std::io::stderr)
        // No colour codes in a file or a journal.
        .with_ansi(std::io::stderr().is_terminal())
        .try_init();
    let outcome = match cli.command {
        Command::Serve(args) => serve::run(&args),
        Command::Scene(args) => scene::run(&args),
        Command::Tree(args) => tree::run(&args),
        Command::Patient(args) => patient::run(&args),
        Command::Tissue(args) => tissue::run(&args),
        Command::Report(args) => report::run(&args),
    };
    match outcome {
        Ok(code) => ExitCode::from(code),
        Err(error) => {
            eprintln!("error: {}", sentence(&error));
            ExitCode::from(2)
        }
    }
}

#[cfg(test)]
mod tests {
    use anyhow::{Context, anyhow};
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn the_command_line_is_sound() {
        Cli::command().debug_assert();
    }

    #[test]
    fn no_cause_is_told_twice() {
        let error = Err::<(), _>(anyhow!("no such file"))
            .context("cannot read it: no such file")
            .context("a.toml");
        assert_eq!(
            sentence(&error.expect_err("an error")),
            "a.toml: cannot read it: no such file"
        );
        // What only happens to stand somewhere before is not the cause told.
        let error = Err::<(), _>(anyhow!("disk"))
            .context("disk.toml")
            .expect_err("an error");
        assert_eq!(sentence(&error), "disk.toml: disk");
    }
}
