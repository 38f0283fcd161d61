//! `sulcus-server rollover`: the end of a school year.

use std::path::PathBuf;

use anyhow::bail;
use clap::Args;
use serde_json::{Value, json};
use sulcus_program::{PathText, say, tell};
use sulcus_proto::station::{Phase, StationStatus};

use super::StateArgs;
use crate::control_socket::{Request, ask};
use crate::plan::{Plan, PlanBook, PlanChange, Station, StationPlan};
use crate::state::StateFolder;
use crate::state::classes::plain;
use crate::state::date::now_s;
use crate::state::rollover::{Chosen, Report, Rollover, Sitting, Stations};

/// Long text of the help.
const ABOUT: &str = "\
End a school year: make a backup of the state folder, then archive classes.

An archived class keeps its name, learners, exams and results; the pages of results show it with its day. Its plans, codes
and seats end, and the tokens of its learners are revoked. Recordings, grades, scores and names stay as they are. A new class
may have the same name. Every action stands in audit.jsonl. A second call for the same class changes nothing.

A class is refused while a session of one of its learners runs, while an exam is its present plan, and while an exam is
neither released nor sealed. The server may run meanwhile.";

/// Text after the options.
const NOTES: &str = "\
Examples:
  sulcus-server rollover --all --dry-run
  sulcus-server rollover \"Year 4 B\" c-7 --backup /mnt/school/2026-07-15.backup
  sulcus-server rollover --all --backup /mnt/school/2026-07-15.backup

Exit codes: 0 success, 2 wrong usage, a class that is refused, or bad input.";

/// End a school year: a backup, then classes are archived with their grades
#[derive(Clone, Debug, Args)]
#[command(long_about = ABOUT, after_long_help = NOTES)]
pub struct RolloverArgs {
    /// Names or ids of the classes
    #[arg(value_name = "CLASS", required_unless_present = "all")]
    classes: Vec<String>,
    /// Archive all classes
    #[arg(long, conflicts_with = "classes")]
    all: bool,
    /// New file for the backup, outside of the state folder
    #[arg(long, value_name = "FILE", required_unless_present = "dry_run")]
    backup: Option<PathBuf>,
    /// Print every action, and change nothing
    #[arg(long)]
    dry_run: bool,
    #[command(flatten)]
    state: StateArgs,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// Runs the command. The exit code is 0.
///
/// # Errors
/// A class is unknown or refused, the backup exists, or the state folder cannot be used.
pub fn run(args: &RolloverArgs) -> anyhow::Result<u8> {
    let asked = args.state.folder.as_deref();
    let Some(folder) = StateFolder::existing(asked)? else {
        let path = StateFolder::locate(asked)?;
        bail!(
            "the state folder {} does not exist, expected that of a server",
            path.shown()
        );
    };
    let by = format!("shell (uid {})", rustix::process::geteuid().as_raw());
    let chosen = match args.all {
        true => Chosen::All,
        false => Chosen::Named(args.classes.clone()),
    };
    let stations = OfFolder {
        folder: &folder,
        by: &by,
    };
    let rollover = Rollover::of(&folder, &by, &stations);
    let report = match &args.backup {
        Some(file) if !args.dry_run => rollover.carry_out(&chosen, file, now_s())?,
        _ => rollover.report(&chosen, now_s())?,
    };
    told(args, &report);
    Ok(0)
}

fn told(args: &RolloverArgs, report: &Report) {
    let is_made = !args.dry_run && !report.steps.is_empty();
    let backup = args.backup.as_ref().filter(|_| is_made);
    if args.json {
        let class = |step: &crate::state::rollover::Step| {
            let act = |(action, object): &(&str, String)| json!({ "do": action, "of": object });
            let acts: Vec<Value> = step.acts().map(act).collect();
            json!({ "id": step.class.id, "name": step.class.name, "actions": acts })
        };
        let classes: Vec<Value> = report.steps.iter().map(class).collect();
        let already: Vec<&String> = report.already.iter().map(|(id, _)| id).collect();
        say!(
            "{}",
            json!({ "archived": classes, "already": already, "dry_run": args.dry_run,
                "backup": backup.map(|file| file.shown().to_string()) })
        );
        return;
    }
    if let Some(file) = backup {
        say!("backup: {}", file.shown());
    }
    for step in &report.steps {
        for (action, object) in step.acts() {
            say!("{} {action}: {}", step.class.id, plain(object));
        }
    }
    for (id, name) in &report.already {
        say!("{id} is archived already: {}", plain(name));
    }
    if report.steps.is_empty() && report.already.is_empty() {
        say!("no class to archive");
    }
    if args.dry_run {
        tell!("dry run: nothing is changed");
    }
}

/// Stations of a state folder: of the running server, else those with a kept plan.
struct OfFolder<'a> {
    folder: &'a StateFolder,
    by: &'a str,
}

