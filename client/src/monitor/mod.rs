//! `sulcus-client monitor`: all stations of a server in a terminal, with instructions typed as lines.

mod table;
mod typed;

use std::io::{BufRead, IsTerminal};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::time::{Duration, Instant};

use anyhow::{Context, bail};
use serde_json::json;
use sulcus_connection::instructor::{Heard, Instructor};
use sulcus_connection::interrupt;
use sulcus_connection::link::{LinkConfig, LinkError};
use sulcus_program::{say, tell};
use sulcus_proto::Role;
use sulcus_proto::control::Answer;

use crate::cli::MonitorArgs;
use crate::join::{resolve, ticket};
use table::Table;
use typed::{FORM, Typed};

/// Roles that may watch stations, in the order of the attempts: the client does not know the role of its token.
const ROLES: [Role; 3] = [Role::Instructor, Role::Examiner, Role::Admin];
/// Longest wait for a message.
const WAIT: Duration = Duration::from_millis(100);
/// Time between two tables in a terminal, which are drawn over each other.
const REDRAWN: Duration = Duration::from_millis(250);
/// Time between two tables in a file or a pipe.
const PRINTED: Duration = Duration::from_secs(5);
/// Timeout of the first status of every station.
const FIRST: Duration = Duration::from_secs(5);

/// Shows all stations until Ctrl-C. The exit code is 0, or 1 if the server was lost.
///
/// # Errors
/// Bad input, a server that does not answer or refuses.
pub fn run(args: &MonitorArgs) -> anyhow::Result<u8> {
    let mut instructor = connect(args)?;
    let welcome = instructor.welcome().clone();
    let mut table = Table::new(&welcome.stations);
    let lines = if args.once { None } else { Some(listen()?) };
    let drawn = !args.json && !args.once && std::io::stdout().is_terminal();
    let every = if drawn { REDRAWN } else { PRINTED };
    let begin = Instant::now();
    let mut next = begin;
    if drawn {
        tell!(
            "{} of {} stations; lines: {FORM}",
            welcome.role,
            welcome.stations.len()
        );
    }
    loop {
        let now_ms = || u64::try_from(begin.elapsed().as_millis()).unwrap_or(u64::MAX);
        match instructor.next(WAIT) {
            Some(Heard::Status(status)) => {
                let name = status.station.clone();
                table.status(*status, now_ms());
                if args.json
                    && let Some(row) = table.row(&name)
                {
                    say!("{}", json!({ "status": row.status, "alerts": row.alerts }));
                }
            }
            Some(Heard::Event(event)) => {
                if args.json {
                    say!("{}", json!({ "event": event }));
                }
                let line = table::event(&event, now_ms());
                show(line, args, drawn, &mut table);
            }
            None => {
                if let Some(error) = instructor.ended() {
                    tell!("error: {error}");
                    return Ok(1);
                }
            }
        }
        if args.once && table.is_whole() {
            if !args.json {
                table.lines().iter().for_each(|line| say!("{line}"));
            }
            return Ok(0);
        }
        if args.once && begin.elapsed() > FIRST {
            bail!(
                "the server sent no status of {} within 5 s",
                table.missing().join(", ")
            );
        }
        if interrupt::asked() {
            return Ok(0);
        }
        let typed = lines
            .as_ref()
            .map_or(Err(TryRecvError::Empty), Receiver::try_recv);
        match typed.as_deref().map(typed::parse) {
            Ok(Ok(None)) | Err(_) => {}
            Ok(Ok(Some(Typed::Quit))) => return Ok(0),
            Ok(Ok(Some(Typed::Instruct {
                station,
                instruction,
            }))) => {
                let answer = instructor.instruct(&station, instruction);
                match answer {
                    Ok(answer) => {
                        if args.json {
                            say!("{}", json!({ "answer": answer, "station": station }));
                        }
                        show(answered(&station, &answer), args, drawn, &mut table);
                    }
                    Err(error) => {
                        tell!("error: {error}");
                        return Ok(1);
                    }
                }
            }
            Ok(Err(why)) => {
                if args.json {
                    say!("{}", json!({ "error": why }));
                }
                show(format!("error: {why}"), args, drawn, &mut table);
            }
        }
        if !args.json && !args.once && Instant::now() >= next && table.is_whole() {
            next = Instant::now() + every;
            if drawn {
                // Home, then each line with the rest of its row cleared, then the rest of the screen.
                let text: Vec<String> = table
                    .screen()
                    .iter()
                    .map(|line| format!("{line}\x1b[K"))
                    .collect();
                say!("\x1b[H{}\x1b[J", text.join("\n"));
            } else {
                table.lines().iter().for_each(|line| say!("{line}"));
            }
        }
    }
}

/// Connection with the first role that the token has.
fn connect(args: &MonitorArgs) -> anyhow::Result<Instructor> {
    let (server, others) = resolve(&args.server)?;
    let ticket = ticket(args.ticket.as_deref()).context(
        "the ticket is missing: give an instructor's ticket with --ticket or SULCUS_TICKET; `sulcus-server token add --role instructor` makes one",
    )?;
    let config = LinkConfig {
        others,
        ..LinkConfig::new(server, &ticket.parse()?, "")
    };
    let mut refused = None;
    for role in ROLES {
        match Instructor::connect(LinkConfig {
            role,
            ..config.clone()
        }) {
            Err(error @ LinkError::Refused(_)) => refused = refused.or(Some(error)),
            other => return other.with_context(|| format!("server `{}`", args.server)),
        }
    }
    let why = refused.map_or_else(String::new, |error| error.to_string());
    bail!(
        "server `{}`: {why}; monitor needs the ticket of an instructor, an examiner or an admin",
        args.server
    )
}

/// Reads lines of standard input on a thread of its own, which ends with the program.
fn listen() -> anyhow::Result<Receiver<String>> {
    let (send, lines) = channel();
    let read = move || {
        for line in std::io::stdin().lock().lines() {
            let Ok(line) = line else { return };
            if send.send(line).is_err() {
                return;
            }
        }
    };
    std::thread::Builder::new()
        .name("sulcus-typed".into())
        .spawn(read)?;
    Ok(lines)
}

/// Shows a line: below the drawn table, or on standard output. JSON has objects of its own.
fn show(line: String, args: &MonitorArgs, drawn: bool, table: &mut Table) {
    if drawn {
        table.say(line);
    } else if !args.json && !args.once {
        say!("{line}");
    }
}

/// Line about an answer.
fn answered(station: &str, answer: &Answer) -> String {
    match (answer.taken, answer.tick) {
        (true, 0) => format!("{station}: in force for the next session"),
        (true, tick) => format!("{station}: in force from tick {tick}"),
        (false, _) => format!("{station}: refused: {}", answer.text),
    }
}
