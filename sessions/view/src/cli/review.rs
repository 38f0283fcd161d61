//! `sulcus-review FILE`: writes a recorded session for the Rerun viewer.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Args, ValueEnum};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::json;
use sulcus_program::PathText;
use sulcus_sessions::cli::inputs::{open, recordings};
use sulcus_sessions::cli::print::{Outcome, at, complain, for_each, object};
use sulcus_sessions::cli::written::{is_same, may_write};

use crate::session::{ReviewError, Slider, Window, review};
use crate::viewer::{open_viewer as open_in_viewer, version};

#[derive(Args)]
pub(super) struct ReviewArgs {
    /// Recording, or a folder of recordings
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// File to write. Default: the recording's name with the ending `.rrd`
    #[arg(long, value_name = "FILE.rrd")]
    out: Option<PathBuf>,
    /// Show from this second of the session on
    #[arg(
        long,
        value_name = "S",
        default_value_t = 0.0,
        allow_negative_numbers = true
    )]
    from: f64,
    /// Show up to this second of the session
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    to: Option<f64>,
    /// Position of the slider when the file is opened. `end` suits a picture of that moment
    #[arg(long, value_enum, default_value_t = SliderAt::Start)]
    slider: SliderAt,
    /// Only write the file
    #[arg(long)]
    no_open: bool,
    /// Print one JSON object on the last line of standard output
    #[arg(long)]
    pub(super) json: bool,
}

#[derive(Clone, Copy, ValueEnum)]
enum SliderAt {
    /// Beginning of the file
    Start,
    /// End of the file
    End,
}

pub(super) fn run(args: &ReviewArgs) -> anyhow::Result<ExitCode> {
    let window = Window {
        from_s: args.from,
        to_s: args.to.unwrap_or(f64::INFINITY),
    };
    // A NaN fails this test, too.
    if !(window.from_s >= 0.0 && window.from_s < window.to_s) {
        anyhow::bail!(
            "--from is {} s and --to {} s, expected 0 or more, and --from before --to",
            window.from_s,
            window.to_s
        );
    }
    let files = recordings(std::slice::from_ref(&args.file));
    anyhow::ensure!(
        files.len() == 1 || args.out.is_none(),
        "--out is one file, expected one recording, found {1} in {0}",
        args.file.shown(),
        files.len()
    );
    // A folder's recordings would open too many viewers.
    let open_viewer = !args.no_open && files.len() == 1;
    Ok(for_each(&files, args.json, "ticks", |path| {
        review_of(path, args, window, open_viewer)
    }))
}

fn review_of(
    path: &Path,
    args: &ReviewArgs,
    window: Window,
    open_viewer: bool,
) -> anyhow::Result<Outcome> {
    let file = path.shown().to_string();
    let out = match &args.out {
        Some(out) => out.clone(),
        None => path.with_extension("rrd"),
    };
    if is_same(&out, path) {
        anyhow::bail!("{file}: --out is the recording, expected another file");
    }
    may_write("--out", &out, [])?;
    // The finished file is renamed to this name, which would destroy a device.
    anyhow::ensure!(
        !out.exists() || out.is_file(),
        "--out is `{}`, which is no plain file, expected a plain file or a new one",
        out.shown()
    );
    let recording = open(path)?;
    // The bar draws nothing if standard error is no terminal.
    let bar =
        ProgressBar::with_draw_target(Some(recording.facts().rows), ProgressDrawTarget::stderr());
    if let Ok(style) = ProgressStyle::with_template("{wide_bar} {pos}/{len} ticks, {eta} left") {
        bar.set_style(style);
    }
    let began = std::time::Instant::now();
    let slider = match args.slider {
        SliderAt::Start => Slider::Start,
        SliderAt::End => Slider::End,
    };
    let found = review(&recording, &out, window, slider, &mut |ticks| {
        bar.set_position(ticks)
    });
    bar.finish_and_clear();
    let report = match found {
        Ok(report) => report,
        Err(error @ ReviewError::Differs { tick, .. }) => {
            // A replay that differs is a finding and no error of the user, as with `replay`.
            let why = at(path, &error);
            complain(&why);
            return Ok(Outcome {
                json: object(json!({
                    "file": file,
                    "identical": false,
                    "first_divergent_tick": tick,
                    "error": why.to_string(),
                })),
                text: String::new(),
                finding: true,
            });
        }
        Err(error) => return Err(at(path, &error)),
    };
    let seconds = began.elapsed().as_secs_f64();
    if let Some(unsound) = &report.unsound {
        complain(&anyhow::anyhow!("{file}: {unsound}"));
    }
    let opened = open_viewer.then(|| open_in_viewer(&report.out));
    let note = match &opened {
        None => format!(
            "to open the file: rerun {} (viewer {}: pip install rerun-sdk=={})",
            report.out.shown(),
            version(),
            version()
        ),
        Some(Ok(())) => "opened in the Rerun viewer".to_owned(),
        Some(Err(why)) => why.to_string(),
    };
    let mut json = object(serde_json::to_value(&report)?);
    json.insert("file".to_owned(), json!(file));
    json.insert("seconds".to_owned(), json!(seconds));
    json.insert("opened".to_owned(), json!(matches!(opened, Some(Ok(())))));
    json.insert("note".to_owned(), json!(note));
    let text = format!(
        "{}\n  {} ticks, {} pictures, {} shapes of tissue, {} events: {:.1} MB in {seconds:.1} s{}\n  {note}",
        report.out.shown(),
        report.ticks,
        report.frames,
        report.shapes,
        report.events,
        report.bytes as f64 * 1e-6,
        if report.identical {
            ""
        } else {
            "\n  recording of a former version: the file shows its replay, which differs slightly"
        }
    );
    Ok(Outcome {
        json,
        text,
        finding: report.unsound.is_some(),
    })
}
