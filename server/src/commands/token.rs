//! `sulcus-server token`: makes, lists and revokes tokens.

use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use clap::{Args, Subcommand};
use serde_json::{Value, json};
use sulcus_program::{PathText, say, tell};
use sulcus_proto::{Role, Ticket, learner};

use super::StateArgs;
use crate::state::date::{DAY_S, day, now_s};
use crate::state::roster::{Import, Line, Roster, Verdict};
use crate::state::tokens::{NewToken, Place, TokenRecord, TokenStore};
use crate::state::{ServerIdentity, StateFolder, create_private};

/// Long text of the help.
const ABOUT: &str = "\
Make, list and revoke tokens.

A token is a random secret with a role, a station and an end. Its ticket, TOKEN.FINGERPRINT, is shown once; the state folder
keeps a hash alone. A running server notices every change at once.";

/// Text after the options of `add`.
const ADD: &str = "\
Examples:
  sulcus-server token add --role instructor
  sulcus-server token add --role student --station room3-1 --learner s-17 --out ticket.txt
  sulcus-server token add --class roster.csv --check           every line of the roster, nothing is made
  sulcus-server token add --class roster.csv --out tickets.csv

Roster: a table with the columns `learner` (or `id`) and `station`, as spreadsheets save it. Learner ids are opaque, never
names: letters, digits, - and _, one digit at least. A second import makes tokens only for lines that have none; a learner
at another station gets a new token, and the old one is revoked.
Tickets: the file of --out is private (mode 0600) and never overwritten. Columns: learner, station, ticket.

Exit codes: 0 success, 1 the roster of --check has a fault, 2 wrong usage or bad input.";

/// Make, list and revoke tokens
#[derive(Clone, Debug, Args)]
#[command(long_about = ABOUT)]
pub struct TokenArgs {
    #[command(subcommand)]
    action: Action,
}

#[derive(Clone, Debug, Subcommand)]
enum Action {
    /// Make a token, or the tokens of a class
    #[command(after_long_help = ADD)]
    Add(Box<AddArgs>),
    /// List all tokens with role, station and dates; neither a token nor a hash is printed
    List(ListArgs),
    /// Revoke a token; a running server refuses it from now on
    Revoke(RevokeArgs),
}

