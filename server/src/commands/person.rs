//! `sulcus-server person`: persons who sign in to the console with a name and a password.

use std::io::Read as _;

use clap::{Args, Subcommand};
use serde_json::{Value, json};
use sulcus_program::{say, tell};
use sulcus_proto::Role;

use super::StateArgs;
use crate::state::StateFolder;
use crate::state::date::{DAY_S, day, now_s};
use crate::state::people::{Password, People};
use crate::state::tokens::{NewToken, Place, TokenStore};

/// Long text of the help.
const ABOUT: &str = "\
Add, list and remove persons who sign in to the console with a name and a password.

A person has a token: role, stations and end are those of the token, and recordings have the token's id, never the name.
A running server notices every change at once.";

/// Text after the options of `add`.
const ADD: &str = "\
Examples:
  sulcus-server person add mueller --role instructor
  pass show school/mueller | sulcus-server person add mueller --role instructor --password-stdin
  sulcus-server person add stiller --role examiner --station room3-1

Without --password-stdin the program makes a password and prints it once.";

/// Longest password of standard input with its line feed, bytes.
const LONGEST: u64 = 1024;

/// Add, list and remove persons of the console
#[derive(Clone, Debug, Args)]
#[command(long_about = ABOUT)]
pub struct PersonArgs {
    #[command(subcommand)]
    action: Action,
}

#[derive(Clone, Debug, Subcommand)]
enum Action {
    /// Add a person
    #[command(after_long_help = ADD)]
    Add(AddArgs),
    /// Give a person another password
    Password(PasswordArgs),
    /// List all persons; no hash is printed
    List(ListArgs),
    /// Remove a person and revoke the token: open pages end within a second
    Remove(RemoveArgs),
}

#[derive(Clone, Debug, Args)]
struct AddArgs {
    #[command(flatten)]
    state: StateArgs,
    /// Login name: 1 to 32 small letters, digits, `.`, `-` or `_`, a letter first
    login: String,
    /// Rights: instructor, examiner or admin
    #[arg(long, value_name = "ROLE")]
    role: Role,
    /// Station to which the rights are limited. Default: every station
    #[arg(long, value_name = "NAME")]
    station: Option<String>,
    /// Days until the end, 1 to 3650
    #[arg(long, value_name = "DAYS", default_value_t = 365, value_parser = clap::value_parser!(u16).range(1..=3650))]
    expires: u16,
    /// Read the password from standard input, one line of 10 to 256 bytes
    #[arg(long)]
    password_stdin: bool,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Debug, Args)]
