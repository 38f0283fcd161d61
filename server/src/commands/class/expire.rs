//! `sulcus-server class keep` and `expire`: for how long the recordings of a class are kept.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use anyhow::bail;
use clap::Args;
use serde_json::{Value, json};
use sulcus_program::{PathText, say, tell};
use sulcus_proto::station::StationStatus;

use super::{OneArgs, PlaceArgs, told};
use crate::control_socket::{Request, ask};
use crate::plan::StationsFile;
use crate::recordings::expiry::{Expiry, Judged, Kept, began_s, file_name};
use crate::state::StateFolder;
use crate::state::classes::Roll;
use crate::state::classes::archive::kept_words;
use crate::state::date::{day, now_s};

/// Most days of a limit.
const MOST_DAYS: u32 = 36_500;

/// Long text of the help of `expire`.
pub(super) const ABOUT: &str = "\
Remove the recordings of classes that keep them for some days only (`class keep`). Nothing is removed without this command.

A recording is removed when its learner was in the class at its begin, and its begin is older than the limit. These stay:
exams before their release, norms, sessions that run or may go on, recordings from the future, and files without a known
learner. Grades, sheets and scores of persons (*.mcap.grade.json, and grades/ of the state folder) always stay, and the pages
of results show them further on. Every removed file has an entry in audit.jsonl.

A clock that is earlier than the newest entries of audit.jsonl or the newest recording is refused. So is a clock that is more
than 400 days later than all of them.";

/// Text after the options of `expire`.
pub(super) const NOTES: &str = "\
Examples:
  sulcus-server class keep \"Year 4 B\" 400
  sulcus-server class expire --config /srv/sulcus/stations.toml --dry-run
  sulcus-server class expire --config /srv/sulcus/stations.toml

Exit codes: 0 success, 2 wrong usage, bad input, or a clock that is refused.";

#[derive(Clone, Debug, Args)]
pub(super) struct KeepArgs {
    #[command(flatten)]
    one: OneArgs,
    /// Days after the begin of a session, 1 to 36500, or `forever`
    #[arg(value_name = "DAYS|forever", value_parser = limit)]
    keep: Limit,
}

/// Days; `None`: forever.
#[derive(Clone, Copy, Debug)]
struct Limit(Option<u32>);

fn limit(text: &str) -> Result<Limit, String> {
    if text == "forever" {
        return Ok(Limit(None));
    }
    match text.parse() {
        Ok(days) if (1..=MOST_DAYS).contains(&days) => Ok(Limit(Some(days))),
        _ => Err(format!("expected 1 to {MOST_DAYS} days, or `forever`")),
    }
}

#[derive(Clone, Debug, Args)]
pub(super) struct ExpireArgs {
    #[command(flatten)]
    place: PlaceArgs,
    /// File of stations, which names the folder of recordings
    #[arg(long, value_name = "FILE", required_unless_present = "recordings")]
    config: Option<PathBuf>,
    /// Folder of recordings
    #[arg(long, value_name = "DIR", conflicts_with = "config")]
    recordings: Option<PathBuf>,
    /// Print what would be removed, and change nothing
    #[arg(long)]
    dry_run: bool,
    /// A person has checked the clock of this machine: compare it with nothing
    #[arg(long)]
    clock_checked: bool,
}

/// Sets the limit of a class, which may be archived.
pub(super) fn keep(args: &KeepArgs) -> anyhow::Result<()> {
    let classes = args.one.place.classes()?;
    let id = any_class(&classes.roll()?, &args.one.class)?;
    classes.keep_recordings(&id, args.keep.0)?;
    let words = format!("recordings are kept {}", kept_for(args.keep.0));
    told(&args.one.place, &words, &id);
    Ok(())
}

fn kept_for(days: Option<u32>) -> String {
    let words = kept_words(days);
    days.map_or(words.clone(), |_| format!("for {words}"))
}

/// Id of a present or an archived class.
fn any_class(roll: &Roll, name: &str) -> anyhow::Result<String> {
    if let Some(class) = roll.class_named(name).or_else(|| roll.class(name)) {
        return Ok(class.id.clone());
    }
    let by_id = roll.archived_class(name);
    let all: Vec<_> = by_id.into_iter().chain(roll.archived_named(name)).collect();
    match all.as_slice() {
        [class] => Ok(class.id.clone()),
        [] => bail!(
            "class `{}` is unknown; `sulcus-server class list` lists the classes",
            name.escape_debug()
        ),
        several => {
            let ids: Vec<&str> = several.iter().map(|class| class.id.as_str()).collect();
            bail!(
                "class `{}` is the name of several archived classes, expected one of the ids {}",
                name.escape_debug(),
                ids.join(", ")
            )
        }
    }
}

