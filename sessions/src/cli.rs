//! The command line: what is asked, what is printed, and the exit code.

use std::ffi::OsString;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::Context as _;
use clap::{Args, Parser, Subcommand, ValueEnum};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::{Map, Value, json};
use sulcus_core::optimise::SolverKind;

use crate::info::info;
use crate::key::PublicKey;
use crate::read::Recording;
use crate::replay::{ReplayOptions, ReplayReport, replay};

/// Looks at recorded sessions: what they are, and whether they are what happened.
#[derive(Parser)]
#[command(
    name = "sulcus-sessions",
    version,
    after_help = "Exit code: 0 all is well, 1 a finding (a replay differs, a signature does not hold, a file is damaged or cut off: not gradable), 2 usage or bad input."
)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Says what recordings hold: duration, scene, exercise, station, size, ending, signature
    #[command(
        after_long_help = "Examples:\n  sulcus-sessions info session.mcap\n  sulcus-sessions info recordings/*.mcap --json | tail -n 1 | jq .files[].ending"
    )]
    Info(InfoArgs),
    /// Runs recorded sessions again and compares every state, wrench, snapshot and signature
    #[command(
        long_about = "Runs recorded sessions again and compares every state, wrench, snapshot and signature.\n\nA recording holds its compiled scene and the input of every tick, so that the same program gives the same bits. The first tick that differs is named. Signatures show whether the recording is what the station recorded: without --signer the key is taken from the recording itself, so compare its fingerprint.",
        after_long_help = "Examples:\n  sulcus-sessions replay session.mcap\n  sulcus-sessions replay session.mcap --signer station.pub --json\n  sulcus-sessions replay session.mcap --solver clarabel    (bits differ; shows by how many newtons)\n  sulcus-sessions replay recordings/*.mcap --audit"
    )]
    Replay(ReplayArgs),
}

#[derive(Args)]
struct InfoArgs {
    /// Recordings
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Print one JSON object on the last line of standard output
    #[arg(long)]
    json: bool,
}

#[derive(Args)]
struct ReplayArgs {
    /// Recordings
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Let an independent solver judge the answer of every tick
    #[arg(long)]
    audit: bool,
    /// Replay with this solver instead of the scene's
    #[arg(long, value_enum)]
    solver: Option<Solver>,
    /// Accept only recordings signed by this key: a file with the public key, or its 64 hexadecimal digits
    #[arg(long, value_name = "PUBKEYFILE|HEX")]
    signer: Option<String>,
    /// Print one JSON object on the last line of standard output
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, ValueEnum)]
enum Solver {
    /// The solver of the tick
    ActiveSet,
    /// The judge
    Clarabel,
}

impl From<Solver> for SolverKind {
    fn from(solver: Solver) -> Self {
        match solver {
            Solver::ActiveSet => Self::ActiveSet,
            Solver::Clarabel => Self::Clarabel,
        }
    }
}

/// Runs the program with these arguments, the first of which is its name.
pub fn run<I, T>(args: I) -> ExitCode
where
    I: IntoIterator<Item = T>,
    T: Into<OsString> + Clone,
{
    let cli = match Cli::try_parse_from(args) {
        Ok(cli) => cli,
        Err(message) => {
            // Help and version go to standard output with code 0, mistakes to standard error.
            let _ = message.print();
            return ExitCode::from(if message.use_stderr() { 2 } else { 0 });
        }
    };
    let json = match &cli.command {
        Command::Info(args) => args.json,
        Command::Replay(args) => args.json,
    };
    let outcome = match cli.command {
        Command::Info(args) => for_each(&args.files, args.json, "bytes", info_of),
        Command::Replay(args) => options(&args).and_then(|options| {
            for_each(&args.files, args.json, "ticks", |path| {
                replay_of(path, &options)
            })
        }),
    };
    outcome.unwrap_or_else(|error| {
        if json {
            println!("{}", json!({ "error": format!("{error:#}") }));
        }
        complain(&error);
        ExitCode::from(2)
    })
}

/// What one file came to: an object, a text, and whether something is wrong.
struct Outcome {
    json: Map<String, Value>,
    text: String,
    finding: bool,
}

fn info_of(path: &Path) -> anyhow::Result<Outcome> {
    let recording = Recording::open(path).map_err(|error| at(path, &error))?;
    let info = info(path, &recording).map_err(|error| at(path, &error))?;
    Ok(Outcome {
        json: object(serde_json::to_value(&info)?),
        text: info.to_string(),
        finding: info.is_finding(),
    })
}

fn options(args: &ReplayArgs) -> anyhow::Result<ReplayOptions> {
    let trust = args
        .signer
        .as_deref()
        .map(PublicKey::from_file_or_hex)
        .transpose()?;
    Ok(ReplayOptions {
        solver: args.solver.map(Into::into),
        audit: args.audit,
        trust,
    })
}

