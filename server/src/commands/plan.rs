//! `sulcus-server plan`: shows and sets plans, of the running server or for its next start.

use std::path::PathBuf;

use anyhow::{Context, bail};
use clap::{Args, Subcommand};
use serde_json::json;
use sulcus_program::{say, tell};
use sulcus_proto::learner;
use sulcus_sessions::Mode;

use super::StateArgs;
use crate::control_socket::{Request, ask};
use crate::plan::names::{EXPECTED, is_station_name};
use crate::plan::{
    ClockInGap, PatientSeed, Plan, PlanBook, PlanChange, Station, StationPlan, StationsFile,
};
use crate::state::{StateFolder, date};

/// Long text of the help.
const ABOUT: &str = "\
Show or set the plans of stations: exercise, patient, mode, learner and limits of the next session.

The command talks to the running server through a socket in the state folder. Without a running server, a change is kept in
the state folder for the next start. A kept plan wins over the file of `serve --config`.";

/// Text after the options of `set`.
const SET: &str = "\
Examples:
  sulcus-server plan set room3-1 --exercise probing --learner s-17
  sulcus-server plan set room3-1 --mode exam --time-limit-s 1800
  sulcus-server plan set room3-1 --file exam.toml            the whole plan; parts that the file lacks have their defaults
  sulcus-server plan set room3-1 --clear time_limit_s
  sulcus-server plan set room3-1 --from-config               the plan of the file of stations again

A change takes effect with the next session. The plan of an exam cannot be changed while its session runs. The patient's
seed of an exam comes from the system's random numbers and cannot be given.";

/// Show or set the plans of stations
#[derive(Clone, Debug, Args)]
#[command(long_about = ABOUT)]
pub struct PlanArgs {
    #[command(subcommand)]
    action: Action,
}

#[derive(Clone, Debug, Subcommand)]
enum Action {
    /// Print the plan of a station, or all plans, with their changes
    Show(ShowArgs),
    /// Change parts of the plan of a station, from its next session on
    #[command(after_long_help = SET)]
    Set(Box<SetArgs>),
}

#[derive(Clone, Debug, Args)]
struct ShowArgs {
    #[command(flatten)]
    place: PlaceArgs,
    /// Name of the station. Default: all stations
    station: Option<String>,
}

#[derive(Clone, Debug, Args)]
struct PlaceArgs {
    #[command(flatten)]
    state: StateArgs,
    /// File of stations of `serve --config`, for the plans of a server that does not run
    #[arg(long, value_name = "FILE")]
    config: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Debug, Args)]
struct SetArgs {
    #[command(flatten)]
    place: PlaceArgs,
    /// Name of the station
    station: String,
    /// Exercise: bimanual, crown, probing, retraction, an exercise file that ends in .toml, or `free` without a grade
    #[arg(long, value_name = "NAME")]
    exercise: Option<String>,
    /// Scene file (TOML) or compiled scene (.scene)
    #[arg(long, value_name = "FILE")]
    scene: Option<PathBuf>,
    /// Seed of the generated patient, or `system` for random numbers of the system; refused as a number in an exam
    #[arg(long, value_name = "N|system")]
    seed: Option<PatientSeed>,
    /// Ticks per second, 250 to 8000
    #[arg(long, value_name = "HZ", value_parser = clap::value_parser!(u16).range(250..=8000))]
    rate_hz: Option<u16>,
    /// Purpose of the sessions
    #[arg(long, value_enum)]
    mode: Option<Mode>,
    /// Opaque learner id, never a name; empty for none
    #[arg(long, value_name = "ID", value_parser = learner::parse)]
    learner: Option<String>,
    /// Rubric file
    #[arg(long, value_name = "FILE")]
    rubric: Option<PathBuf>,
    /// Longest session, seconds
    #[arg(long, value_name = "S", value_parser = clap::value_parser!(u32).range(1..=86_400))]
    time_limit_s: Option<u32>,
    /// Time that a session waits for a lost student, seconds; 0: the session ends with its connection
    #[arg(long, value_name = "S", value_parser = clap::value_parser!(u32).range(0..=3600))]
    resume_within_s: Option<u32>,
    /// Whether the time limit includes gaps without the student
    #[arg(long, value_enum)]
    clock_in_gap: Option<ClockInGap>,
    /// Largest force, newtons, above 0
    #[arg(long, value_name = "N", value_parser = newtons)]
    force_limit_n: Option<f32>,
    /// Whether clients far away may run the ticks at the hand; they then hold the mouth, and with it the answer.
    /// Default: true, but false in an exam
    #[arg(long, value_name = "BOOL")]
    tick_at_hand: Option<bool>,
    /// Largest mean CPU time of a tick at the fine level of tissue, microseconds; refused with a grade
    #[arg(long, value_name = "US", value_parser = clap::value_parser!(u32).range(10..=900))]
    detail_budget_us: Option<u32>,
    /// Name of a part that returns to its default, such as time_limit_s; may be given several times
    #[arg(long, value_name = "PART")]
    clear: Vec<String>,
    /// File with the whole plan (TOML); other options change it
    #[arg(long, value_name = "PLAN.toml", conflicts_with = "from_config")]
    file: Option<PathBuf>,
    /// Return to the plan of the file of stations
    #[arg(long)]
    from_config: bool,
}

/// Force above 0, newtons.
fn newtons(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(force) if force.is_finite() && force > 0.0 => Ok(force),
        _ => Err("expected a force in newtons above 0".to_owned()),
    }
}

/// Runs the command. The exit code is 0.
///
/// # Errors
/// The plan is not valid, the station is unknown, an exam runs, or the state folder cannot be used.
pub fn run(args: &PlanArgs) -> anyhow::Result<u8> {
    match &args.action {
        Action::Show(args) => show(args),
        Action::Set(args) => set(args),
    }
}

