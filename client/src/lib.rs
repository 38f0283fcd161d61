//! The program of a student's station: `sulcus-client`, with the commands `run` and `demo`.
//!
//! [`join`] joins a server with a haptic device and performs one session on a `sulcus-connection`. [`typed`] reads
//! called findings from standard input. `sulcus-demo` has the simulated operator, its exercises and the command `demo`.

#![cfg_attr(not(test), warn(clippy::print_stdout, clippy::print_stderr))]

pub mod cli;
pub mod join;
#[cfg(feature = "view")]
pub mod picture;
pub mod typed;

use std::io::IsTerminal;
use std::process::ExitCode;

use clap::Parser;
use sulcus_program::{output, say, tell};

/// Runs the program with the arguments of the process and returns its exit code.
pub fn run() -> ExitCode {
    sulcus_program::begin();
    let cli = match cli::Cli::try_parse() {
        Ok(cli) => cli,
        Err(message) => return output::usage(message.print(), message.use_stderr()),
    };
    tracing_subscriber::fmt()
        .with_env_filter(
            tracing_subscriber::EnvFilter::try_from_env("SULCUS_LOG")
                .unwrap_or_else(|_| "warn".into()),
        )
        .with_writer(|| output::Log)
        .with_ansi(std::io::stderr().is_terminal())
        .without_time()
        .init();
    sulcus_connection::interrupt::listen();
    let (done, json) = match cli.command {
        None => (
            sulcus_demo::run(&sulcus_demo::args::DemoArgs::default()),
            false,
        ),
        Some(cli::Command::Demo(args)) => (sulcus_demo::run(&args), args.json),
        Some(cli::Command::Run(args)) => (join::run(&args), args.json),
        Some(cli::Command::Swarm(args)) => (sulcus_demo::swarm::run(&args), args.json),
        Some(cli::Command::Picture(args)) => (picture(&args), false),
    };
    let code = done.unwrap_or_else(|error| {
        let text = sulcus_sessions::sentence(&error);
        if json {
            say!("{}", serde_json::json!({ "error": text }));
        }
        tell!("error: {text}");
        2
    });
    output::settle(code.into())
}

#[cfg(feature = "view")]
fn picture(args: &cli::PictureArgs) -> anyhow::Result<u8> {
    picture::run(args)
}

#[cfg(not(feature = "view"))]
fn picture(_: &cli::PictureArgs) -> anyhow::Result<u8> {
    anyhow::bail!(
        "this build draws no pictures; build with `cargo build --release -p sulcus-client --features view`"
    )
}