impl OfFolder<'_> {
    /// Answer of the running server; `None`: no server runs.
    fn asked(&self, request: &Request) -> Result<Option<Value>, String> {
        ask(self.folder, request).map_err(|error| error.to_string())
    }

    /// Book of the kept plans. Without one, no file is made.
    fn book(&self) -> Result<Option<PlanBook>, String> {
        let kept = PlanBook::kept(self.folder).map_err(|error| error.to_string())?;
        if kept.is_empty() {
            return Ok(None);
        }
        let station = |name: String| Station {
            name,
            plan: Plan::default(),
        };
        let stations: Vec<Station> = kept.into_iter().map(station).collect();
        let book = PlanBook::open(&stations, Some(self.folder));
        book.map(Some).map_err(|error| error.to_string())
    }
}

/// Sentence about an answer of another release.
fn other_release(error: &serde_json::Error) -> String {
    format!("the answer of the running server cannot be read ({error}); install the same release")
}

impl Stations for OfFolder<'_> {
    fn sessions(&self) -> Result<Vec<Sitting>, String> {
        let Some(mut answer) = self.asked(&Request::Status {})? else {
            return Ok(Vec::new());
        };
        let statuses = answer["stations"].take();
        let statuses: Vec<StationStatus> =
            serde_json::from_value(statuses).map_err(|error| other_release(&error))?;
        let busy = statuses
            .into_iter()
            .filter(|status| status.phase != Phase::Free);
        // Before its start, a session of an anonymous ticket is that of the plan's learner.
        let plans = self.plans()?;
        let of_plan = |station: &str| {
            let plan = plans.iter().find(|plan| plan.station == station);
            plan.map_or(String::new(), |plan| plan.learner.clone())
        };
        let sitting = |status: StationStatus| Sitting {
            learner: match status.learner.is_empty() {
                true => of_plan(&status.station),
                false => status.learner,
            },
            station: status.station,
        };
        Ok(busy.map(sitting).collect())
    }

    fn plans(&self) -> Result<Vec<Sitting>, String> {
        let plans: Vec<StationPlan> = match self.asked(&Request::Plans {})? {
            Some(answer) => {
                serde_json::from_value(answer).map_err(|error| other_release(&error))?
            }
            None => match self.book()? {
                Some(book) => book.all(|_| None),
                None => Vec::new(),
            },
        };
        // The plan of a file of stations cannot be changed here.
        let set = plans.into_iter().filter(|plan| plan.is_set);
        let sitting = |plan: StationPlan| Sitting {
            station: plan.station,
            learner: plan.plan.learner,
        };
        Ok(set.map(sitting).collect())
    }

    fn end_plan(&self, station: &str, whole: bool) -> Result<(), String> {
        let nobody = PlanChange {
            learner: Some(String::new()),
            ..PlanChange::default()
        };
        let station = station.to_owned();
        let request = match whole {
            true => Request::ResetPlan {
                station: station.clone(),
            },
            false => Request::SetPlan {
                station: station.clone(),
                change: nobody.clone(),
            },
        };
        if self.asked(&request)?.is_some() {
            return Ok(());
        }
        let Some(mut book) = self.book()? else {
            return Ok(());
        };
        let now_ns = now_s().saturating_mul(1_000_000_000);
        let set = match whole {
            true => book.reset(&station, self.by, None, now_ns),
            false => book.set(&station, &nobody, self.by, None, now_ns),
        };
        set.map(|_| ()).map_err(|error| error.to_string())
    }
}
