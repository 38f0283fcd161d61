//! `sulcus-server serve`: runs one station until Ctrl-C.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use anyhow::{Context, bail};
use clap::Args;
use serde_json::json;
use sulcus_core::Scene;
use sulcus_core::scene::displayable::too_stiff;
use sulcus_program::{PathText, say, tell};
use sulcus_proto::SessionSummary;
use sulcus_proto::ticket::hex;
use sulcus_scene::{BuildOptions, BuiltIn, compile_built_in, compile_file};
use sulcus_sessions::{Events, Mode, Rubric};
use tokio::signal::unix::{Signal, SignalKind, signal};

use crate::net::addresses::{for_clients, resolve};
use crate::{
    Budget, Detail, Exercise, Server, ServerConfig, ServerError, ServerHandle, SessionPlan, StationConfig,
};
use sulcus_program::ProgressLines;

/// Long text of the help.
const ABOUT: &str = "\
Run one station until Ctrl-C.

A station serves one client at a time, simulates its scene at 1000 ticks per second unless the scene file or --rate-hz sets
another rate, and records and signs every session. Several stations are several processes, each with its own port.

At the start the server prints a ticket: token and certificate fingerprint in one line. A client needs the address and the
ticket: `sulcus-client run --server ADDRESS:PORT --ticket TICKET`. The certificate is new at every start, and with it the
ticket. SULCUS_TOKEN or --token keeps the token.";

/// Text after the options of the help.
const NOTES: &str = "\
Examples:
  sulcus-server serve                       clients on this machine only
  sulcus-server serve --listen 0.0.0.0:4433 --exercise bimanual --recordings /srv/recordings
  sulcus-server serve --listen 0.0.0.0:4433 --scene my-scene.toml       own scene, without a grade
  sulcus-server serve --json | jq -r '.ticket // empty'                 the ticket alone

Firewall: open the UDP port of --listen for incoming packets. The server opens no connection by itself.
Real-time scheduling: `setcap cap_sys_nice,cap_ipc_lock+ep sulcus-server`, or `ulimit -r 50` and `ulimit -l unlimited`.
  Without these rights the server warns once and misses more ticks under load.
End: Ctrl-C, SIGTERM or a hang-up of the terminal. The running session ends, and its recording is signed. The end takes up
  to 32 seconds on a slow disk.
Cache of scenes: $SULCUS_CACHE, else $XDG_CACHE_HOME/sulcus, else ~/.cache/sulcus.
Logs go to standard error. SULCUS_LOG=debug prints more; the default is SULCUS_LOG=info.

Exit codes: 0 every recording is complete, 1 a recording is not complete, 2 wrong usage, bad input, a busy port, or an
output that cannot be written.";

