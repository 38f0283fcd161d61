//! The program of a student's station: `sulcus-client`, with the commands `run` and `demo`.
//!
//! [`join`] joins a server with a haptic device and performs one session on a `sulcus-connection`. [`monitor`] shows an
//! instructor all stations in a terminal. [`typed`] reads
//! called findings from standard input. `sulcus-demo` has the simulated operator, its exercises and the command `demo`.

#![cfg_attr(not(test), warn(clippy::print_stdout, clippy::print_stderr))]

#[cfg(feature = "view")]
pub mod bands;
pub mod cli;
pub mod devices;
pub mod join;
pub mod monitor;
#[cfg(feature = "view")]
pub mod picture;
pub mod typed;
#[cfg(feature = "view")]
pub mod view;

use std::io::IsTerminal;
use std::process::ExitCode;

use clap::Parser;
use sulcus_demo::args::DemoArgs;
use sulcus_demo::seat::Seat;
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
        Some(cli::Command::Demo(args)) => (demo(&args), args.session.json),
        Some(cli::Command::Run(args)) => {
            let session = |seat: Seat<'_>| join::run_at(&args.session, seat);
            let json = args.session.json;
            (with_view(&args.view, json, session), json)
        }
        Some(cli::Command::Swarm(args)) => (sulcus_demo::swarm::run(&args), args.json),
        Some(cli::Command::Picture(args)) => (picture(&args), false),
        Some(cli::Command::Bands(args)) => (bands(&args), args.json),
        Some(cli::Command::Monitor(args)) => (monitor::run(&args), args.json),
        Some(cli::Command::Devices(args)) => {
            (devices::run(&args), args.json || args.is_measuring_json())
        }
        Some(cli::Command::Doctor(args)) => (devices::doctor(&args), args.json),
        Some(cli::Command::Lesson(args)) => {
            let session = args.demo().map_err(anyhow::Error::from);
            (session.and_then(|session| demo(&session)), args.json)
        }
    };
    output::settle(ended(done, json).into())
}

/// Exit code of a command. An error is reported.
fn ended(done: anyhow::Result<u8>, json: bool) -> u8 {
    done.unwrap_or_else(|error| {
        let text = sulcus_sessions::sentence(&error);
        if json {
            say!("{}", serde_json::json!({ "error": text }));
        }
        tell!("error: {text}");
        2
    })
}

/// A session in virtual time is over before a window could show it.
fn demo(args: &cli::WithView<DemoArgs>) -> anyhow::Result<u8> {
    if args.view.view && args.session.virtual_time {
        anyhow::bail!(
            "--view shows a session in real time: omit --virtual, or draw one instant with `picture`"
        );
    }
    with_view(&args.view, args.session.json, |seat| {
        sulcus_demo::run_at(&args.session, seat)
    })
}

/// Text about a build without pictures.
#[cfg(not(feature = "view"))]
const NO_VIEW: &str = "this build draws no pictures; build with `cargo build --release -p sulcus-client --features view`";

#[cfg_attr(not(feature = "view"), allow(unused_variables))]
fn with_view(
    args: &cli::ViewArgs,
    json: bool,
    session: impl FnOnce(Seat<'_>) -> anyhow::Result<u8> + Send,
) -> anyhow::Result<u8> {
    if !args.view {
        return session(None);
    }
    #[cfg(feature = "view")]
    return view::beside(args, session, |done| ended(done, json));
    #[cfg(not(feature = "view"))]
    anyhow::bail!(NO_VIEW)
}

#[cfg(feature = "view")]
fn bands(args: &cli::BandsArgs) -> anyhow::Result<u8> {
    bands::run(args)
}

#[cfg(not(feature = "view"))]
fn bands(_: &cli::BandsArgs) -> anyhow::Result<u8> {
    anyhow::bail!(NO_VIEW)
}

#[cfg(feature = "view")]
fn picture(args: &cli::PictureArgs) -> anyhow::Result<u8> {
    picture::run(args)
}

#[cfg(not(feature = "view"))]
fn picture(_: &cli::PictureArgs) -> anyhow::Result<u8> {
    anyhow::bail!(NO_VIEW)
}
