//! `sulcus-server serve`: one station until Ctrl-C.

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
use crate::{Budget, Detail, Exercise, Server, ServerConfig, ServerError, ServerHandle};
use sulcus_program::ProgressLines;

/// Serve one station until Ctrl-C.
#[derive(Clone, Debug, Args)]
#[command(
    long_about = "Serve one station until Ctrl-C: one client at a time, simulated at 1 kHz (--rate-hz), every session recorded and signed.\n\nThe ticket printed at the start is all that a client needs besides the address: token and certificate in one line. It is new at every start; with --token the token stays the same.",
    after_long_help = "Examples:\n  sulcus-server serve\n  sulcus-server serve --listen 0.0.0.0:4433 --scene crown.toml --recordings /srv/recordings\n  sulcus-server serve --certificate-out server.der --json | jq -r .ticket    (the first line is the address, the last the summaries)\n\nLate ticks: grant real-time scheduling with `setcap cap_sys_nice,cap_ipc_lock+ep sulcus-server`, or raise `ulimit -r` and `ulimit -l`."
)]
pub struct ServeArgs {
    /// UDP address to listen on, or a name; `0.0.0.0` or `[::]`: any address of this machine; port 0: any free one
    #[arg(long, value_name = "ADDR:PORT", default_value = "127.0.0.1:4433")]
    pub listen: String,
    /// Scene file (TOML) or compiled scene (.scene); default: the exercise's own
    #[arg(long, value_name = "FILE")]
    pub scene: Option<PathBuf>,
    /// Seed of a generated patient, instead of the scene file's
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    /// Ticks a second, 250 to 8000; the scene's own when omitted (1000 unless its file says so)
    #[arg(long, value_name = "HZ")]
    pub rate_hz: Option<u16>,
    /// Folder for recordings, made when missing
    #[arg(long, value_name = "DIR", default_value = "recordings")]
    pub recordings: PathBuf,
    /// Secret that clients must know; default: $SULCUS_TOKEN (other users cannot see it), else a random one
    #[arg(long, value_name = "T")]
    pub token: Option<String>,
    /// Write the server's certificate (DER) here, for clients to pin
    #[arg(long, value_name = "FILE")]
    pub certificate_out: Option<PathBuf>,
    /// Name of this station in recordings
    #[arg(long, value_name = "NAME", default_value = "station")]
    pub station: String,
    /// Opaque learner id for recordings when the client names none, never a name: letters, digits, - and _, one digit at least
    #[arg(long, value_name = "ID", default_value = "", value_parser = sulcus_proto::learner::parse)]
    pub learner: String,
    /// What sessions are for: it goes into the recordings, signed, and grades are shown accordingly
    #[arg(long, value_enum, default_value_t)]
    pub mode: Mode,
    /// What students are asked to do: bimanual, crown, probing, retraction, a file of one (ending in .toml), or `free`; its
    /// definition and rubric go into the recordings. Default: crown, with --scene free, which is not graded
    #[arg(long, value_name = "NAME")]
    pub exercise: Option<String>,
    /// Rubric for the recordings instead of the exercise's own
    #[arg(long, value_name = "FILE")]
    pub rubric: Option<PathBuf>,
    /// Simulate tissue at its finer level while ticks take less CPU time than this on average, microseconds; default: always
    /// the coarse level, as graded sessions need it
    #[arg(long, value_name = "US", value_parser = clap::value_parser!(u32).range(10..=900))]
    pub detail_budget: Option<u32>,
    /// Largest force in every session, newtons, below the scene's own limit; a client can ask for less, never for more
    #[arg(long, value_name = "N", value_parser = newtons)]
    pub force_limit: Option<f32>,
    /// Longest session, seconds
    #[arg(long, value_name = "S", value_parser = clap::value_parser!(u64).range(1..))]
    pub max_session: Option<u64>,
    /// Key file that signs recordings, made on first use; default: station.key in $SULCUS_STATE_DIR, else
    /// ~/.local/state/sulcus. Its public half stands beside it, ending in .pub: graders of exams need it
    #[arg(long, value_name = "FILE")]
    pub key: Option<PathBuf>,
    /// Do not ask for real-time scheduling and locked memory
    #[arg(long)]
    pub no_realtime: bool,
    /// Print JSON: one object with address and ticket first, one with all sessions on the last line
    #[arg(long)]
    pub json: bool,
}

