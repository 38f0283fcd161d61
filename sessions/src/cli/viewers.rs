//! `viewers`: channels for viewers, made again by a replay.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::json;
use sulcus_program::PathText;

use super::inputs::{open, recordings};
use super::print::{Outcome, at, for_each, object};
use crate::replay::viewers::{Made, ViewersError, compare_viewers, with_viewers};

pub(super) const ABOUT: &str = "\
Makes the channels for viewers of a recording with the policy `on-demand`.

Rerun, Foxglove and other readers show these channels. A replay of the exact rows makes them byte for byte as a live recording \
holds them, and the hash in the signed log proves it. --out writes a new recording with the exact record and the channels. Its \
signatures stay valid. The file has another BLAKE3 than the original, which other recordings and grades name: keep the original.

Without --out nothing is written: the channels are made, and compared with the signed hash. This also works for a recording that \
has the channels.";

pub(super) const EXAMPLES: &str = "\
Examples:
  sulcus-sessions viewers session.mcap --out viewed.mcap
  sulcus-sessions viewers recordings/*.mcap      comparison only";

#[derive(Args)]
pub(super) struct ViewersArgs {
    /// Recordings, or folders of recordings
    #[arg(required = true, value_name = "FILE")]
    pub(super) files: Vec<PathBuf>,
    /// Write one recording with its channels for viewers to this new file. Default: only a comparison
    #[arg(long, value_name = "FILE2")]
    pub(super) out: Option<PathBuf>,
    /// Print one JSON object as the last line of standard output
    #[arg(long)]
    pub(super) json: bool,
}

pub(super) fn run(args: &ViewersArgs) -> anyhow::Result<ExitCode> {
    let files = recordings(&args.files);
    anyhow::ensure!(
        args.out.is_none() || files.len() == 1,
        "--out takes one recording, found {}: name one recording and one new file",
        files.len()
    );
    Ok(for_each(&files, args.json, "ticks", |path| {
        viewers_of(path, args.out.as_deref())
    }))
}

fn viewers_of(path: &Path, out: Option<&Path>) -> anyhow::Result<Outcome> {
    let recording = open(path)?;
    // The bar draws nothing if standard error is no terminal.
    let bar =
        ProgressBar::with_draw_target(Some(recording.facts().rows), ProgressDrawTarget::stderr());
    if let Ok(style) = ProgressStyle::with_template("{wide_bar} {pos}/{len} ticks, {eta} left") {
        bar.set_style(style);
    }
    let mut progress = |ticks| bar.set_position(ticks);
    let made = match out {
        Some(out) => with_viewers(&recording, out, &mut progress),
        None => compare_viewers(&recording, &mut progress),
    };
    bar.finish_and_clear();
    let file = path.shown().to_string();
    match made {
        Ok(made) => {
            let mut json = object(serde_json::to_value(&made)?);
            json.insert("file".to_owned(), json!(file));
            json.insert("identical".to_owned(), json!(true));
            Ok(Outcome {
                json,
                text: text(&file, &made),
                finding: false,
            })
        }
        Err(error) if error.is_finding() => {
            let json = json!({"file": file, "identical": false, "reason": error.to_string()});
            Ok(Outcome {
                json: object(json),
                text: format!("{file}\n  NOT MADE   {error}"),
                finding: true,
            })
        }
        // The error names the other file.
        Err(error @ (ViewersError::Write { .. } | ViewersError::Record(_))) => Err(error.into()),
        Err(error) => Err(at(path, &error)),
    }
}

fn text(file: &str, made: &Made) -> String {
    let Made {
        ticks, messages, ..
    } = made;
    let mut said = format!(
        "{file}\n  identical  {messages} messages for viewers by {ticks} ticks, as the station signed them"
    );
    if let (Some(out), Some(bytes)) = (&made.out, made.bytes) {
        let mb = bytes as f64 * 1e-6;
        said.push_str(&format!(
            "\n  written    {out}, {mb:.2} MB; keep the original as evidence"
        ));
    }
    said
}
