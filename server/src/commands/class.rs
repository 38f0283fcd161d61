//! `sulcus-server class`: classes, rosters, plans of classes and learners, codes, seats, exams, limits of recordings.

mod expire;
mod print;
mod seat;

use std::path::PathBuf;

use anyhow::{Context, bail};
use clap::{Args, Subcommand};
use serde_json::json;
use sulcus_program::{PathText, say, tell};
use sulcus_sessions::Mode;

use super::StateArgs;
use crate::state::classes::change::Target;
use crate::state::classes::import::{MOST_BYTES, Report, Row};
use crate::state::classes::task::{Wanted, cases, exercises};
use crate::state::classes::{Book, Class, Classes, codes};
use crate::state::date::{minute, now_s, parse_day};
use crate::state::{StateFolder, create_private};

/// Long text of the help.
const ABOUT: &str = "\
Classes with their learners, plans, codes and exams: the pages Classes, Seats and Exams of the console, from the shell.

Recordings have opaque learner ids. The file names.json of the state folder joins ids and names, and is the only place with
names; without the file the commands print ids. Every change stands in audit.jsonl.
CLASS is the name of a class, or its id such as c-3.";

/// Text after the options of `import`.
const IMPORT: &str = "\
Examples:
  sulcus-server class import autumn.csv --dry-run
  sulcus-server class import autumn.csv
  sulcus-server class import ids.csv --class \"Year 4 B\" --json

Table: any table of a spreadsheet with a line of headings: sourcedId, givenName, familyName, username, class; or learner (also
id) for ids that exist already. One of learner, sourcedId and username is needed. Other columns, such as email and station,
are not kept. A person without an id gets one, and keeps it at the next import: a second import changes nothing.
Each line gets a verdict: new, kept, renamed, moved or refused. Refused lines change nothing; the others are imported.

Exit codes: 0 success, 1 a line is refused, 2 wrong usage or bad input.";

/// Text after the options of `assign`.
const ASSIGN: &str = "\
Examples:
  sulcus-server class assign \"Year 4 B\" --case case3
  sulcus-server class assign \"Year 4 B\" --exercise probing --mode exam --time-limit-s 1800
  sulcus-server class assign \"Year 4 B\" --learner s-4f7k2 --exercise crown
  sulcus-server class assign \"Year 4 B\" --none

The plan holds from the next session of a learner who is seated or signs in with a code. The own plan of a learner precedes
that of the class. A plan of mode exam begins an exam, sealed until `class release`.";

/// Text after the options of `codes`.
const CODES: &str = "\
Examples:
  sulcus-server class codes \"Year 4 B\" --hours 4
  sulcus-server class codes \"Year 4 B\" --learner s-4f7k2 --json

A learner types the code at a station: `sulcus-client run --code 123456`. Codes are shown once; the state folder has their
hashes. New codes end the old ones of the same learners.";

/// Classes: learners, rosters, plans, codes, seats and exams
#[derive(Clone, Debug, Args)]
#[command(long_about = ABOUT)]
pub struct ClassArgs {
    #[command(subcommand)]
    action: Action,
}

#[derive(Clone, Debug, Subcommand)]
enum Action {
    /// List all classes
    List(PlaceArgs),
    /// Show a class with its learners
    Show(OneArgs),
    /// Import a table of persons and classes, with a verdict for every line
    #[command(after_long_help = IMPORT)]
    Import(ImportArgs),
    /// Make a class, or add a learner to one
    Add(AddArgs),
    /// Give a class another name
    Rename(RenameArgs),
    /// Remove a class, or one learner from it; recordings and names stay
    Remove(RemoveArgs),
    /// Give a class or a learner a plan
    #[command(after_long_help = ASSIGN)]
    Assign(AssignArgs),
    /// Make new codes with which learners sign in at a station
    #[command(after_long_help = CODES)]
    Codes(CodesArgs),
    /// Seat a learner at a station of the running server
    Seat(seat::SeatArgs),
    /// Write ids and names as a table with the columns learner_id and name, for `sulcus-sessions grade --names`
    Names(NamesArgs),
    /// List exams, with their seals
    Exams(PlaceArgs),
    /// Set the day until which instructors see only that an exam exists
    Seal(SealArgs),
    /// Release the results of an exam to its learners, for good
    Release(ReleaseArgs),
    /// Set for how many days the recordings of a class are kept
    Keep(expire::KeepArgs),
    /// Remove the recordings that are older than the limit of their class; grades stay
    #[command(long_about = expire::ABOUT, after_long_help = expire::NOTES)]
    Expire(expire::ExpireArgs),
    /// Say that the session of a recording was that of another learner; the recording stays as it is
    Reassign(ReassignArgs),
}

