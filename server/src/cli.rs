//! The command line of `sulcus-server`: what is asked, and the exit code.

use std::ffi::OsString;
use std::io::IsTerminal;
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use sulcus_program::{output, tell};
use tracing_subscriber::EnvFilter;

use crate::serve;

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
    #[cfg(feature = "lab")]
    #[command(flatten)]
    Lab(sulcus_lab::commands::LabCommand),
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
    let filter = EnvFilter::try_from_env("SULCUS_LOG").unwrap_or_else(|_| EnvFilter::new("info"));
    // A program that embeds this one may have set its own.
    let _ = tracing_subscriber::fmt()
        .with_env_filter(filter)
        .with_writer(|| output::Log)
        // No colour codes in a file or a journal.
        .with_ansi(std::io::stderr().is_terminal())
        .try_init();
    let outcome = match cli.command {
        Command::Serve(args) => serve::run(&args),
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
    /// A comment on a subcommand's variant had taken the place of its long help.
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