/// Run one station: one client at a time, every session recorded and signed
#[derive(Clone, Debug, Args)]
#[command(long_about = ABOUT, after_long_help = NOTES)]
pub struct ServeArgs {
    /// UDP address to listen on, or a name. 127.0.0.1: clients on this machine only. 0.0.0.0 or `[::]`: every address
    /// of this machine. Port 0: any free port
    #[arg(long, value_name = "ADDR:PORT", default_value = "127.0.0.1:4433")]
    pub listen: String,
    /// Scene file (TOML) or compiled scene (.scene). Default: the scene of the exercise
    #[arg(long, value_name = "FILE")]
    pub scene: Option<PathBuf>,
    /// Seed of the generated patient; refused for a scene without a generated patient. Default: the seed of the scene
    /// file
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    /// Ticks per second, 250 to 8000. Default: the rate of the scene file, else 1000
    #[arg(long, value_name = "HZ")]
    pub rate_hz: Option<u16>,
    /// Folder for recordings. A missing folder is created
    #[arg(long, value_name = "DIR", default_value = "recordings")]
    pub recordings: PathBuf,
    /// Secret that clients must know, 1 to 256 bytes. Other users of the machine see this option, but not the
    /// environment variable SULCUS_TOKEN. Default: SULCUS_TOKEN, else a new random token
    #[arg(long, value_name = "T")]
    pub token: Option<String>,
    /// File for the server's certificate (DER), for clients with `--certificate`. Default: not written
    #[arg(long, value_name = "FILE")]
    pub certificate_out: Option<PathBuf>,
    /// Name of the station in recordings, at most 256 bytes
    #[arg(long, value_name = "NAME", default_value = "station")]
    pub station: String,
    /// Opaque learner id for sessions whose client names none, never a name: letters, digits, `-` and `_`, with at
    /// least one digit
    #[arg(long, value_name = "ID", default_value = "", value_parser = sulcus_proto::learner::parse)]
    pub learner: String,
    /// Purpose of the sessions. The purpose is recorded and signed, and `sulcus-sessions grade` presents the grade by
    /// it
    #[arg(long, value_enum, default_value_t)]
    pub mode: Mode,
    /// Exercise: bimanual, crown, probing, retraction, an exercise file that ends in .toml, or `free` without a grade.
    /// The recordings hold its definition and rubric. Default: crown; with --scene: free
    #[arg(long, value_name = "NAME")]
    pub exercise: Option<String>,
    /// Rubric file for the recordings; refused with the exercise `free`. Default: the rubric of the exercise
    #[arg(long, value_name = "FILE")]
    pub rubric: Option<PathBuf>,
    /// Largest mean CPU time of a tick, microseconds, 10 to 900. Tissue is simulated at its fine level while ticks take
    /// less; refused with a rubric. Default: always the coarse level
    #[arg(long, value_name = "US", value_parser = clap::value_parser!(u32).range(10..=900))]
    pub detail_budget: Option<u32>,
    /// Largest force of every session, newtons. A client can lower the limit, never raise it. Default and upper bound:
    /// the limit of the scene
    #[arg(long, value_name = "N", value_parser = newtons)]
    pub force_limit: Option<f32>,
    /// Longest session, seconds, 1 or more. Default: no limit
    #[arg(long, value_name = "S", value_parser = clap::value_parser!(u64).range(1..))]
    pub max_session: Option<u64>,
    /// Time for a student's return after a lost connection, seconds, 0 to 3600. 0: a lost connection ends the session
    #[arg(long, value_name = "S", default_value_t = 30, value_parser = clap::value_parser!(u64).range(0..=3600))]
    pub resume_within: u64,
    /// File of the key that signs recordings, created on first use. The public key beside it ends in .pub; graders of
    /// exams need it. Default: station.key in $SULCUS_STATE_DIR, else in $XDG_STATE_HOME/sulcus, else in
    /// ~/.local/state/sulcus
    #[arg(long, value_name = "FILE")]
    pub key: Option<PathBuf>,
    /// Do not request real-time scheduling and locked memory
    #[arg(long)]
    pub no_realtime: bool,
    /// Print JSON: an object with address and ticket on the first line, an object with all sessions on the last line
    #[arg(long)]
    pub json: bool,
}

/// Runs a station until a signal. The exit code is 0, or 1 if a recording is not complete.
///
/// # Errors
/// A scene, exercise, rubric, key, address, folder or value that cannot be used. The error is one sentence.
pub fn run(args: &ServeArgs) -> anyhow::Result<u8> {
    let asked = asked(args)?;
    let otherwise = match &asked {
        Some(exercise) if args.scene.is_none() => BuiltIn::named(&exercise.scene)
            .with_context(|| format!("exercise `{}`", exercise.name))?,
        _ => BuiltIn::Crown,
    };
    let (scene, bytes, patient) = load(args.scene.as_deref(), otherwise, args.seed, args.rate_hz)?;
    if let Some(exercise) = &asked {
        for what in Events::new(&scene, exercise).missing() {
            let (name, scene) = (&exercise.name, &scene.name);
            tell!("warning: exercise `{name}` needs {what}, which scene `{scene}` lacks");
        }
    }
    let (exercise, rubric) = recorded(asked.as_ref(), args.rubric.as_deref())?;
    for coupling in too_stiff(&scene) {
        if !rubric.is_empty() {
            bail!(
                "exercise `{}` is graded and needs a coupling that a device can display: {coupling}",
                exercise.name
            );
        }
        tell!("warning: {coupling}");
    }
    let mut plan = SessionPlan::new(Arc::new(scene), Arc::new(bytes));
    plan.patient = patient;
    plan.learner.clone_from(&args.learner);
    plan.mode = args.mode;
    (plan.exercise, plan.rubric) = (exercise, rubric);
    if let Some(budget_us) = args.detail_budget {
        plan.detail = Detail::ByTime(Budget {
            budget_us,
            ..Budget::default()
        });
    }
    plan.max_session = args.max_session.map(Duration::from_secs);
    plan.resume_within = Duration::from_secs(args.resume_within);
    let (scene_name, exercise_name) = (plan.scene.name.clone(), plan.exercise.name.clone());
    let station = StationConfig {
        name: args.station.clone(),
        plan,
        force_limit_n: args.force_limit.unwrap_or_default(),
    };
    let mut config = ServerConfig::new(station, args.recordings.clone())?;
    config.station_key.clone_from(&args.key);
    config.real_time = !args.no_realtime;
    let from_environment = || {
        std::env::var("SULCUS_TOKEN")
            .ok()
            .filter(|token| !token.is_empty())
    };
    if let Some(token) = args.token.clone().or_else(from_environment) {
        config.token = token;
    }
    let server = start(config, &args.listen)?;
    if let Some(path) = &args.certificate_out {
        std::fs::write(path, server.certificate_der())
            .with_context(|| format!("--certificate-out {}: cannot write", path.shown()))?;
    }
    announce(&server, &scene_name, &exercise_name, args.json);
    wait_for_signal(&server)?;
    tell!("the server is ending; a running session is closed and its recording signed");
    server.shutdown();
    let sessions = server.join()?;
    Ok(report(&sessions, args))
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

fn newtons(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(force) if force.is_finite() && force > 0.0 => Ok(force),
        _ => Err("expected a force in newtons above 0".to_owned()),
    }
}

