//! `sulcus-client swarm`: simulated hands on many stations at once, for the number of stations that a machine holds.

pub mod args;
mod player;
mod seats;
mod table;
pub mod usage;

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use anyhow::{Context, bail};
use serde::Serialize;
use sulcus_connection::link::{Link, LinkConfig, LinkStats, Network};
use sulcus_connection::perform::{Part, Performed, carry_all};
use sulcus_connection::progress::{Bar, Steps};
use sulcus_program::{say, tell};
use sulcus_proto::control::EndReason;
use sulcus_proto::{Percentiles, SessionSummary};
use sulcus_sessions::{Recording, ReplayOptions, replay};

use crate::exercise::{Asked, Prepared, prepare};
use crate::simulated::Simulated;
use args::SwarmArgs;
use player::{LEAPS, Leaps, Player};
use seats::Seats;
use usage::{Meter, Usage};

/// SCHED_FIFO priority of the simulated hands and of their packets, that of an embedded server's threads: on a full
/// core hands and simulations wait for each other.
const PRIORITY: i32 = 50;
/// Number of hands on one thread, and of their links on one other. Chosen: each thread takes at most half a core.
const SHARED: usize = 16;

/// Result of one run.
#[derive(Clone, Debug, Serialize)]
pub struct Swarm {
    /// Number of stations asked for.
    pub stations: usize,
    /// Sessions in the order of the stations.
    pub sessions: Vec<Session>,
    /// Stations that the server refused, with its sentence.
    pub refused: Vec<String>,
    /// Processor time of server and simulated hands, per cent of one core.
    pub cpu_percent: f64,
    /// Processor time of the server's threads, per cent of one core; 0 for a server in another process.
    pub server_cpu_percent: f64,
    /// Time for which simulation threads were ready and did not run, summed over the threads, per cent of the wall
    /// time. The time holds waits for other real-time threads and all throttles of the kernel.
    pub waited_percent: f64,
    /// Largest resident memory of server and simulated hands, mebibytes.
    pub memory_mb: f64,
    /// Number of recordings whose replay is not identical; `None` without replays.
    pub not_identical: Option<usize>,
}

/// Session of one station.
#[derive(Clone, Debug, Serialize)]
pub struct Session {
    /// Name of the station.
    pub station: String,
    /// File name of the recording.
    pub recording: String,
    /// Whether the recording is complete.
    pub complete: bool,
    /// Number of ticks.
    pub ticks: u64,
    /// Rows that the recorder's queue dropped.
    pub rows_dropped: u64,
    /// Grid points without a tick.
    pub skipped: u64,
    /// Late ticks and skipped points.
    pub deadline_misses: u64,
    /// CPU time of a tick, microseconds.
    pub tick_us: Percentiles,
    /// Wall time of a tick, microseconds.
    pub tick_wall_us: Percentiles,
    /// Time from a pose to the wrench that answers it, microseconds.
    pub rtt_us: Percentiles,
    /// Periods that the simulated hand's loop overslept.
    pub overslept: u64,
}

impl Session {
    fn new(summary: SessionSummary, stats: &LinkStats, overslept: u64) -> Self {
        Self {
            station: summary.station,
            recording: summary.recording,
            complete: summary.complete && summary.end == EndReason::Stopped,
            ticks: summary.ticks,
            rows_dropped: summary.rows_dropped,
            skipped: summary.skipped,
            deadline_misses: summary.deadline_misses,
            tick_us: summary.tick_us,
            tick_wall_us: summary.tick_wall_us,
            rtt_us: stats.rtt_us,
            overslept,
        }
    }
}

/// Runs the swarm. The exit code is 0, or 1 if a session is missing, not complete or not identical on replay.
///
/// # Errors
/// An unknown exercise, an invalid scene or table of tickets, a server that does not start or is not there.
pub fn run(args: &SwarmArgs) -> anyhow::Result<u8> {
    let steps = Steps;
    let mut runs = Vec::new();
    for &stations in &args.stations {
        let swarm = one(args, usize::from(stations), &steps)?;
        say!("{}", table::lines(&swarm));
        runs.push(swarm);
    }
    if let Some(file) = &args.readme {
        table::write(file, &args.exercise, &runs)?;
    }
    if args.json
        && let Some(last) = runs.last()
    {
        say!("{}", serde_json::to_string(last)?);
    }
    let sound = |swarm: &Swarm| {
        swarm.sessions.len() == swarm.stations
            && swarm.sessions.iter().all(|session| session.complete)
            && swarm.not_identical.unwrap_or(0) == 0
    };
    Ok(u8::from(!runs.iter().all(sound)))
}

/// Exercises for `stations` stations, each with a seed of its own. The last ones are those of `--leaps`.
fn hands(args: &SwarmArgs, stations: usize, steps: &Steps) -> anyhow::Result<Vec<Prepared>> {
    let mut hands: Vec<Prepared> = Vec::new();
    let first_leaping = stations.saturating_sub(args.leaps);
    for k in 0..stations {
        let leaps = k >= first_leaping;
        let asked = Asked {
            scene: args.scene.as_deref().filter(|_| !leaps),
            duration_s: Some(args.duration),
            hand_seed: k as u64 + 1,
            ..Asked::of(if leaps { LEAPS } else { &args.exercise })
        };
        let mut prepared = prepare(&asked, steps)?;
        if leaps {
            prepared.exercise.duration_s = args.duration;
            prepared.ticks = (args.duration / prepared.scene.tick_s()) as u64;
        }
        if let Some(first) = hands.get(if leaps { first_leaping } else { 0 }) {
            // One copy of the scene for all stations of an exercise.
            prepared.scene = first.scene.clone();
            prepared.scene_bytes = first.scene_bytes.clone();
        } else {
            for warning in &prepared.warnings {
                tell!("warning: {warning}");
            }
        }
        hands.push(prepared);
    }
    Ok(hands)
}

