//! `sulcus-review FILE`: a recorded session for the Rerun viewer.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, ValueEnum};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::json;
use sulcus_sessions::cli::print::{at, complain, object, say};
use sulcus_sessions::cli::written::{is_same, may_write};
use sulcus_sessions::read::Recording;

use crate::session::{ReviewError, Slider, Window, review};

#[derive(Args)]
pub(super) struct ReviewArgs {
    /// Recording
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// File to write; without it, the recording's name with the ending `.rrd`
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
    /// Where the slider stands when the file is opened: `end` for a picture of that moment
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
    /// Where the file begins
    Start,
    /// Where it ends
    End,
}

pub(super) fn run(args: &ReviewArgs) -> anyhow::Result<ExitCode> {
    let window = Window {
        from_s: args.from,
        to_s: args.to.unwrap_or(f64::INFINITY),
    };
    // A NaN is in no order.
    if !(window.from_s >= 0.0 && window.from_s < window.to_s) {
        anyhow::bail!(
            "--from is {} s and --to {} s, expected 0 or more, and --from before --to",
            window.from_s,
            window.to_s
        );
    }
    let file = args.file.display().to_string();
    let out = match &args.out {
        Some(out) => out.clone(),
        None => args.file.with_extension("rrd"),
    };
    if is_same(&out, &args.file) {
        anyhow::bail!("{file}: --out is the recording itself, expected another file");
    }
    may_write("--out", &out, [])?;
    // It is renamed to what it will be when all is there: a device would be lost by that.
    anyhow::ensure!(
        !out.exists() || out.is_file(),
        "--out is `{}`, which is no plain file, expected one or a new one",
        out.display()
    );
    let recording = Recording::open(&args.file).map_err(|error| at(&args.file, &error))?;
    // Draws nothing when standard error is no terminal.
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
            // As with `replay`, no mistake of the user's: a finding.
            let why = at(&args.file, &error);
            complain(&why);
            if args.json {
                say(&json!({
                    "file": file,
                    "identical": false,
                    "first_divergent_tick": tick,
                    "error": why.to_string(),
                })
                .to_string())?;
            }
            return Ok(ExitCode::from(1));
        }
        Err(error) => return Err(at(&args.file, &error)),
    };
    let seconds = began.elapsed().as_secs_f64();
    if let Some(unsound) = &report.unsound {
        complain(&anyhow::anyhow!("{file}: {unsound}"));
    }
    let opened = (!args.no_open).then(|| crate::open_viewer(&report.out));
    let note = match &opened {
        None => format!(
            "to look at it: rerun {} (viewer {}: pip install rerun-sdk=={})",
            report.out.display(),
            crate::viewer_version(),
            crate::viewer_version()
        ),
        Some(Ok(())) => "opened in the Rerun viewer".to_owned(),
        Some(Err(why)) => why.to_string(),
    };
    if args.json {
        let mut json = object(serde_json::to_value(&report)?);
        json.insert("file".to_owned(), json!(file));
        json.insert("seconds".to_owned(), json!(seconds));
        json.insert("opened".to_owned(), json!(matches!(opened, Some(Ok(())))));
        json.insert("note".to_owned(), json!(note));
        say(&serde_json::Value::Object(json).to_string())?;
    } else {
        say(&format!(
            "{}\n  {} ticks, {} pictures, {} shapes of tissue, {} events: {:.1} MB in {seconds:.1} s{}\n  {note}",
            report.out.display(),
            report.ticks,
            report.frames,
            report.shapes,
            report.events,
            report.bytes as f64 * 1e-6,
            if report.identical {
                ""
            } else {
                "\n  of a former version: what is shown is its replay, which differs a little"
            }
        ))?;
    }
    Ok(ExitCode::from(u8::from(report.unsound.is_some())))
}