/// Exercise of the arguments; `None` for free exploration.
fn asked(args: &ServeArgs) -> anyhow::Result<Option<sulcus_sessions::Exercise>> {
    let free = Exercise::default().name;
    let otherwise = if args.scene.is_some() { &free } else { "crown" };
    let name = args.exercise.as_deref().unwrap_or(otherwise);
    if name == free {
        if let Some(rubric) = &args.rubric {
            bail!(
                "--rubric is {}, but exercise `{free}` has no grade; name an exercise with --exercise",
                rubric.shown()
            );
        }
        return Ok(None);
    }
    if name.ends_with(".toml") {
        return Ok(Some(sulcus_sessions::Exercise::open(Path::new(name))?));
    }
    let all = sulcus_sessions::Exercise::built_in();
    let names: Vec<String> = all.iter().map(|one| one.name.clone()).collect();
    let found = all.into_iter().find(|one| one.name == name);
    found.map(Some).with_context(|| {
        format!(
            "--exercise is `{name}`, expected one of {}, {free}, or an exercise file that ends in .toml",
            names.join(", ")
        )
    })
}

/// Exercise as offered and recorded, and the text of its rubric; the text is empty if the exercise is not graded.
///
/// # Errors
/// The file of `rubric` is not valid, or does not fit the exercise.
fn recorded(
    asked: Option<&sulcus_sessions::Exercise>,
    rubric: Option<&Path>,
) -> anyhow::Result<(Exercise, String)> {
    let Some(one) = asked else {
        return Ok((Exercise::default(), String::new()));
    };
    let rubric = match rubric {
        Some(file) => {
            let rubric = Rubric::open(file)?;
            rubric.fits(one)?;
            Some(rubric)
        }
        None => Rubric::of(one),
    };
    if let Some(Err(error)) = rubric.as_ref().map(|rubric| rubric.fits(one)) {
        tell!("warning: the recordings cannot be graded: {error}");
    }
    let rubric = rubric.map(|rubric| rubric.definition()).transpose()?;
    let exercise = Exercise {
        name: one.name.clone(),
        text: one.task.clone(),
        definition: one.definition(0)?,
        seed: 0,
    };
    Ok((exercise, rubric.unwrap_or_default()))
}

