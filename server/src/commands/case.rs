//! `sulcus-server case`: written patients of a school and their compiled scenes.

use std::path::PathBuf;

use anyhow::Context;
use clap::{Args, Subcommand};
use serde_json::{Value, json};
use sulcus_program::{PathText, ProgressLines, say, tell};
use sulcus_scene::anatomy::patient::{Condition, Patient, as_text, generate};

use super::StateArgs;
use crate::cases::{CaseStore, Opened, State, build, uses};
use crate::state::date::day;

/// Long text of the help.
const ABOUT: &str = "\
List, make, check, compile and remove cases: written patients with their compiled scenes.

A case is a patient file in the state folder. A teacher changes the file with the console's form or with an editor. A plan
names the compiled scene of the case, and takes no time to load then.";

/// Text after the options of `new`.
const NEW: &str = "\
Examples:
  sulcus-server case new deep-molar --condition periodontitis --seed 7
  sulcus-server case new year-2-a --from patient.toml
  sulcus-server case new year-2-b --copy year-2-a

A seed gives the same patient on every machine. An existing case is never overwritten.";

/// Text after the options of `compile`.
const COMPILE: &str = "\
Examples:
  sulcus-server case compile deep-molar
  sulcus-server plan set room3-1 --exercise bimanual --scene \"$(sulcus-server case show deep-molar --path)\"

The work takes seconds to minutes, at the least priority and on one core. One case is compiled at a time. A compilation that
fails or is stopped leaves the former scene as it is.";

/// List, make, check, compile and remove cases
#[derive(Clone, Debug, Args)]
#[command(long_about = ABOUT)]
pub struct CaseArgs {
    #[command(subcommand)]
    action: Action,
}

#[derive(Clone, Debug, Subcommand)]
enum Action {
    /// List all cases with their states
    List(ListArgs),
    /// Make a case: generated, from a patient file, or as a copy
    #[command(after_long_help = NEW)]
    New(NewArgs),
    /// Check the patient of a case; the exit code is 1 if a value has a fault
    Check(NameArgs),
    /// Compile a case to the scene that plans name
    #[command(after_long_help = COMPILE)]
    Compile(CompileArgs),
    /// Print the chart and the state of a case
    Show(ShowArgs),
    /// Remove a case with its compiled scene, unless a plan uses the case
    Remove(NameArgs),
    /// Draw the compiled scene of a case from a side, for the console
    #[cfg(feature = "lab")]
    #[command(hide = true)]
    Picture(PictureArgs),
}

#[derive(Clone, Debug, Args)]
struct ListArgs {
    #[command(flatten)]
    state: StateArgs,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Debug, Args)]
struct NameArgs {
    #[command(flatten)]
    state: StateArgs,
    /// Name of the case
    name: String,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Debug, Args)]
struct NewArgs {
    #[command(flatten)]
    state: StateArgs,
    /// Name of the case: 1 to 64 letters, digits, - and _, a letter or digit first
    name: String,
    /// Condition of the generated patient: healthy, gingivitis or periodontitis
    #[arg(long, value_name = "NAME", default_value = "periodontitis")]
    condition: Condition,
    /// Random seed of the generated patient
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Patient file whose content becomes the case
    #[arg(long, value_name = "FILE", conflicts_with_all = ["condition", "seed", "copy"])]
    from: Option<PathBuf>,
    /// Case whose patient becomes that of the new case
    #[arg(long, value_name = "CASE", conflicts_with_all = ["condition", "seed"])]
    copy: Option<String>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Debug, Args)]
struct CompileArgs {
    #[command(flatten)]
    place: NameArgs,
    /// End with the program that started this one
    #[arg(long, hide = true)]
    child: bool,
}

#[derive(Clone, Debug, Args)]
struct ShowArgs {
    #[command(flatten)]
    place: NameArgs,
    /// Print the path of the compiled scene alone, for `plan set --scene`
    #[arg(long, conflicts_with = "json")]
    path: bool,
}

#[cfg(feature = "lab")]
#[derive(Clone, Debug, Args)]
struct PictureArgs {
    #[command(flatten)]
    place: NameArgs,
    /// Side
    #[arg(long)]
    side: String,
    /// End with the program that started this one
    #[arg(long)]
    child: bool,
}

/// Runs the command; the exit code is 1 if a checked patient has a fault, else 0.
///
/// # Errors
/// The state folder cannot be used, a name is not valid, or a case cannot be compiled.
pub fn run(args: &CaseArgs) -> anyhow::Result<u8> {
    match &args.action {
        Action::List(args) => list(args),
        Action::New(args) => new(args),
        Action::Check(args) => check(args),
        Action::Compile(args) => compile(args),
        Action::Show(args) => show(args),
        Action::Remove(args) => remove(args),
        #[cfg(feature = "lab")]
        Action::Picture(args) => picture(args),
    }
}

fn store(state: &StateArgs) -> anyhow::Result<CaseStore> {
    Ok(CaseStore::open(&state.open()?)?)
}

/// A case as a JSON object.
fn object(store: &CaseStore, opened: &Opened) -> Value {
    let label = opened.patient.as_ref().map(|patient| &patient.name).ok();
    let status = opened.status.as_ref();
    json!({
        "name": opened.name, "label": label, "state": opened.state(), "version": opened.version,
        "faults": faults(opened),
        "compiled_unix_s": status.map(|status| status.compiled_unix_s),
        "scene_hash": status.map(|status| &status.scene_hash),
        "scene": status.map(|_| store.scene(&opened.name).shown().to_string()),
    })
}