fn replay_of(path: &Path, options: &ReplayOptions) -> anyhow::Result<Outcome> {
    let recording = Recording::open(path).map_err(|error| at(path, &error))?;
    // Draws nothing when standard error is no terminal.
    let bar =
        ProgressBar::with_draw_target(Some(recording.facts().rows), ProgressDrawTarget::stderr());
    if let Ok(style) = ProgressStyle::with_template("{wide_bar} {pos}/{len} ticks, {eta} left") {
        bar.set_style(style);
    }
    let report = replay(&recording, options, &mut |ticks| bar.set_position(ticks));
    bar.finish_and_clear();
    let report = report.map_err(|error| at(path, &error))?;
    let mut json = object(serde_json::to_value(&report)?);
    json.insert("file".to_owned(), json!(path.display().to_string()));
    let ours = PublicKey::of_this_station().map(|key| key == recording.signer());
    json.insert("signed_by_this_station".to_owned(), json!(ours));
    Ok(Outcome {
        json,
        text: format!("{}\n{}", path.display(), text(&report, options, ours)),
        finding: report.is_finding(),
    })
}

fn text(report: &ReplayReport, options: &ReplayOptions, ours: Option<bool>) -> String {
    let mut lines = vec![match (&report.divergence, report.first_divergent_tick) {
        (Some(d), Some(tick)) => format!(
            "  DIFFERS    first at tick {tick} ({:?}: recorded {}, replayed {}), {} of {} ticks; force by up to {:.3e} N{}",
            d.what,
            d.hash_recorded,
            d.hash_replayed,
            d.ticks,
            report.ticks,
            report.max_force_deviation_n,
            if options.solver.is_some() {
                " (another solver never gives the same bits)"
            } else {
                ""
            }
        ),
        _ => format!(
            "  identical  {} ticks, {:.1} times real time",
            report.ticks, report.realtime_factor
        ),
    }];
    // Whoever makes a whole file anew can sign it with a key of their own: say whose key it is.
    let whose = match ours {
        _ if report.signer_trusted => "",
        Some(true) => " (this station's key)",
        Some(false) => " (NOT this station's key: name the right one with --signer)",
        None => " (the key is the recording's own: name the right one with --signer)",
    };
    lines.push(format!("  signature  {}{whose}", report.signature));
    lines.push(format!("  ending     {}", report.ending));
    lines.push(match &report.reason {
        None => "  gradable   yes".to_owned(),
        Some(reason) => format!("  gradable   no: {reason}"),
    });
    if let Some(audit) = &report.audit {
        lines.push(format!(
            "  audit      {} ticks with contact ({} unjudged), pose within {:.3e} mm of the judge's, KKT residual up to {:.3e}",
            audit.ticks, audit.unjudged, audit.max_pose_error_mm, audit.max_kkt_residual
        ));
    }
    lines.join("\n")
}

fn object(value: Value) -> Map<String, Value> {
    match value {
        Value::Object(map) => map,
        other => Map::from_iter([("value".to_owned(), other)]),
    }
}

/// The error's own sentence, with the file's name unless it says so itself.
fn at(path: &Path, error: &dyn std::error::Error) -> anyhow::Error {
    let (path, text) = (path.display().to_string(), error.to_string());
    if text.contains(&path) {
        anyhow::anyhow!(text)
    } else {
        anyhow::anyhow!("{path}: {text}")
    }
}

/// Does `one` to every file, prints, and gives the worst exit code; sums `total` over the files.
fn for_each(
    files: &[PathBuf],
    json: bool,
    total: &str,
    one: impl Fn(&Path) -> anyhow::Result<Outcome>,
) -> anyhow::Result<ExitCode> {
    let mut code = 0;
    let mut objects = Vec::new();
    for path in files {
        match one(path) {
            Ok(outcome) => {
                code = code.max(u8::from(outcome.finding));
                if !json {
                    say(&outcome.text)?;
                }
                objects.push(Value::Object(outcome.json));
            }
            Err(error) => {
                code = 2;
                complain(&error);
                objects
                    .push(json!({"file": path.display().to_string(), "error": error.to_string()}));
            }
        }
    }
    if json {
        let object = match <[Value; 1]>::try_from(objects) {
            Ok([only]) => only,
            Err(objects) => summary(objects, total),
        };
        say(&object.to_string())?;
    }
    Ok(ExitCode::from(code))
}

/// Several files as one object: `identical` only when every one is.
fn summary(objects: Vec<Value>, total: &str) -> Value {
    let sum: u64 = objects.iter().filter_map(|file| file[total].as_u64()).sum();
    let mut all = Map::from_iter([(total.to_owned(), json!(sum))]);
    if objects.iter().any(|file| file.get("identical").is_some()) {
        let identical = objects.iter().all(|file| file["identical"] == json!(true));
        let first = objects
            .iter()
            .find(|file| file["first_divergent_tick"].is_u64());
        // The slowest: what a user who waits for all of them would notice.
        let slowest = objects
            .iter()
            .filter_map(|file| file["realtime_factor"].as_f64())
            .reduce(f64::min);
        all.insert("identical".to_owned(), json!(identical));
        all.insert(
            "first_divergent_tick".to_owned(),
            first.map_or(Value::Null, |file| file["first_divergent_tick"].clone()),
        );
        all.insert("realtime_factor".to_owned(), json!(slowest));
    }
    all.insert("files".to_owned(), Value::Array(objects));
    Value::Object(all)
}

/// A line on standard output; a reader that went away is no error.
fn say(line: &str) -> anyhow::Result<()> {
    match writeln!(std::io::stdout(), "{line}") {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(error).context("cannot write to standard output")
        }
        _ => Ok(()),
    }
}

fn complain(error: &anyhow::Error) {
    let _ = writeln!(std::io::stderr(), "error: {error}");
}
