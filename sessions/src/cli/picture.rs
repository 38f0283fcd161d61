//! `picture`: starts `sulcus-client picture`, which draws a recorded instant as the student's screen does.

use std::ffi::OsString;
use std::path::PathBuf;
use std::process::{Command, ExitCode};

use anyhow::Context as _;
use clap::Args;
use sulcus_program::PathText;

use super::sibling::find;

#[derive(Args)]
pub(super) struct PictureArgs {
    /// Recording
    recording: PathBuf,
    /// Time in the session, seconds
    #[arg(long, value_name = "S")]
    at: String,
    /// View: overview, front, buccal, lingual, mirror, close-up
    #[arg(long, value_name = "NAME", default_value = "close-up")]
    view: String,
    /// FDI number of the tooth in the middle of the views buccal and lingual
    #[arg(long, value_name = "FDI")]
    tooth: Option<String>,
    /// Turn of the patient's head to the patient's left, degrees, -45 to 45
    #[arg(long, value_name = "DEG", allow_hyphen_values = true)]
    head_turn: Option<String>,
    /// Tilt of the patient's head with the chin upwards, degrees, -30 to 30
    #[arg(long, value_name = "DEG", allow_hyphen_values = true)]
    head_tilt: Option<String>,
    /// Size of the picture, pixels
    #[arg(long, value_name = "WxH", default_value = "1280x720")]
    size: String,
    /// File of the picture
    #[arg(long, value_name = "FILE.png")]
    out: PathBuf,
}

pub(super) fn run(args: &PictureArgs) -> anyhow::Result<ExitCode> {
    let program = find(
        "sulcus-client",
        "cargo build --release -p sulcus-client --features view",
    )?;
    let mut command = Command::new(&program);
    command
        .arg("picture")
        .arg("--recording")
        .arg(&args.recording);
    let named = [
        ("--at", &args.at),
        ("--view", &args.view),
        ("--size", &args.size),
    ];
    let given = [
        ("--tooth", &args.tooth),
        ("--head-turn", &args.head_turn),
        ("--head-tilt", &args.head_tilt),
    ];
    let given = given
        .into_iter()
        .filter_map(|(name, value)| Some((name, value.as_ref()?)));
    for (name, value) in named.into_iter().chain(given) {
        // Joined by the sign, so that a value cannot become an option.
        let mut argument = OsString::from(format!("{name}="));
        argument.push(value);
        command.arg(argument);
    }
    command.arg("--out").arg(&args.out);
    let ended = command
        .status()
        .with_context(|| format!("{}: cannot be started", program.shown()))?;
    let code = ended.code().and_then(|code| u8::try_from(code).ok());
    let code = code.with_context(|| format!("{}: ended by {ended}", program.shown()))?;
    Ok(ExitCode::from(code))
}