fn one(args: &SwarmArgs, stations: usize, steps: &Steps) -> anyhow::Result<Swarm> {
    let hands = hands(args, stations, steps)?;
    let seats = match (&args.server, &args.tickets) {
        (Some(server), Some(tickets)) => Seats::of_server(server, tickets, stations)?,
        _ => Seats::embedded(&hands, &args.recordings)?,
    };
    let meter = Meter::start()?;
    let bar = steps.bar("performing");
    let (performed, refused) = perform_all(hands, args.leaps, &seats.configs, &bar)?;
    bar.done();
    let Usage {
        cpu_percent,
        server_percent,
        waited_percent,
        memory_mb,
    } = meter.stop();
    seats.end()?;
    let mut swarm = Swarm {
        stations,
        sessions: Vec::new(),
        refused,
        cpu_percent,
        server_cpu_percent: server_percent,
        waited_percent,
        memory_mb,
        not_identical: None,
    };
    for performed in performed {
        match performed.goodbye {
            Ok(goodbye) => {
                let overslept = performed.report.overslept;
                let session = Session::new(goodbye.summary, &performed.stats, overslept);
                swarm.sessions.push(session);
            }
            Err(error) => tell!("error: {error}"),
        }
    }
    if args.replay {
        swarm.not_identical = Some(replays(&swarm, &args.recordings, steps)?);
    }
    Ok(swarm)
}

/// Performs one session at each seat, at the same time. Returns the sessions and the sentences of refused seats. The
/// last `leaps` devices leap at random.
///
/// Up to [`SHARED`] hands have a thread in common, and their packets another. The hands use the machine of an embedded
/// server: at 16 stations a thread for each hand costs that machine a core.
fn perform_all(
    hands: Vec<Prepared>,
    leaps: usize,
    seats: &[LinkConfig],
    bar: &Bar,
) -> anyhow::Result<(Vec<Performed>, Vec<String>)> {
    let mut refused = Vec::new();
    let mut groups: Vec<Vec<Part<Player>>> = Vec::new();
    let first_leaping = hands.len().saturating_sub(leaps);
    // Before the first connection: a server waits for the start of a session for some seconds only.
    let asked: Vec<_> = hands
        .into_iter()
        .zip(seats)
        .enumerate()
        .map(|(k, (hand, config))| {
            let (scene_hash, periods) = (hand.scene_hash(), hand.ticks);
            let device = if k >= first_leaping {
                Player::Leaps(Leaps::new(&hand.scene, k as u64))
            } else {
                Player::Hand(Box::new(Simulated {
                    operator: hand.operator,
                    until_done: false,
                }))
            };
            (device, scene_hash, periods, config)
        })
        .collect();
    let mut asked = asked.into_iter().peekable();
    while asked.peek().is_some() {
        let network = Arc::new(Network::start_at(PRIORITY)?);
        let mut parts = Vec::new();
        for (device, scene_hash, periods, config) in asked.by_ref().take(SHARED) {
            let link = match Link::connect_on(config.clone(), network.clone()) {
                Ok(link) => link,
                Err(error) => {
                    tell!("station refused: {error}");
                    refused.push(error.to_string());
                    continue;
                }
            };
            if link.hello().scene_hash != scene_hash {
                bail!(
                    "station `{}` simulates scene `{}`, which differs from the scene of the simulated hands; give the server's exercise and scene file",
                    link.hello().station,
                    link.hello().scene
                );
            }
            // A link that has ended holds its error, which the end of the run returns.
            link.start();
            parts.push(Part {
                link,
                device,
                periods,
            });
        }
        groups.push(parts);
    }
    let progress: Vec<AtomicU64> = groups.iter().map(|_| AtomicU64::new(0)).collect();
    let performed = std::thread::scope(|scope| {
        let mut threads = Vec::new();
        for (parts, done) in groups.into_iter().zip(&progress) {
            let thread = std::thread::Builder::new().name("sulcus-device".into());
            threads.push(thread.spawn_scoped(scope, || carry_all(parts, PRIORITY, done))?);
        }
        while threads.iter().any(|thread| !thread.is_finished()) {
            let slowest = progress.iter().map(|done| done.load(Ordering::Relaxed));
            bar.set("performing", slowest.min().unwrap_or(0) as f64 / 1000.0);
            std::thread::sleep(Duration::from_millis(100));
        }
        let mut performed = Vec::new();
        for thread in threads {
            let ended = thread.join().ok();
            performed
                .extend(ended.context("the thread of the simulated hands ended unexpectedly")??);
        }
        anyhow::Ok(performed)
    })?;
    Ok((performed, refused))
}

/// Number of recordings whose replay is not identical.
fn replays(swarm: &Swarm, folder: &Path, steps: &Steps) -> anyhow::Result<usize> {
    let bar = steps.bar("replaying");
    let mut different = 0;
    for (k, session) in swarm.sessions.iter().enumerate() {
        bar.set("replaying", k as f64 / swarm.sessions.len() as f64);
        let recording = Recording::open(&folder.join(&session.recording))?;
        let report = replay(&recording, &ReplayOptions::default(), &mut |_| ())?;
        if !report.identical {
            different += 1;
            tell!("{}: the replay is not identical", session.recording);
        }
    }
    bar.done();
    Ok(different)
}
