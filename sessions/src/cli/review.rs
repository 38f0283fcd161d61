//! `review`: starts `sulcus-review`, the only program that links Rerun.

use std::ffi::OsString;
use std::process::{Command, ExitCode};

use anyhow::Context as _;
use clap::Args;
use sulcus_program::PathText;

use super::sibling::{BUILDS_REVIEW, find};

#[derive(Args)]
#[command(disable_help_flag = true)]
pub(super) struct ReviewArgs {
    /// Arguments of `sulcus-review`; `--help` lists them
    #[arg(
        trailing_var_arg = true,
        allow_hyphen_values = true,
        value_name = "ARGUMENTS"
    )]
    args: Vec<OsString>,
}

pub(super) fn run(args: &ReviewArgs) -> anyhow::Result<ExitCode> {
    let program = find("sulcus-review", BUILDS_REVIEW)?;
    let ended = Command::new(&program)
        .args(&args.args)
        .status()
        .with_context(|| format!("{}: cannot be started", program.shown()))?;
    let code = ended.code().and_then(|code| u8::try_from(code).ok());
    let code = code.with_context(|| format!("{}: ended by {ended}", program.shown()))?;
    Ok(ExitCode::from(code))
}
