//! Devices, the link, the demo.
//!
//! The client belongs to a student: once per millisecond a [`device::Device`] takes a wrench and gives
//! poses, and the [`link`] carries both over QUIC. The [`demo`] is a whole session with a simulated
//! operator against an embedded server; [`join`] joins a server elsewhere.

pub mod cli;
pub mod demo;
pub mod device;
pub mod exercise;
pub mod join;
pub mod link;
pub mod perform;
pub mod progress;
pub mod stats;

mod device_loop;

use clap::Parser;

/// Runs the program with the process's arguments; returns its exit code.
pub fn run() -> u8 {
    let cli = cli::Cli::parse();
    tracing_subscriber::fmt()
        .with_env_filter(
            tracing_subscriber::EnvFilter::try_from_env("SULCUS_LOG")
                .unwrap_or_else(|_| "warn".into()),
        )
        .with_writer(std::io::stderr)
        .without_time()
        .init();
    let done = match cli.command {
        None => demo::run(&cli::DemoArgs::default()),
        Some(cli::Command::Demo(args)) => demo::run(&args),
        Some(cli::Command::Run(args)) => join::run(&args),
    };
    done.unwrap_or_else(|error| {
        eprintln!("error: {error:#}");
        2
    })
}
