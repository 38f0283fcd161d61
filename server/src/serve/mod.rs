//! `sulcus-server serve`: runs stations until Ctrl-C.

mod args;
mod page;
mod renewal;
mod signals;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{Context, bail};
use serde_json::json;
use sulcus_program::{PathText, ProgressLines, say, tell};
use sulcus_proto::SessionSummary;
use sulcus_proto::hex::hex;
use sulcus_sessions::ViewersPolicy;

pub use args::ServeArgs;
use page::Page;
use renewal::Renewal;

use crate::check::{CheckInput, check};
use crate::net::addresses::{for_clients, resolve};
use crate::plan::names::{EXPECTED, is_station_name};
use crate::plan::{Desk, Plan, PlanBook, PlanChange, Station, StationsFile};
use crate::state::date::now_s;
use crate::state::{ServerIdentity, StateFolder, Tokens};
use crate::{Server, ServerConfig, ServerError, ServerHandle, StationConfig, control_socket};

/// Address without `--listen` and without a file of stations.
const LISTEN: &str = "127.0.0.1:4433";
/// Folder without `--recordings` and without a file of stations.
const RECORDINGS: &str = "recordings";
/// Name of the only station.
const STATION: &str = "station";

/// Stations, address and folder of the arguments.
struct Asked {
    listen: String,
    recordings: PathBuf,
    viewers: ViewersPolicy,
    recordings_quota: Option<u64>,
    stations: Vec<Station>,
    hours: f64,
}

/// Runs stations until a signal, or checks whether they can run.
///
/// The exit code is 0. It is 1 if a recording is not complete, or if the check has found a problem.
///
/// # Errors
/// A scene, exercise, rubric, key, address, folder or value that cannot be used. The error is one sentence.
pub fn run(args: &ServeArgs) -> anyhow::Result<u8> {
    let asked = asked(args)?;
    let progress = ProgressLines::default();
    let say_stage = |stage: &str, share: f64| progress.report(stage, share);
    if args.check {
        let input = CheckInput {
            listen: asked.listen,
            state: args.state.folder.clone(),
            recordings: asked.recordings,
            viewers: asked.viewers,
            recordings_quota: asked.recordings_quota,
            key: args.key.clone(),
            stations: asked.stations,
            hours: asked.hours,
            real_time: !args.no_realtime,
            has_own_token: own_token(args).is_some(),
        };
        let findings = check(&input, &say_stage);
        return Ok(crate::check::report(&findings, args.json));
    }
    let state = StateFolder::open(args.state.folder.as_deref())?;
    let identity = ServerIdentity::load_or_create(&state, now_s())?;
    let tokens = Tokens::open(&state)?;
    // Refused while another server uses the folder: two servers would mix their plans.
    let claimed = control_socket::claim(&state)?;
    let book = PlanBook::open(&asked.stations, Some(&state))?;
    let desk = Desk::new(book, !args.no_admission);
    let mut stations = Vec::new();
    for station in &asked.stations {
        let compiled = desk.compile(&station.name, &say_stage);
        let (plan, warnings) = match (&args.config, compiled) {
            (_, Ok(compiled)) => compiled,
            (None, Err(error)) => bail!("{}", by_option(&format!("{error:#}"))),
            (Some(_), Err(error)) => {
                return Err(error.context(format!("station `{}`", station.name)));
            }
        };
        for warning in warnings {
            tell!("warning: {warning}");
        }
        stations.push(StationConfig {
            name: station.name.clone(),
            plan,
            force_limit_n: args.force_limit.unwrap_or_default(),
        });
    }
    let first = stations.first().context("no station")?.clone();
    let mut config = ServerConfig::new(first, asked.recordings.clone())?;
    config.viewers = asked.viewers;
    config.stations = stations.clone();
    config.recordings_quota = asked.recordings_quota;
    config.station_key = Some(args.key.clone().unwrap_or_else(|| state.station_key()));
    config.journal = Some(state.file("running"));
    config.identity = Some((
        identity.certificate_der().to_vec(),
        identity.key().secret_der().to_vec(),
    ));
    config.tokens = Arc::new(tokens);
    config.codes = Arc::new(state.clone());
    config.planner = desk.clone();
    config.metrics = args.metrics;
    config.clients = clients(args.clients.as_deref())?;
    config.real_time = !args.no_realtime;
    if let Some(token) = own_token(args) {
        config.token = token;
    }
    let server = start(config.clone(), &asked.listen)?;
    let page = Page::start(args.console, &server, &config, &state)?;
    if let Some(path) = &args.certificate_out {
        renewal::write(path, server.certificate_der())?;
    }
    let control = control_socket::serve(claimed, desk)?;
    announce(&server, &stations, &page, args.json);
    let mut renewal = Renewal::new(state, &identity, args.certificate_out.clone());
    signals::wait_for_signal(&server, || {
        renewal.look(&server, &page);
    })?;
    tell!("the server is ending; running sessions are closed and their recordings signed");
    drop((control, page));
    server.shutdown();
    let sessions = server.join()?;
    Ok(report(&sessions, &asked.recordings, args.json))
}