#[derive(Clone, Debug, Args)]
struct PlaceArgs {
    #[command(flatten)]
    state: StateArgs,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

impl PlaceArgs {
    /// Classes of a folder that is made if missing, for a change.
    fn classes(&self) -> anyhow::Result<Classes> {
        let by = format!("shell (uid {})", rustix::process::geteuid().as_raw());
        Ok(Classes::of(&self.state.open()?, &by))
    }

    /// Classes for a reader, and all that is known; nothing without a folder.
    fn book(&self) -> anyhow::Result<Book> {
        let folder = StateFolder::existing(self.state.folder.as_deref())?;
        let book = folder.map(|folder| Classes::of(&folder, "").load());
        Ok(book.transpose()?.unwrap_or_default())
    }
}

#[derive(Clone, Debug, Args)]
struct OneArgs {
    #[command(flatten)]
    place: PlaceArgs,
    /// Name or id of the class
    class: String,
}

#[derive(Clone, Debug, Args)]
struct ImportArgs {
    #[command(flatten)]
    place: PlaceArgs,
    /// Table as a spreadsheet saves it (CSV)
    file: PathBuf,
    /// Name of the class for lines without one; a missing class is made
    #[arg(long, value_name = "CLASS", default_value = "")]
    class: String,
    /// Print the verdict of every line, and change nothing
    #[arg(long)]
    dry_run: bool,
}

#[derive(Clone, Debug, Args)]
struct AddArgs {
    #[command(flatten)]
    place: PlaceArgs,
    /// Name or id of the class; a missing one is made
    class: String,
    /// Opaque id of a learner to add; without it, and with --username, an id is made
    #[arg(long, value_name = "ID")]
    learner: Option<String>,
    /// Username of a learner in the school's own system
    #[arg(long, value_name = "NAME")]
    username: Option<String>,
    /// Given name of the learner, for the key table
    #[arg(long, value_name = "NAME", default_value = "")]
    given: String,
    /// Family name of the learner, for the key table
    #[arg(long, value_name = "NAME", default_value = "")]
    family: String,
}

#[derive(Clone, Debug, Args)]
struct RenameArgs {
    #[command(flatten)]
    one: OneArgs,
    /// New name
    name: String,
}

#[derive(Clone, Debug, Args)]
struct RemoveArgs {
    #[command(flatten)]
    one: OneArgs,
    /// Opaque id of a learner who leaves the class. Default: the class itself is removed
    #[arg(long, value_name = "ID")]
    learner: Option<String>,
}

#[derive(Clone, Debug, Args)]
struct AssignArgs {
    #[command(flatten)]
    one: OneArgs,
    /// Opaque id of the learner who gets the plan. Default: all learners of the class
    #[arg(long, value_name = "ID")]
    learner: Option<String>,
    /// Exercise: bimanual, crown, probing, retraction or free. Default: probing with a case
    #[arg(long, value_name = "NAME", required_unless_present_any = ["case", "none"])]
    exercise: Option<String>,
    /// Case: a compiled scene `cases/NAME.scene` of the state folder
    #[arg(long, value_name = "NAME")]
    case: Option<String>,
    /// Purpose of the sessions
    #[arg(long, value_enum, default_value = "practice")]
    mode: Mode,
    /// Longest session, seconds
    #[arg(long, value_name = "S", value_parser = clap::value_parser!(u32).range(1..=86_400))]
    time_limit_s: Option<u32>,
    /// Take the plan away: the plan of the class, or of the station, holds again
    #[arg(long, conflicts_with_all = ["exercise", "case", "mode", "time_limit_s"])]
    none: bool,
}

#[derive(Clone, Debug, Args)]
struct CodesArgs {
    #[command(flatten)]
    one: OneArgs,
    /// Opaque id of one learner. Default: all learners of the class
    #[arg(long, value_name = "ID")]
    learner: Option<String>,
    /// Hours for which the codes are valid, 1 to 8784
    #[arg(long, value_name = "H", default_value_t = 4, value_parser = clap::value_parser!(u32).range(1..=i64::from(codes::MOST_HOURS)))]
    hours: u32,
}

#[derive(Clone, Debug, Args)]
struct NamesArgs {
    #[command(flatten)]
    one: OneArgs,
    /// New private file (mode 0600); an existing one is never overwritten
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

#[derive(Clone, Debug, Args)]
struct SealArgs {
    #[command(flatten)]
    place: PlaceArgs,
    /// Id of the exam, such as e-4
    exam: String,
    /// Day such as 2026-12-01, from 00:00 UTC on. Default: until the release
    #[arg(long, value_name = "DAY")]
    until: Option<String>,
}

#[derive(Clone, Debug, Args)]
struct ReleaseArgs {
    #[command(flatten)]
    place: PlaceArgs,
    /// Id of the exam, such as e-4
    exam: String,
}

#[derive(Clone, Debug, Args)]
struct ReassignArgs {
    #[command(flatten)]
    place: PlaceArgs,
    /// File name of the recording, without its folder
    recording: String,
    /// Opaque id of the learner who sat there
    learner: String,
    /// Reason, one line
    #[arg(long, value_name = "TEXT")]
    why: String,
}

/// Runs the command. The exit code is 0, or 1 if a line of a roster is refused.
///
/// # Errors
/// The state folder cannot be used, a value is not valid, or no class, learner or exam has the id.
pub fn run(args: &ClassArgs) -> anyhow::Result<u8> {
    match &args.action {
        Action::List(place) => print::list(&place.book()?, place.json),
        Action::Show(one) => {
            let book = one.place.book()?;
            print::class(&book, found(&book, &one.class)?, one.place.json)
        }
        Action::Import(args) => return import(args),
        Action::Add(args) => add(args)?,
        Action::Rename(args) => {
            let (classes, class) = args.one.opened()?;
            classes.rename(&class.id, &args.name)?;
            told(&args.one.place, "renamed", &class.id);
        }
        Action::Remove(args) => {
            let (classes, class) = args.one.opened()?;
            match &args.learner {
                Some(learner) => classes.drop_from(&class.id, learner, now_s())?,
                None => classes.remove(&class.id, true, now_s())?,
            }
            let id = args.learner.as_ref().unwrap_or(&class.id);
            told(&args.one.place, "removed", id);
        }
        Action::Assign(args) => assign(args)?,
        Action::Codes(args) => make_codes(args)?,
        Action::Seat(args) => seat::run(args)?,
        Action::Names(args) => names(args)?,
        Action::Exams(place) => print::exams(&place.book()?, now_s(), place.json),
        Action::Seal(args) => {
            let day = |text: &String| {
                let found = text.escape_debug();
                parse_day(text).with_context(|| {
                    format!("--until is `{found}`, expected a day such as 2026-12-01")
                })
            };
            let until = args.until.as_ref().map(day).transpose()?;
            args.place.classes()?.seal(&args.exam, until)?;
            let until = until.map_or("the release".into(), minute);
            told(&args.place, &format!("sealed until {until}"), &args.exam);
        }
        Action::Release(args) => {
            args.place.classes()?.release(&args.exam, now_s())?;
            told(&args.place, "released", &args.exam);
        }
        Action::Keep(args) => expire::keep(args)?,
        Action::Expire(args) => expire::expire(args)?,
        Action::Reassign(args) => {
            let classes = args.place.classes()?;
            classes.reassign(&args.recording, &args.learner, &args.why, now_s())?;
            told(
                &args.place,
                &format!("is of {}", args.learner),
                &args.recording,
            );
        }
    }
    Ok(0)
}

impl OneArgs {
    /// Classes for a change, and the class of the command line.
    fn opened(&self) -> anyhow::Result<(Classes, Class)> {
        let classes = self.place.classes()?;
        let class = found(&classes.load()?, &self.class)?.clone();
        Ok((classes, class))
    }
}

/// Class of a name or an id.
fn found<'a>(book: &'a Book, class: &str) -> anyhow::Result<&'a Class> {
    let found = book
        .roll
        .class_named(class)
        .or_else(|| book.roll.class(class));
    found.with_context(|| {
        let known: Vec<&str> = book
            .roll
            .classes
            .iter()
            .map(|one| one.name.as_str())
            .collect();
        let expected = match known.is_empty() {
            true => "no class exists yet; `sulcus-server class add` makes one".to_owned(),
            false => format!("expected one of {}", known.join(", ")),
        };
        format!("class `{}` is unknown, {expected}", class.escape_debug())
    })
}

