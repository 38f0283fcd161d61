//! `info`: content of recordings.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::inputs::{open, recordings};
use super::print::{Outcome, at, for_each, object};
use crate::record::info::info;
use crate::record::read::{ReadError, Recording};
use crate::record::recover::{RecoverError, recover};
use crate::record::signature::Signature;

#[derive(Args)]
pub(super) struct InfoArgs {
    /// Recordings, or folders of recordings
    #[arg(required = true, value_name = "FILE")]
    pub(super) files: Vec<PathBuf>,
    /// Recover one truncated or damaged recording: write every whole chunk to this new file, and report each gap. A
    /// replay of the new file continues from the first snapshot behind each gap. The new file cannot be graded
    #[arg(long, value_name = "OUT")]
    pub(super) recover: Option<PathBuf>,
    /// Print one JSON object as the last line of standard output
    #[arg(long)]
    pub(super) json: bool,
}

/// `info`, or recovery with `--recover`.
pub(super) fn run(args: &InfoArgs) -> anyhow::Result<ExitCode> {
    let files = recordings(&args.files);
    let Some(out) = &args.recover else {
        return Ok(for_each(&files, args.json, "bytes", info_of));
    };
    anyhow::ensure!(
        files.len() == 1,
        "--recover takes one recording, found {}: name one recording and one new file",
        files.len()
    );
    Ok(for_each(&files, args.json, "bytes", |path| {
        recover_to(path, out)
    }))
}

fn recover_to(path: &Path, out: &Path) -> anyhow::Result<Outcome> {
    let recording = match Recording::open(path) {
        // There may be rows behind damage at the beginning.
        Err(ReadError::NoRows { .. }) => Recording::salvage(path),
        other => other,
    };
    let recording = recording.map_err(|error| at(path, &error))?;
    let bar = ProgressBar::with_draw_target(Some(recording.len()), ProgressDrawTarget::stderr());
    if let Ok(style) = ProgressStyle::with_template("{wide_bar} {bytes}/{total_bytes}, {eta} left")
    {
        bar.set_style(style);
    }
    let recovered = recover(&recording, out, &mut |bytes| bar.set_position(bytes));
    bar.finish_and_clear();
    let recovered = match recovered {
        // The error names the other file.
        Err(error @ RecoverError::Write { .. }) => Err(error.into()),
        other => other.map_err(|error| at(path, &error)),
    }?;
    Ok(Outcome {
        json: object(serde_json::to_value(&recovered)?),
        text: recovered.to_string(),
        finding: matches!(recovered.signature, Signature::Invalid { .. }),
    })
}

fn info_of(path: &Path) -> anyhow::Result<Outcome> {
    let recording = open(path)?;
    let info = info(path, &recording).map_err(|error| at(path, &error))?;
    Ok(Outcome {
        json: object(serde_json::to_value(&info)?),
        text: info.to_string(),
        finding: info.is_finding(),
    })
}