/// Folder of clients for download: the given one, else that of an installation if it exists.
fn clients(given: Option<&Path>) -> anyhow::Result<Option<PathBuf>> {
    if let Some(folder) = given {
        if !folder.is_dir() {
            bail!("--clients {} is not a folder", folder.shown());
        }
        return Ok(Some(std::path::absolute(folder)?));
    }
    let program = std::env::current_exe().ok();
    let prefix = program
        .as_deref()
        .and_then(Path::parent)
        .and_then(Path::parent);
    let folder = prefix.map(|prefix| prefix.join("share/sulcus/clients"));
    Ok(folder.filter(|folder| folder.is_dir()))
}

/// Token of the command line or of the environment.
fn own_token(args: &ServeArgs) -> Option<String> {
    let from_environment = || {
        std::env::var("SULCUS_TOKEN")
            .ok()
            .filter(|token| !token.is_empty())
    };
    args.token.clone().or_else(from_environment)
}

/// Stations of the file, or the only station of the options. Parts of a plan in the options replace those of every
/// station of the file.
fn asked(args: &ServeArgs) -> anyhow::Result<Asked> {
    let change = change(args);
    let fault = |fault: crate::plan::Fault| by_option(&fault.to_string());
    let (file, stations) = match &args.config {
        Some(path) => {
            let file = StationsFile::open(path)?;
            let mut stations = file.stations.clone();
            for station in &mut stations {
                let plan = station.plan.with(&change);
                station.plan = plan.map_err(|error| {
                    anyhow::anyhow!("station `{}`: {}", station.name, fault(error))
                })?;
            }
            (Some(file), stations)
        }
        None => {
            let name = args.station.clone().unwrap_or_else(|| STATION.to_owned());
            if !is_station_name(&name) {
                bail!(
                    "--station is `{}`, expected {EXPECTED}",
                    name.escape_debug()
                );
            }
            let plan = Plan::of(&change).map_err(|error| anyhow::anyhow!("{}", fault(error)))?;
            (None, vec![Station { name, plan }])
        }
    };
    let listen = args.listen.clone();
    let recordings = args.recordings.clone();
    let (file_listen, file_recordings) = file.as_ref().map_or((None, None), |file| {
        (file.listen.clone(), file.recordings.clone())
    });
    Ok(Asked {
        listen: listen.or(file_listen).unwrap_or_else(|| LISTEN.to_owned()),
        recordings: recordings
            .or(file_recordings)
            .unwrap_or_else(|| RECORDINGS.into()),
        viewers: args
            .viewers
            .or(file.as_ref().and_then(|file| file.viewers))
            .unwrap_or_default(),
        recordings_quota: file.as_ref().and_then(|file| file.recordings_quota),
        hours: file.map_or(crate::plan::stations::HOURS, |file| file.hours),
        stations,
    })
}

/// Parts of a plan in the options.
fn change(args: &ServeArgs) -> PlanChange {
    PlanChange {
        exercise: args.exercise.clone(),
        scene: args.scene.clone(),
        patient_seed: args.seed.map(crate::plan::PatientSeed::Number),
        rate_hz: args.rate_hz,
        mode: args.mode,
        learner: args.learner.clone(),
        rubric: args.rubric.clone(),
        time_limit_s: args.max_session,
        resume_within_s: args.resume_within,
        detail_budget_us: args.detail_budget,
        ..PlanChange::default()
    }
}