fn show(args: &ShowArgs) -> anyhow::Result<u8> {
    let place = &args.place;
    let folder = StateFolder::existing(place.state.folder.as_deref())?;
    let answer = match &folder {
        Some(folder) => ask(folder, &Request::Plans {})?,
        None => None,
    };
    let runs = answer.is_some();
    let mut plans: Vec<StationPlan> = match answer {
        Some(plans) => serde_json::from_value(plans)
            .context("the plans of the running server cannot be read; install the same release")?,
        None => {
            let kept = folder.as_ref().map(PlanBook::kept).transpose()?;
            let stations = stations(place, &kept.unwrap_or_default())?;
            PlanBook::open(&stations, folder.as_ref())?.all(|_| None)
        }
    };
    if let Some(station) = &args.station {
        let names: Vec<String> = plans.iter().map(|plan| plan.station.clone()).collect();
        plans.retain(|plan| plan.station == *station);
        if plans.is_empty() {
            let known = match names.is_empty() {
                true => "no station is known here; name the file of stations with --config".into(),
                false => format!("expected one of {}", names.join(", ")),
            };
            bail!("station `{}` is unknown, {known}", station.escape_debug());
        }
    }
    if place.json {
        say!("{}", json!({ "running": runs, "plans": plans }));
        return Ok(0);
    }
    if !runs {
        tell!("no server runs with this state folder; these plans are for its next start");
    }
    for plan in &plans {
        say!("{}", plan.lines());
    }
    Ok(0)
}

fn set(args: &SetArgs) -> anyhow::Result<u8> {
    let place = &args.place;
    let station = &args.station;
    anyhow::ensure!(
        is_station_name(station),
        "station is `{}`, expected {EXPECTED}",
        station.escape_debug()
    );
    let change = change(args)?;
    let changes_nothing = change == PlanChange::default();
    anyhow::ensure!(
        args.from_config || !changes_nothing,
        "no part of the plan is given; `sulcus-server plan set --help` lists them"
    );
    anyhow::ensure!(
        !args.from_config || changes_nothing,
        "--from-config is given with other parts of the plan, expected alone"
    );
    let folder = place.state.open()?;
    let request = if args.from_config {
        Request::ResetPlan {
            station: station.clone(),
        }
    } else {
        Request::SetPlan {
            station: station.clone(),
            change: change.clone(),
        }
    };
    let (plan, runs) = match ask(&folder, &request)? {
        Some(plan) => {
            let plan: StationPlan = serde_json::from_value(plan).context(
                "the plan of the running server cannot be read; install the same release",
            )?;
            (plan, true)
        }
        None => (keep(args, &folder, &change)?, false),
    };
    if place.json {
        let mut object = serde_json::to_value(&plan)?;
        object["running"] = json!(runs);
        say!("{object}");
    } else {
        say!("{}", plan.lines());
    }
    Ok(0)
}

/// Keeps a change for the next start of the server.
fn keep(args: &SetArgs, folder: &StateFolder, change: &PlanChange) -> anyhow::Result<StationPlan> {
    let station = &args.station;
    // Without a file of stations, the plan begins with the defaults of a plan.
    let stations = stations(&args.place, std::slice::from_ref(station))?;
    let mut book = PlanBook::open(&stations, Some(folder))?;
    let by = format!("shell (uid {})", rustix::process::geteuid().as_raw());
    let now_ns = date::now_s().saturating_mul(1_000_000_000);
    let is_set = book.is_set(station);
    let mut plan = if args.from_config {
        book.reset(station, &by, None, now_ns)?
    } else {
        book.set(station, change, &by, None, now_ns)?
    };
    plan.effect = "takes effect at the next start of the server".into();
    let base = match (&args.place.config, is_set) {
        _ if args.from_config || args.file.is_some() => "",
        (Some(_), _) | (None, true) => "",
        (None, false) => {
            "; parts that are not given have their defaults, whatever a file of stations says (--config names one)"
        }
    };
    tell!("no server runs with this state folder: the plan takes effect at the next start{base}");
    Ok(plan)
}

/// Stations of the file of the command line, or those of the given names with the default plan.
fn stations(place: &PlaceArgs, names: &[String]) -> anyhow::Result<Vec<Station>> {
    if let Some(file) = &place.config {
        let file = std::path::absolute(file).unwrap_or_else(|_| file.clone());
        return Ok(StationsFile::open(&file)?.stations);
    }
    let station = |name: &String| Station {
        name: name.clone(),
        plan: Plan::default(),
    };
    Ok(names.iter().map(station).collect())
}

/// Change of the command line. Relative paths are those of this process, not of the server.
fn change(args: &SetArgs) -> anyhow::Result<PlanChange> {
    let here = std::env::current_dir().context("the working folder is unknown")?;
    let given = PlanChange {
        exercise: args.exercise.clone(),
        scene: args.scene.clone(),
        patient_seed: args.seed,
        rate_hz: args.rate_hz,
        mode: args.mode,
        learner: args.learner.clone(),
        rubric: args.rubric.clone(),
        time_limit_s: args.time_limit_s,
        resume_within_s: args.resume_within_s,
        clock_in_gap: args.clock_in_gap,
        force_limit_n: args.force_limit_n,
        tick_at_hand: args.tick_at_hand,
        detail_budget_us: args.detail_budget_us,
        clear: args.clear.clone(),
    }
    .based(&here);
    let Some(file) = &args.file else {
        return Ok(given);
    };
    let whole = Plan::of(&PlanChange::open(file)?)
        .and_then(|plan| plan.with(&given))
        .with_context(|| format!("--file {}", sulcus_program::PathText::shown(file.as_path())))?;
    Ok(PlanChange::to(&whole))
}
