//! Devices, the link, the demo.
//!
//! The client belongs to a student: once per millisecond a [`device::Device`] takes a wrench and gives
//! poses, and the [`link`] carries both over QUIC. The [`demo`] is a whole session with a simulated
//! operator against an embedded server; [`join`] joins a server elsewhere.

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
        .with_ansi(std::io::stderr().is_terminal())
        .without_time()
        .init();
    interrupt::listen();
    let (done, json) = match cli.command {
        None => (demo::run(&cli::DemoArgs::default()), false),
        Some(cli::Command::Demo(args)) => (demo::run(&args), args.json),
        Some(cli::Command::Run(args)) => (join::run(&args), args.json),
    };
    done.unwrap_or_else(|error| {
        let text = sulcus_sessions::sentence(&error);
        if json {
            println!("{}", serde_json::json!({ "error": text }));
        }
        eprintln!("error: {text}");
        2
    })
}