/// Message about a part of a plan, with the option that gave the part.
fn by_option(text: &str) -> String {
    let options = [
        ("patient_seed is a number", "--seed is given"),
        ("patient_seed is", "--seed is"),
        ("exercise is", "--exercise is"),
        ("rubric is", "--rubric is"),
        ("rate_hz is", "--rate-hz is"),
        ("mode is", "--mode is"),
        ("scene is", "--scene is"),
        ("detail_budget_us is", "--detail-budget is"),
    ];
    let found = options.iter().find(|(part, _)| text.starts_with(part));
    match found {
        Some((part, option)) => text.replacen(part, option, 1),
        None => text.to_owned(),
    }
}

/// Starts the server on the first address of `listen` that this machine can use.
fn start(mut config: ServerConfig, listen: &str) -> anyhow::Result<ServerHandle> {
    let mut refused = Vec::new();
    for address in resolve(listen)? {
        config.listen = address;
        match Server::start(config.clone()) {
            // One of the two addresses of `localhost` may not exist.
            Err(error @ ServerError::Listen { .. }) => refused.push(error.to_string()),
            other => return Ok(other?),
        }
    }
    bail!("{}", refused.join("; "))
}

fn announce(server: &ServerHandle, stations: &[StationConfig], page: &Page, json: bool) {
    let Some(first) = stations.first() else {
        return;
    };
    let (scene, exercise) = (&first.plan.scene.name, &first.plan.exercise.name);
    let (listen, ticket) = (server.local_addr(), server.ticket());
    let addresses = for_clients(listen);
    let address = addresses.first().copied().unwrap_or(listen);
    let fingerprint = hex(&ticket.fingerprint);
    if json {
        let object = json!({
            "address": address.to_string(), "addresses": addresses, "listen": listen.to_string(),
            "token": ticket.token,
            "certificate_sha256": fingerprint, "ticket": ticket.to_string(),
            "scene": scene, "exercise": exercise, "console": page.address(),
            "first_administrator": page.first(),
            "stations": stations.iter().map(|one| json!({
                "station": one.name, "exercise": one.plan.exercise.name, "scene": one.plan.scene.name,
                "mode": one.plan.mode.name(),
            })).collect::<Vec<_>>(),
        });
        say!("{object}");
    } else {
        let any = if listen.ip().is_unspecified() {
            " (listening on every address of this machine)"
        } else {
            ""
        };
        match stations.len() {
            1 => say!("serving exercise `{exercise}` in scene `{scene}` on {address}{any}"),
            n => say!("serving {n} stations on {address}{any}"),
        }
        if stations.len() > 1 {
            for one in stations {
                let (plan, name) = (&one.plan, &one.name);
                say!(
                    "  {name:<16} exercise `{}` in scene `{}`, {}",
                    plan.exercise.name,
                    plan.scene.name,
                    plan.mode
                );
            }
        }
        say!(
            "ticket of station {} until the end of this server:",
            first.name
        );
        say!("  token        {}", ticket.token);
        say!("  certificate  {fingerprint} (SHA-256)");
        say!("  ticket       {ticket}");
        if let Some(address) = page.address() {
            say!("instructor's console: https://{address}");
        }
        if let Some(link) = page.first() {
            say!("first administrator, once within an hour: {link}");
        }
        say!("Ctrl-C ends running sessions and the server.");
    }
}

/// Prints a line for each session, and with `--json` the summaries. Returns the exit code.
fn report(sessions: &[SessionSummary], recordings: &Path, json: bool) -> u8 {
    for session in sessions {
        tell!(
            "{}: {} ticks, {} missed (late or skipped), CPU time of a tick p50 {:.0} us, p99.9 {:.0} us, largest force {:.2} N{}",
            recordings.join(&session.recording).shown(),
            session.ticks,
            session.deadline_misses,
            session.tick_us.p50,
            session.tick_us.p999,
            session.max_force_n,
            if session.complete {
                ""
            } else {
                ", NOT COMPLETE"
            },
        );
    }
    if json {
        say!("{}", json!({ "sessions": sessions }));
    }
    u8::from(sessions.iter().any(|session| !session.complete))
}
