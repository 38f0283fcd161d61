//! The command line of `sulcus-server`: commands and exit codes.

use std::ffi::OsString;
use std::io::IsTerminal;
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use sulcus_program::{output, tell};
use tracing_subscriber::EnvFilter;

#[cfg(feature = "console")]
use crate::commands::person;
use crate::commands::{backup, case, certificate, class, init, plan, rollover, token};
use crate::serve;

/// Server of the Sulcus simulator: simulates a mouth, serves one client at a time, records and signs every session.
#[derive(Parser)]
#[command(
    name = "sulcus-server",
    version,
    after_help = "Exit codes: 0 success, 1 a finding (serve: a recording is not complete), 2 wrong usage, bad input, a busy port, or an\noutput that cannot be written.\nLogs go to standard error. SULCUS_LOG=debug prints more; the default is SULCUS_LOG=info."
)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Init(init::InitArgs),
    Serve(Box<serve::ServeArgs>),
    Token(token::TokenArgs),
    Certificate(certificate::CertificateArgs),
    Plan(plan::PlanArgs),
    Case(case::CaseArgs),
    Class(class::ClassArgs),
    Backup(backup::BackupArgs),
    Restore(backup::RestoreArgs),
    Rollover(rollover::RolloverArgs),
    #[cfg(feature = "console")]
    Person(person::PersonArgs),
    #[cfg(feature = "lab")]
    #[command(flatten)]
    Lab(sulcus_lab::commands::LabCommand),
}

/// Runs the program with `args` and returns its exit code. The first argument is the name of the program.
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
    let filter = EnvFilter::try_from_env("SULCUS_LOG").unwrap_or_else(|_| EnvFilter::new("info"));
    // A program that embeds this one may have set its own subscriber.
    let _ = tracing_subscriber::fmt()
        .with_env_filter(filter)
        .with_writer(|| output::Log)
        // No colour codes in a file or a journal.
        .with_ansi(std::io::stderr().is_terminal())
        .try_init();
    let outcome = match cli.command {
        Command::Init(args) => init::run(&args),
        Command::Serve(args) => serve::run(&args),
        Command::Token(args) => token::run(&args),
        Command::Certificate(args) => certificate::run(&args),
        Command::Plan(args) => plan::run(&args),
        Command::Case(args) => case::run(&args),
        Command::Class(args) => class::run(&args),
        Command::Backup(args) => backup::backup(&args),
        Command::Restore(args) => backup::restore(&args),
        Command::Rollover(args) => rollover::run(&args),
        #[cfg(feature = "console")]
        Command::Person(args) => person::run(&args),
        #[cfg(feature = "lab")]
        Command::Lab(command) => sulcus_lab::commands::run(&command),
    };
    let code = outcome.unwrap_or_else(|error| {
        tell!("error: {}", sulcus_sessions::sentence(&error));
        2
    });
    output::settle(code.into())
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn the_command_line_is_sound() {
        Cli::command().debug_assert();
    }

    #[cfg(feature = "lab")]
    /// A comment on a subcommand's variant replaces its long help. Once such a comment hid the list of files.
    #[test]
    fn the_long_help_of_tissue_says_what_a_folder_holds() {
        for action in ["fit", "evaluate"] {
            let mut cli = Cli::command();
            let tissue = cli.find_subcommand_mut("tissue").expect("tissue");
            let command = tissue.find_subcommand_mut(action).expect(action);
            let help = command.render_long_help().to_string();
            assert!(help.contains("nodes.csv"), "{help}");
        }
    }
}