/// Serves; the exit code is 1 when a recording is not complete.
///
/// # Errors
/// A scene, port, folder or value that cannot be used: one sentence.
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
            tell!("warning: exercise `{name}` wants {what}, which scene `{scene}` has not");
        }
    }
    let (exercise, rubric) = recorded(asked.as_ref(), args.rubric.as_deref())?;
    for coupling in too_stiff(&scene) {
        if !rubric.is_empty() {
            bail!("exercise `{}` is graded: {coupling}", exercise.name);
        }
        tell!("warning: {coupling}");
    }
    let mut config = ServerConfig::new(Arc::new(scene), Arc::new(bytes), args.recordings.clone())?;
    config.patient = patient;
    config.station.clone_from(&args.station);
    config.learner.clone_from(&args.learner);
    config.mode = args.mode;
    (config.exercise, config.rubric) = (exercise, rubric);
    config.station_key.clone_from(&args.key);
    if let Some(budget_us) = args.detail_budget {
        config.detail = Detail::ByTime(Budget {
            budget_us,
            ..Budget::default()
        });
    }
    config.force_limit_n = args.force_limit.unwrap_or_default();
    config.max_session = args.max_session.map(Duration::from_secs);
    config.real_time = !args.no_realtime;
    let from_environment = || {
        std::env::var("SULCUS_TOKEN")
            .ok()
            .filter(|token| !token.is_empty())
    };
    if let Some(token) = args.token.clone().or_else(from_environment) {
        config.token = token;
    }
    let scene_name = config.scene.name.clone();
    let exercise_name = config.exercise.name.clone();
    let server = start(config, &args.listen)?;
    if let Some(path) = &args.certificate_out {
        std::fs::write(path, server.certificate_der())
            .with_context(|| format!("{}: cannot write the certificate", path.shown()))?;
    }
    announce(&server, &scene_name, &exercise_name, args.json);
    wait_for_signal(&server)?;
    tell!("ending the session, if one runs ...");
    server.shutdown();
    let sessions = server.join()?;
    Ok(report(&sessions, args))
}

/// Starts the server on the first address of `listen` that this machine has.
fn start(mut config: ServerConfig, listen: &str) -> anyhow::Result<ServerHandle> {
    let mut refused = Vec::new();
    for address in resolve(listen)? {
        config.listen = address;
        match Server::start(config.clone()) {
            // Of `localhost`, one of the two addresses may not exist.
            Err(error @ ServerError::Listen { .. }) => refused.push(error.to_string()),
            other => return Ok(other?),
        }
    }
    bail!("{}", refused.join("; "))
}

fn newtons(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(force) if force.is_finite() && force > 0.0 => Ok(force),
        _ => Err(format!("`{text}` is not a force in newtons above 0")),
    }
}

/// What students are asked to do; none where they are free.
fn asked(args: &ServeArgs) -> anyhow::Result<Option<sulcus_sessions::Exercise>> {
    let free = Exercise::default().name;
    let otherwise = if args.scene.is_some() { &free } else { "crown" };
    let name = args.exercise.as_deref().unwrap_or(otherwise);
    if name == free {
        if let Some(rubric) = &args.rubric {
            bail!(
                "--rubric {} has nothing to grade: exercise `{free}` asks for nothing",
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
            "--exercise is `{name}`, expected one of {}, {free}, or a file (ending in .toml)",
            names.join(", ")
        )
    })
}

/// The exercise as it is offered and recorded, and the rubric's text (empty where nothing is asked that is graded).
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
        tell!("warning: what is recorded cannot be graded: {error}");
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

/// A scene file, a compiled scene or a built-in one, its bytes, and the text of its patient (empty where there is none).
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
                    "--seed has no effect on {}: a compiled scene has its patient",
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
            Some(_) => "a written one (`patient` of `[mouth]`)",
            None => "none (one with `[mouth]` has)",
        };
        bail!(
            "--seed is a generated patient's, and scene `{}` has {has}",
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
            " (on any address of this machine)"
        } else {
            ""
        };
        say!("serving exercise `{exercise}` in scene `{scene}` on {address}{any}");
        say!("  token        {}", ticket.token);
        say!("  certificate  {fingerprint} (SHA-256)");
        say!("  ticket       {ticket}");
        say!("Ctrl-C ends the session and the server.");
    }
}

/// Whether the program was started to outlive its terminal (`nohup`).
fn ignores_hang_ups() -> bool {
    // SAFETY: zeroes are a valid `sigaction`; without a new action the call only fills in the present one.
    let (result, present) = unsafe {
        let mut present: libc::sigaction = std::mem::zeroed();
        let result = libc::sigaction(libc::SIGHUP, std::ptr::null(), &mut present);
        (result, present)
    };
    result == 0 && present.sa_sigaction == libc::SIG_IGN
}

/// Returns when the terminal hangs up; never where that is ignored.
async fn hung_up(signal: &mut Option<Signal>) {
    match signal {
        Some(signal) => {
            signal.recv().await;
        }
        None => std::future::pending().await,
    }
}

/// Returns on Ctrl-C, on SIGTERM (containers), on SIGHUP (the terminal is gone), or when the server has ended by itself.
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

fn report(sessions: &[SessionSummary], args: &ServeArgs) -> u8 {
    for session in sessions {
        tell!(
            "{}: {} ticks, {} missed, tick p50 {:.0} us, p99.9 {:.0} us, largest force {:.2} N{}",
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