/// Removes what is older than the limits.
pub(super) fn expire(args: &ExpireArgs) -> anyhow::Result<()> {
    let asked = args.place.state.folder.as_deref();
    let Some(folder) = StateFolder::existing(asked)? else {
        let path = StateFolder::locate(asked)?;
        bail!(
            "the state folder {} does not exist, expected that of a server",
            path.shown()
        );
    };
    let recordings = recordings(args)?;
    if !recordings.is_dir() {
        bail!(
            "the folder of recordings {} does not exist",
            recordings.shown()
        );
    }
    let by = format!("shell (uid {})", rustix::process::geteuid().as_raw());
    let expiry = Expiry {
        state: &folder,
        recordings: &recordings,
        by: &by,
        open: open(&folder)?,
    };
    let now = now_s();
    let judged = expiry.judged(now)?;
    if !args.clock_checked {
        expiry.check_clock(&judged, now)?;
    }
    let removed = match args.dry_run {
        true => 0,
        false => expiry.remove(&judged, now)?,
    };
    shown(args, &judged, removed);
    Ok(())
}

fn recordings(args: &ExpireArgs) -> anyhow::Result<PathBuf> {
    if let Some(folder) = &args.recordings {
        return Ok(folder.clone());
    }
    let file = args.config.as_deref().unwrap_or(Path::new(""));
    match StationsFile::open(file)?.recordings {
        Some(folder) => Ok(folder),
        None => bail!(
            "{} names no folder of recordings; give --recordings",
            file.shown()
        ),
    }
}

/// Names of the recordings of running sessions, and of those that were interrupted and may go on.
fn open(folder: &StateFolder) -> anyhow::Result<BTreeSet<String>> {
    let mut names = BTreeSet::new();
    if let Some(mut answer) = ask(folder, &Request::Status {})? {
        let statuses: Vec<StationStatus> = serde_json::from_value(answer["stations"].take())?;
        names.extend(statuses.into_iter().map(|status| status.recording));
    }
    let notes = std::fs::read_dir(folder.file("running"));
    for note in notes.into_iter().flatten().flatten() {
        let text = std::fs::read(note.path()).unwrap_or_default();
        let note: Value = serde_json::from_slice(&text).unwrap_or_default();
        names.extend(note["recording"].as_str().map(str::to_owned));
    }
    Ok(names)
}

fn shown(args: &ExpireArgs, judged: &[Judged], removed: usize) {
    let mut kept: BTreeMap<Kept, usize> = BTreeMap::new();
    for one in judged {
        if let Err(why) = one.verdict {
            *kept.entry(why).or_default() += 1;
        }
    }
    if args.place.json {
        let session = |one: &Judged| {
            let files: Vec<String> = one.files.iter().map(|file| file_name(file)).collect();
            let (class, why) = match &one.verdict {
                Ok((class, _)) => (Some(class.clone()), None),
                Err(why) => (None, Some(why.to_string())),
            };
            json!({ "files": files, "learner": one.learner, "began_unix_s": began_s(&one.entry),
                "removed_by_class": class, "kept": why })
        };
        let sessions: Vec<Value> = judged.iter().map(session).collect();
        say!(
            "{}",
            json!({ "sessions": sessions, "removed": removed, "dry_run": args.dry_run })
        );
        return;
    }
    for one in judged {
        let began = day(began_s(&one.entry));
        for file in &one.files {
            let head = format!("{} of {}, {began}", file_name(file), one.learner);
            match &one.verdict {
                Ok((class, days)) => {
                    let limit = kept_words(Some(*days));
                    say!("remove {head}: class {class} keeps {limit}");
                }
                // Sessions beyond their limit, or nearly so, deserve a line of their own.
                Err(why @ (Kept::Exam | Kept::Norm | Kept::Open | Kept::Shared | Kept::Future)) => {
                    say!("keep   {head}: {why}");
                }
                Err(_) => {}
            }
        }
    }
    for (why, count) in kept {
        say!("kept: {count}, {why}");
    }
    match args.dry_run {
        true => tell!("dry run: nothing is changed"),
        false => say!("removed: {removed}"),
    }
}