/// Scene of a scene file, a compiled scene or the built-in `otherwise`, with its bytes and the text of its patient. The
/// text is empty for a compiled scene and for a scene without a patient.
///
/// # Errors
/// The file is not valid, the rate does not fit the scene, or `seed` has no generated patient.
fn load(
    path: Option<&Path>,
    otherwise: BuiltIn,
    seed: Option<u64>,
    rate_hz: Option<u16>,
) -> anyhow::Result<(Scene, Vec<u8>, String)> {
    let progress = ProgressLines::default();
    let say = |stage: &str, share: f64| progress.report(stage, share);
    let options = BuildOptions {
        seed,
        ..BuildOptions::cached()
    };
    let mut compiled = match path {
        Some(path) if path.extension().is_some_and(|ending| ending == "scene") => {
            if seed.is_some() {
                bail!(
                    "--seed cannot be used with {}: the patient of a compiled scene is fixed",
                    path.shown()
                );
            }
            let bytes = std::fs::read(path)
                .with_context(|| format!("{}: cannot read the scene", path.shown()))?;
            let mut scene = Scene::from_bytes(&bytes).with_context(|| path.shown().to_string())?;
            let Some(rate_hz) = rate_hz else {
                return Ok((scene, bytes, String::new()));
            };
            scene.params.rate_hz = rate_hz;
            scene.validate()?;
            let bytes = scene.to_bytes()?;
            return Ok((scene, bytes, String::new()));
        }
        Some(path) => compile_file(path, &options, &say)?,
        None => compile_built_in(otherwise, &options, &say)?,
    };
    for warning in &compiled.warnings {
        tell!("warning: {warning}");
    }
    if seed.is_some() && compiled.seed.is_none() {
        let has = match compiled.patient {
            Some(_) => "a written patient (`patient` of `[mouth]`)",
            None => "no patient (no table `[mouth]`)",
        };
        bail!(
            "--seed needs a generated patient, but scene `{}` has {has}",
            compiled.scene.name
        );
    }
    if let Some(rate_hz) = rate_hz {
        compiled.scene.params.rate_hz = rate_hz;
        compiled.scene.validate()?;
    }
    let bytes = compiled.scene.to_bytes()?;
    Ok((compiled.scene, bytes, compiled.patient.unwrap_or_default()))
}

fn announce(server: &ServerHandle, scene: &str, exercise: &str, json: bool) {
    let (listen, ticket) = (server.local_addr(), server.ticket());
    let addresses = for_clients(listen);
    let address = addresses.first().copied().unwrap_or(listen);
    let fingerprint = hex(&ticket.fingerprint);
    if json {
        let object = json!({
            "address": address.to_string(), "addresses": addresses, "listen": listen.to_string(),
            "token": ticket.token,
            "certificate_sha256": fingerprint, "ticket": ticket.to_string(),
            "scene": scene, "exercise": exercise,
        });
        say!("{object}");
    } else {
        let any = if listen.ip().is_unspecified() {
            " (listening on every address of this machine)"
        } else {
            ""
        };
        say!("serving exercise `{exercise}` in scene `{scene}` on {address}{any}");
        say!("  token        {}", ticket.token);
        say!("  certificate  {fingerprint} (SHA-256)");
        say!("  ticket       {ticket}");
        say!("Ctrl-C ends the running session and the server.");
    }
}

/// Whether the process ignores hang-ups, as under `nohup`.
fn ignores_hang_ups() -> bool {
    // SAFETY: zeros are a valid `sigaction`; without a new action the call only reads the present one.
    let (result, present) = unsafe {
        let mut present: libc::sigaction = std::mem::zeroed();
        let result = libc::sigaction(libc::SIGHUP, std::ptr::null(), &mut present);
        (result, present)
    };
    result == 0 && present.sa_sigaction == libc::SIG_IGN
}

/// Returns at a hang-up of the terminal; never returns while hang-ups are ignored.
async fn hung_up(signal: &mut Option<Signal>) {
    match signal {
        Some(signal) => {
            signal.recv().await;
        }
        None => std::future::pending().await,
    }
}

/// Returns on Ctrl-C, on SIGTERM, on SIGHUP unless it is ignored, or within 500 ms after the server has ended by
/// itself.
fn wait_for_signal(server: &ServerHandle) -> anyhow::Result<()> {
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build()?;
    runtime.block_on(async {
        let mut terminate = signal(SignalKind::terminate())?;
        let mut interrupt = signal(SignalKind::interrupt())?;
        let mut hang_up = if ignores_hang_ups() {
            None
        } else {
            Some(signal(SignalKind::hangup())?)
        };
        loop {
            tokio::select! {
                _ = interrupt.recv() => return Ok(()),
                _ = terminate.recv() => return Ok(()),
                () = hung_up(&mut hang_up) => return Ok(()),
                () = tokio::time::sleep(Duration::from_millis(500)) => {
                    if server.is_finished() {
                        return Ok(());
                    }
                }
            }
        }
    })
}

/// Prints a line for each session, and with `--json` the summaries. Returns the exit code.
fn report(sessions: &[SessionSummary], args: &ServeArgs) -> u8 {
    for session in sessions {
        tell!(
            "{}: {} ticks, {} missed (late or skipped), CPU time of a tick p50 {:.0} us, p99.9 {:.0} us, largest force {:.2} N{}",
            args.recordings.join(&session.recording).shown(),
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
    if args.json {
        say!("{}", json!({ "sessions": sessions }));
    }
    u8::from(sessions.iter().any(|session| !session.complete))
}