struct PasswordArgs {
    #[command(flatten)]
    state: StateArgs,
    /// Login name
    login: String,
    /// Read the password from standard input, one line of 10 to 256 bytes
    #[arg(long)]
    password_stdin: bool,
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
struct RemoveArgs {
    #[command(flatten)]
    state: StateArgs,
    /// Login name
    login: String,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// Runs the command.
///
/// # Errors
/// The state folder cannot be used, or a value is not valid.
pub fn run(args: &PersonArgs) -> anyhow::Result<u8> {
    match &args.action {
        Action::Add(args) => add(args),
        Action::Password(args) => set_password(args),
        Action::List(args) => list(args),
        Action::Remove(args) => remove(args),
    }
}

/// Password of standard input, or a made one.
fn password(is_read: bool) -> anyhow::Result<Password> {
    if !is_read {
        return Ok(Password::made()?);
    }
    let mut text = String::new();
    std::io::stdin().take(LONGEST).read_to_string(&mut text)?;
    let line = text.strip_suffix('\n').unwrap_or(&text);
    let line = line.strip_suffix('\r').unwrap_or(line);
    Password::new(line).map_err(anyhow::Error::msg)
}

fn add(args: &AddArgs) -> anyhow::Result<u8> {
    if args.role.is_of_one_station() {
        anyhow::bail!(
            "--role is {}, expected instructor, examiner or admin; a student has a token: `sulcus-server token add`",
            args.role
        );
    }
    let folder = args.state.open()?;
    let people = People::of(&folder);
    people.check_new(&args.login)?;
    let password = password(args.password_stdin)?;
    let now = now_s();
    let made = made(
        &folder,
        &args.login,
        args.role,
        args.station.as_deref(),
        args.expires,
        &password,
        now,
    )?;
    let shown = (!args.password_stdin).then(|| password.reveal());
    if args.json {
        say!(
            "{}",
            json!({ "login": args.login, "token": made, "role": args.role, "password": shown })
        );
        return Ok(0);
    }
    tell!(
        "person {} has token {made}: {}; the password is shown once",
        args.login,
        args.role
    );
    if let Some(password) = shown {
        say!("{password}");
    }
    Ok(0)
}

/// Adds a person with a new token, all or nothing. Returns the token's id.
///
/// # Errors
/// A value is not valid, or a file cannot be written.
pub(crate) fn made(
    folder: &StateFolder,
    login: &str,
    role: Role,
    station: Option<&str>,
    days: u16,
    password: &Password,
    now: u64,
) -> anyhow::Result<String> {
    let people = People::of(folder);
    people.check_new(login)?;
    let new = NewToken {
        role,
        station: station.map_or(Place::Any, |name| Place::Station(name.to_owned())),
        learner: String::new(),
        class: String::new(),
        expires_unix_s: now + u64::from(days) * DAY_S,
    };
    new.check().map_err(anyhow::Error::msg)?;
    let store = TokenStore::of(folder);
    // Nobody knows the secret of this token: the password alone opens it.
    let token = store.add(&[new], now)?.remove(0).0.id;
    if let Err(error) = people.add(login, &token, password, now) {
        store.revoke(&token, now)?;
        return Err(error.into());
    }
    Ok(token)
}

fn set_password(args: &PasswordArgs) -> anyhow::Result<u8> {
    let people = People::of(&args.state.open()?);
    let password = password(args.password_stdin)?;
    people.set_password(&args.login, &password, now_s())?;
    let shown = (!args.password_stdin).then(|| password.reveal());
    if args.json {
        say!("{}", json!({ "login": args.login, "password": shown }));
    } else if let Some(password) = shown {
        tell!("new password of {}, shown once:", args.login);
        say!("{password}");
    }
    Ok(0)
}

fn list(args: &ListArgs) -> anyhow::Result<u8> {
    let now = now_s();
    let folder = StateFolder::existing(args.state.folder.as_deref())?;
    let (people, tokens) = match folder {
        Some(folder) => (People::of(&folder).list()?, TokenStore::of(&folder).list()?),
        None => (Vec::new(), Vec::new()),
    };
    let token = |id: &str| tokens.iter().find(|token| token.id == id);
    if args.json {
        let all: Vec<Value> = people
            .iter()
            .map(|person| {
                let found = token(&person.token);
                json!({
                    "login": person.login, "token": person.token,
                    "role": found.map(|token| token.role),
                    "station": found.map(|token| &token.station),
                    "valid": found.is_some_and(|token| token.is_valid(now)),
                    "changed_unix_s": person.changed_unix_s,
                })
            })
            .collect();
        say!("{}", json!({ "people": all }));
        return Ok(0);
    }
    if people.is_empty() {
        tell!("no persons; `sulcus-server person add` adds one");
        return Ok(0);
    }
    say!(
        "{:32} {:8} {:10} {:20} state",
        "login",
        "token",
        "role",
        "station"
    );
    for person in &people {
        match token(&person.token) {
            Some(found) => {
                let state = if found.is_valid(now) {
                    format!("valid until {}", day(found.expires_unix_s))
                } else {
                    "no longer valid".to_owned()
                };
                say!(
                    "{:32} {:8} {:10} {:20} {state}",
                    person.login,
                    person.token,
                    found.role,
                    found.station
                );
            }
            None => say!("{:32} {:8} without a token", person.login, person.token),
        }
    }
    Ok(0)
}

fn remove(args: &RemoveArgs) -> anyhow::Result<u8> {
    let folder = args.state.open()?;
    let token = People::of(&folder).remove(&args.login)?;
    // A token that was removed from its file is no longer valid either.
    let revoked = TokenStore::of(&folder).revoke(&token, now_s()).is_ok();
    if args.json {
        say!(
            "{}",
            json!({ "login": args.login, "token": token, "revoked": revoked })
        );
    } else {
        say!("person {} is removed, token {token} is revoked", args.login);
    }
    Ok(0)
}