/// All faults of a patient, a sentence each.
fn faults(opened: &Opened) -> Vec<String> {
    match &opened.patient {
        Err(why) => vec![why.clone()],
        Ok(_) => opened.faults.iter().map(ToString::to_string).collect(),
    }
}

fn list(args: &ListArgs) -> anyhow::Result<u8> {
    let store = store(&args.state)?;
    let mut all = Vec::new();
    for name in store.names()? {
        all.push(store.read(&name)?);
    }
    if args.json {
        let all: Vec<Value> = all.iter().map(|opened| object(&store, opened)).collect();
        say!("{}", json!({ "cases": all }));
        return Ok(0);
    }
    if all.is_empty() {
        tell!("no cases; `sulcus-server case new` makes one");
        return Ok(0);
    }
    say!("{:24} {:30} {:11} patient", "name", "state", "compiled");
    for opened in &all {
        let label = match &opened.patient {
            Ok(patient) => patient.name.escape_debug().to_string(),
            Err(_) => String::new(),
        };
        let compiled = opened.status.as_ref();
        let compiled = compiled.map(|status| day(status.compiled_unix_s).to_string());
        say!(
            "{:24} {:30} {:11} {label}",
            opened.name,
            opened.state().words(),
            compiled.unwrap_or_default()
        );
    }
    Ok(0)
}

fn new(args: &NewArgs) -> anyhow::Result<u8> {
    let store = store(&args.state)?;
    let text = match (&args.from, &args.copy) {
        (Some(file), _) => Patient::read(file)?.1,
        (None, Some(other)) => store.text(other)?,
        (None, None) => generate(args.seed, args.condition).to_toml(),
    };
    let made = store.create(&args.name, &text)?;
    told(&store, &made, args.json);
    Ok(0)
}

/// Prints a case: its chart and state, or a JSON object.
fn told(store: &CaseStore, opened: &Opened, json: bool) {
    if json {
        say!("{}", object(store, opened));
        return;
    }
    if let Ok(patient) = &opened.patient {
        say!("{}", as_text(patient).trim_end());
    }
    say!("case {}: {}", opened.name, opened.state().words());
    for fault in faults(opened) {
        say!("  {fault}");
    }
}

fn check(args: &NameArgs) -> anyhow::Result<u8> {
    let store = store(&args.state)?;
    let opened = store.read(&args.name)?;
    let all = faults(&opened);
    if args.json {
        say!("{}", object(&store, &opened));
    } else if all.is_empty() {
        say!("case {} has no fault", opened.name);
    } else {
        for fault in &all {
            say!("{fault}");
        }
    }
    Ok(u8::from(opened.state() == State::Faulty))
}

fn compile(args: &CompileArgs) -> anyhow::Result<u8> {
    gently(args.child);
    let place = &args.place;
    let store = store(&place.state)?;
    let progress = ProgressLines::default();
    let report = |stage: &str, share: f64| progress.report(stage, share);
    let status = build(&store, &place.name, &report)?;
    for warning in &status.warnings {
        tell!("warning: {warning}");
    }
    let path = store.scene(&place.name);
    if place.json {
        say!("{}", object(&store, &store.read(&place.name)?));
    } else {
        let (bytes, took) = (status.scene_bytes, status.took_s);
        say!("{}: {bytes} bytes in {took} s", path.shown());
    }
    Ok(0)
}

/// Makes this process a quiet one. A child of a server runs in idle time alone, and ends with the server.
fn gently(is_child: bool) {
    build::be_gentle(is_child);
    if is_child {
        let end = rustix::process::Signal::KILL;
        let _ = rustix::process::set_parent_process_death_signal(Some(end));
    }
}

fn show(args: &ShowArgs) -> anyhow::Result<u8> {
    let place = &args.place;
    let store = store(&place.state)?;
    let opened = store.read(&place.name)?;
    if args.path {
        anyhow::ensure!(
            opened.status.is_some(),
            "the case `{}` is not compiled yet: sulcus-server case compile {}",
            place.name,
            place.name
        );
        say!("{}", store.scene(&place.name).shown());
        return Ok(0);
    }
    told(&store, &opened, place.json);
    if !place.json {
        let users = uses::users(&store, &place.name)?;
        if !users.is_empty() {
            say!("  in the plan of {}", users.join(", "));
        }
    }
    Ok(0)
}

fn remove(args: &NameArgs) -> anyhow::Result<u8> {
    let store = store(&args.state)?;
    store
        .remove(&args.name)
        .with_context(|| format!("case {} is not removed", args.name.escape_debug()))?;
    if args.json {
        say!("{}", json!({ "name": args.name, "removed": true }));
    } else {
        say!("case {} is removed", args.name);
    }
    Ok(0)
}

/// Length of the longer edge of a picture, pixels.
#[cfg(feature = "lab")]
const PIXELS: usize = 1000;

#[cfg(feature = "lab")]
fn picture(args: &PictureArgs) -> anyhow::Result<u8> {
    gently(args.child);
    let place = &args.place;
    let store = store(&place.state)?;
    store.text(&place.name)?;
    let path = store.scene(&place.name);
    let bytes =
        std::fs::read(&path).with_context(|| format!("case {} is not compiled yet", place.name))?;
    let scene = sulcus_core::Scene::from_bytes(&bytes).with_context(|| path.shown().to_string())?;
    let png = sulcus_lab::mouth_picture(&scene, &args.side, PIXELS)?;
    let hash = blake3::hash(&bytes).to_hex();
    store.keep_picture(&place.name, &args.side, hash.as_str(), &png)?;
    if place.json {
        say!(
            "{}",
            json!({ "name": place.name, "side": args.side, "bytes": png.len() })
        );
    }
    Ok(0)
}
