//! `picture`: starts `sulcus-client picture`, which draws recorded instants as the student's screen does.

use std::ffi::OsString;
use std::path::PathBuf;
use std::process::{Command, ExitCode};

use anyhow::Context as _;
use clap::Args;
use sulcus_program::PathText;

use super::sibling::find;

/// Command that builds `sulcus-client` with pictures.
pub(super) const BUILDS_CLIENT: &str = "cargo build --release -p sulcus-client --features view";

pub(super) const EXAMPLES: &str = "Examples:\n  sulcus-sessions picture session.mcap --at 12.3 --view close-up --out picture.png\n  sulcus-sessions picture session.mcap --at 12.3 --at 40 --out '%02d.png'\n  sulcus-sessions picture session.mcap --from 12 --to 15 --fps 25 --out 'frames/%05d.png'";

#[derive(Args)]
pub(super) struct PictureArgs {
    /// Recording
    recording: PathBuf,
    /// Time in the session, seconds. May be given several times
    #[arg(long, value_name = "S", required_unless_present_any = ["from", "list"])]
    at: Vec<String>,
    /// First time of a sequence of pictures, seconds
    #[arg(long, value_name = "S", requires = "to")]
    from: Option<String>,
    /// Last time of the sequence, seconds
    #[arg(long, value_name = "S", requires = "from")]
    to: Option<String>,
    /// Pictures of the sequence for each second. Default: 25
    #[arg(long, value_name = "N", requires = "from")]
    fps: Option<String>,
    /// File with a line for each picture: seconds, view, tooth or `-`, file of the picture
    #[arg(long, value_name = "FILE")]
    list: Option<PathBuf>,
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
    /// Size of the pictures, pixels
    #[arg(long, value_name = "WxH", default_value = "1280x720")]
    size: String,
    /// File of the picture. For several pictures the name has a place for their numbers, such as %05d
    #[arg(long, value_name = "FILE.png", required_unless_present = "list")]
    out: Option<PathBuf>,
}

pub(super) fn run(args: &PictureArgs) -> anyhow::Result<ExitCode> {
    let program = find("sulcus-client", BUILDS_CLIENT)?;
    let mut command = Command::new(&program);
    command
        .arg("picture")
        .arg("--recording")
        .arg(&args.recording);
    let mut named: Vec<(&str, &String)> = vec![("--size", &args.size)];
    // A list names the view of each picture.
    if args.list.is_none() {
        named.push(("--view", &args.view));
    }
    named.extend(args.at.iter().map(|at| ("--at", at)));
    let others = [
        ("--from", &args.from),
        ("--to", &args.to),
        ("--fps", &args.fps),
        ("--tooth", &args.tooth),
        ("--head-turn", &args.head_turn),
        ("--head-tilt", &args.head_tilt),
    ];
    let others = others.into_iter();
    named.extend(others.filter_map(|(name, value)| Some((name, value.as_ref()?))));
    for (name, value) in named {
        // Joined by the sign, so that a value cannot become an option.
        let mut argument = OsString::from(format!("{name}="));
        argument.push(value);
        command.arg(argument);
    }
    for (name, file) in [("--list", &args.list), ("--out", &args.out)] {
        if let Some(file) = file {
            command.arg(name).arg(file);
        }
    }
    let ended = command
        .status()
        .with_context(|| format!("{}: cannot be started", program.shown()))?;
    let code = ended.code().and_then(|code| u8::try_from(code).ok());
    let code = code.with_context(|| format!("{}: ended by {ended}", program.shown()))?;
    Ok(ExitCode::from(code))
}