#[derive(Clone, Debug, Args)]
struct AddArgs {
    #[command(flatten)]
    state: StateArgs,
    /// Rights of the holder: student, display, instructor, examiner or admin
    #[arg(long, value_name = "ROLE", required_unless_present = "class")]
    role: Option<Role>,
    /// Station that the token opens. Default: `station` for a student and a display, else every station
    #[arg(long, value_name = "NAME", conflicts_with = "class")]
    station: Option<String>,
    /// Opaque learner id of a student, never a name
    #[arg(long, value_name = "ID", default_value = "", value_parser = learner::parse, conflicts_with = "class")]
    learner: String,
    /// Days until the end of the token, 1 to 3650
    #[arg(long, value_name = "DAYS", default_value_t = 365, value_parser = clap::value_parser!(u16).range(1..=3650))]
    expires: u16,
    /// Roster of a class: a token for each student
    #[arg(long, value_name = "ROSTER.csv")]
    class: Option<PathBuf>,
    /// Name of the class in the list of tokens. Default: name of the roster's file without its ending
    #[arg(long, value_name = "NAME", requires = "class")]
    class_name: Option<String>,
    /// Make new tokens for learners who have one; the old ones are revoked
    #[arg(long, requires = "class")]
    renew: bool,
    /// Say for every line of the roster what an import would do, and make nothing
    #[arg(long, requires = "class")]
    check: bool,
    /// New private file for the ticket, or for the table of a class. Default: standard output, for one ticket
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
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
struct RevokeArgs {
    #[command(flatten)]
    state: StateArgs,
    /// Id of the token, such as t-7f3a
    id: String,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// Name of the station of `serve` without a file of stations.
const STATION: &str = "station";

/// Runs the command. The exit code is 0, or 1 if a checked roster has a fault.
///
/// # Errors
/// The state folder cannot be used, a value is not valid, or no token has the id.
pub fn run(args: &TokenArgs) -> anyhow::Result<u8> {
    match &args.action {
        Action::Add(args) => match &args.class {
            Some(roster) => add_class(args, roster),
            None => add_one(args),
        },
        Action::List(args) => list(args),
        Action::Revoke(args) => revoke(args),
    }
}

fn add_one(args: &AddArgs) -> anyhow::Result<u8> {
    let role = args.role.context("--role is missing")?;
    let now = now_s();
    let station = match args.station.as_deref() {
        Some("any") => Place::Any,
        Some(name) => Place::Station(name.to_owned()),
        None if role.is_of_one_station() => Place::Station(STATION.into()),
        None => Place::Any,
    };
    let new = NewToken {
        role,
        station,
        learner: args.learner.clone(),
        class: String::new(),
        expires_unix_s: now + u64::from(args.expires) * DAY_S,
    };
    new.check().map_err(anyhow::Error::msg)?;
    let folder = args.state.open()?;
    let identity = ServerIdentity::load_or_create(&folder, now)?;
    let store = TokenStore::of(&folder);
    let made = store.add(&[new], now)?;
    let (record, secret) = made.first().context("no token was made")?;
    let ticket = Ticket {
        token: secret.reveal().to_owned(),
        fingerprint: identity.fingerprint(),
    };
    if let Some(path) = &args.out {
        let written = create_private(path, format!("{ticket}\n").as_bytes());
        if let Err(error) = written {
            // A token that nobody has received must not stay valid.
            store.revoke(&record.id, now)?;
            return Err(error.into());
        }
    }
    let shown = args.out.is_none().then(|| ticket.to_string());
    if args.json {
        let mut object = public(record, now);
        object["ticket"] = json!(shown);
        object["out"] = json!(args.out.as_ref().map(|path| path.shown().to_string()));
        say!("{object}");
        return Ok(0);
    }
    let on = day(record.expires_unix_s);
    let (id, station) = (&record.id, &record.station);
    tell!("token {id}: {role}, station {station}, valid until {on}; the ticket is shown once");
    match (shown, &args.out) {
        (Some(ticket), _) => say!("{ticket}"),
        (None, Some(path)) => tell!("the ticket is in {}", path.shown()),
        (None, None) => {}
    }
    Ok(0)
}

fn add_class(args: &AddArgs, path: &Path) -> anyhow::Result<u8> {
    if let Some(role) = args.role.filter(|role| *role != Role::Student) {
        bail!("--role is {role}, expected student with --class");
    }
    let roster = Roster::open(path).map_err(anyhow::Error::msg)?;
    let class = class_name(args, path);
    let now = now_s();
    let mut import = Import {
        class: &class,
        expires_unix_s: now + u64::from(args.expires) * DAY_S,
        renew: args.renew,
        fingerprint: [0; 32],
    };
    let tokens = match StateFolder::existing(args.state.folder.as_deref())? {
        Some(folder) => TokenStore::of(&folder).list()?,
        None => Vec::new(),
    };
    let lines = roster.examine(&tokens, &import, now);
    let is_faulty = lines
        .iter()
        .any(|line| matches!(line.verdict, Verdict::Fault { .. }));
    if args.check || is_faulty {
        say_lines(&lines, &class, None, args.json);
        if args.check {
            return Ok(u8::from(is_faulty));
        }
        bail!(
            "nothing was made: correct the lines of {} first",
            path.shown()
        );
    }
    let out = args
        .out
        .as_ref()
        .context("--out is missing, expected a file for the tickets of the class")?;
    if makes(&lines) == 0 {
        say_lines(&lines, &class, None, args.json);
        tell!("every learner has a token; --renew makes new ones");
        return Ok(0);
    }
    let folder = args.state.open()?;
    import.fingerprint = ServerIdentity::load_or_create(&folder, now)?.fingerprint();
    let lines = roster.import(&TokenStore::of(&folder), &import, out, now)?;
    say_lines(&lines, &class, Some(out), args.json);
    Ok(0)
}

/// Number of lines for which a token is made.
fn makes(lines: &[Line]) -> usize {
    let makes = |line: &&Line| matches!(line.verdict, Verdict::New | Verdict::Replaces { .. });
    lines.iter().filter(makes).count()
}

fn say_lines(lines: &[Line], class: &str, out: Option<&Path>, json: bool) {
    let made = makes(lines);
    let kept = lines
        .iter()
        .filter(|line| matches!(line.verdict, Verdict::Kept { .. }))
        .count();
    let faults = lines.len() - made - kept;
    if json {
        let out = out.map(|path| path.shown().to_string());
        say!(
            "{}",
            json!({
                "class": class, "new": made, "kept": kept, "faults": faults, "lines": lines,
                "out": out,
            })
        );
        return;
    }
    for line in lines {
        say!("{line}");
    }
    let faulty = match faults {
        0 => String::new(),
        1 => ", 1 line with a fault".into(),
        n => format!(", {n} lines with a fault"),
    };
    say!("class {class}: {made} new tokens, {kept} kept{faulty}");
    if let Some(path) = out {
        say!("tickets of the new tokens: {}", path.shown());
    }
}

/// Name of the class: given, or the roster's file name without its ending.
fn class_name(args: &AddArgs, path: &Path) -> String {
    let stem = || {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let plain = stem.chars().filter(|c| !c.is_control());
        plain.take(64).collect()
    };
    args.class_name.clone().unwrap_or_else(stem)
}

fn list(args: &ListArgs) -> anyhow::Result<u8> {
    let tokens = match StateFolder::existing(args.state.folder.as_deref())? {
        Some(folder) => TokenStore::of(&folder).list()?,
        None => Vec::new(),
    };
    let now = now_s();
    if args.json {
        let all: Vec<Value> = tokens.iter().map(|token| public(token, now)).collect();
        say!("{}", json!({ "tokens": all }));
        return Ok(0);
    }
    if tokens.is_empty() {
        tell!("no tokens; `sulcus-server token add` makes one");
        return Ok(0);
    }
    say!(
        "{:8} {:10} {:20} {:16} {:20} state",
        "id",
        "role",
        "station",
        "learner",
        "class"
    );
    for token in &tokens {
        say!(
            "{:8} {:10} {:20} {:16} {:20} {}",
            token.id,
            token.role,
            token.station,
            token.learner,
            token.class,
            state(token, now)
        );
    }
    Ok(0)
}

fn revoke(args: &RevokeArgs) -> anyhow::Result<u8> {
    let now = now_s();
    let token = TokenStore::of(&args.state.open()?).revoke(&args.id, now)?;
    if args.json {
        say!("{}", public(&token, now));
    } else {
        say!("token {}: {}", token.id, state(&token, now));
    }
    Ok(0)
}

/// State of a token in words.
fn state(token: &TokenRecord, now_s: u64) -> String {
    match token.revoked_unix_s {
        Some(revoked) => format!("revoked on {}", day(revoked)),
        None if token.is_valid(now_s) => format!("valid until {}", day(token.expires_unix_s)),
        None => format!("expired on {}", day(token.expires_unix_s)),
    }
}

/// Token as JSON, without its hash.
fn public(token: &TokenRecord, now_s: u64) -> Value {
    json!({
        "id": token.id, "role": token.role, "station": token.station, "learner": token.learner,
        "class": token.class, "created_unix_s": token.created_unix_s,
        "expires_unix_s": token.expires_unix_s, "revoked_unix_s": token.revoked_unix_s,
        "valid": token.is_valid(now_s),
    })
}