/// Prints that something was done.
fn told(place: &PlaceArgs, done: &str, id: &str) {
    if place.json {
        say!("{}", json!({ "id": id, "done": done }));
    } else {
        say!("{id}: {done}");
    }
}

fn import(args: &ImportArgs) -> anyhow::Result<u8> {
    let file = args.file.shown();
    let length = std::fs::metadata(&args.file)
        .with_context(|| format!("roster {file}"))?
        .len();
    if length > MOST_BYTES as u64 {
        bail!("roster {file}: {length} bytes long, expected at most 1 MiB");
    }
    let bytes = std::fs::read(&args.file).with_context(|| format!("roster {file}"))?;
    let classes = args.place.classes()?;
    let report = match args.dry_run {
        true => classes.examine(&bytes, &args.class, now_s()),
        false => classes.import(&bytes, &args.class, None, now_s()),
    };
    let report: Report = report.with_context(|| format!("roster {file}"))?;
    let refused = report.count("refused");
    if args.place.json {
        let mut object = serde_json::to_value(&report)?;
        object["imported"] = json!(!args.dry_run);
        say!("{object}");
    } else {
        for line in &report.lines {
            say!("{line}");
        }
        let (new, kept) = (report.count("new"), report.count("kept"));
        let (renamed, moved) = (report.count("renamed"), report.count("moved"));
        say!("{new} new, {kept} kept, {renamed} renamed, {moved} moved, {refused} refused");
        for class in &report.new_classes {
            say!("new class: {}", class.escape_debug());
        }
        if report.absent > 0 {
            say!(
                "{} learners of these classes are not in the table; they stay",
                report.absent
            );
        }
        if args.dry_run {
            tell!("dry run: nothing is changed");
        }
    }
    Ok(u8::from(refused > 0))
}

