//! Devices, the link, the demo.
//!
//! The client belongs to a student: once per millisecond a [`sulcus_haptics::Device`] takes a wrench and gives
//! poses, and the [`link`] carries both over QUIC. The [`demo`] is a whole session with a simulated
//! operator against an embedded server; [`join`] joins a server elsewhere.

#![cfg_attr(not(test), warn(clippy::print_stdout, clippy::print_stderr))]

pub mod calls;
pub mod cli;
pub mod demo;
pub mod device;
pub mod exercise;
pub mod interrupt;
pub mod join;
pub mod link;
pub mod perform;
pub mod progress;
pub mod stats;
pub mod typed;

mod device_loop;

use std::io::IsTerminal;
use std::process::ExitCode;

use clap::Parser;
use sulcus_program::{output, say, tell};

/// Runs the program with the process's arguments.
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
    interrupt::listen();
    let (done, json) = match cli.command {
        None => (demo::run(&cli::DemoArgs::default()), false),
        Some(cli::Command::Demo(args)) => (demo::run(&args), args.json),
        Some(cli::Command::Run(args)) => (join::run(&args), args.json),
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