fn add(args: &AddArgs) -> anyhow::Result<()> {
    let classes = args.place.classes()?;
    let has_learner = args.learner.is_some() || args.username.is_some();
    let has_name = !args.given.is_empty() || !args.family.is_empty();
    if has_name && !has_learner {
        bail!("a name is given without --learner or --username; one of them is needed");
    }
    let class = found(&classes.load()?, &args.class)
        .ok()
        .map(|class| class.id.clone());
    let class = match class {
        Some(class) if has_learner => class,
        // The name is taken, which the list says.
        _ => classes.make(&args.class, now_s())?,
    };
    if !has_learner {
        told(&args.place, "made", &class);
        return Ok(());
    }
    let row = Row {
        learner: args.learner.clone().unwrap_or_default(),
        username: args.username.clone().unwrap_or_default(),
        given: args.given.clone(),
        family: args.family.clone(),
        ..Row::default()
    };
    let line = classes.add(&class, &row, now_s())?;
    told(
        &args.place,
        &format!("{} in {class}", line.verdict.word()),
        &line.learner,
    );
    Ok(())
}

/// The class, or one of its learners.
fn target(book: &Book, class: &Class, learner: Option<&String>) -> anyhow::Result<Target> {
    let Some(id) = learner else {
        return Ok(Target::Class(class.id.clone()));
    };
    let is_there = book
        .roll
        .learner(id)
        .is_some_and(|one| one.class == class.id);
    if !is_there {
        bail!(
            "learner `{}` is not in class {}",
            id.escape_debug(),
            class.name
        );
    }
    Ok(Target::Learner(id.clone()))
}

fn assign(args: &AssignArgs) -> anyhow::Result<()> {
    let (classes, class) = args.one.opened()?;
    let target = target(&classes.load()?, &class, args.learner.as_ref())?;
    let wanted = (!args.none).then(|| Wanted {
        exercise: args.exercise.clone().unwrap_or_else(|| "probing".into()),
        case: args.case.clone(),
        mode: args.mode,
        time_limit_s: args.time_limit_s,
    });
    classes.assign(&target, wanted.as_ref(), true, now_s())?;
    let words = wanted.map_or("no plan of its own".into(), |wanted| wanted.words());
    told(&args.one.place, &words, target.id());
    if !args.one.place.json {
        let known = cases(classes.folder())?;
        tell!(
            "exercises: {}; cases: {}",
            exercises().join(", "),
            match known.is_empty() {
                true => "none".to_owned(),
                false => known.join(", "),
            }
        );
    }
    Ok(())
}

fn make_codes(args: &CodesArgs) -> anyhow::Result<()> {
    let (classes, class) = args.one.opened()?;
    let target = target(&classes.load()?, &class, args.learner.as_ref())?;
    let made = classes.make_codes(&target, args.hours, now_s())?;
    print::cards(&classes.load()?, &made, args.one.place.json);
    Ok(())
}

fn names(args: &NamesArgs) -> anyhow::Result<()> {
    let (classes, class) = args.one.opened()?;
    let book = classes.load()?;
    if !book.names.is_open {
        bail!("the key table names.json is not in the state folder, or has no names yet");
    }
    let table = print::names(&book, &class);
    let by = format!("shell (uid {})", rustix::process::geteuid().as_raw());
    classes
        .audit()
        .record(&by, "read names", &format!("class {}", class.id))?;
    create_private(&args.out, table.as_bytes())?;
    told(
        &args.one.place,
        &format!("names in {}", args.out.shown()),
        &class.id,
    );
    Ok(())
}
