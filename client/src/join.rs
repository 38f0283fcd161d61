//! `sulcus-client run`: joins a running server.

use std::io::BufReader;
use std::net::{SocketAddr, ToSocketAddrs};
use std::path::Path;
use std::sync::mpsc::{Sender, channel};
use std::time::Duration;

use anyhow::{Context, bail};
use serde_json::json;
use sulcus_connection::at_hand::HandTicker;
use sulcus_connection::device::EventDevice;
use sulcus_connection::link::{Link, LinkConfig, Pin};
use sulcus_connection::perform::perform;
use sulcus_connection::progress::Steps;
use sulcus_demo::exercise;
use sulcus_demo::place::tell_place;
use sulcus_demo::seat::{Ending, Seat, taken};
use sulcus_demo::simulated::Simulated;
use sulcus_program::{PathText, say, tell};
use sulcus_proto::control::{EndReason, ServerHello};

use crate::cli::RunArgs;
use crate::devices::guided::Guided;
use crate::devices::hands::Hands;
use crate::devices::recorded::{Playback, Recorded};
use crate::typed::{WithReadings, listen};

/// Longest wait for the answer to a code.
const CODE: Duration = Duration::from_secs(60);

/// Joins a server and performs one session. The exit code is 0, or 1 if the server was lost or its recording is not
/// complete.
///
/// # Errors
/// Bad input, a server that does not answer or refuses, another scene at the server, or a session that cannot begin.
pub fn run(args: &RunArgs) -> anyhow::Result<u8> {
    run_at(args, None)
}

/// The same with the device in a seat.
///
/// # Errors
/// The errors of [`run`].
pub fn run_at(args: &RunArgs, seat: Seat<'_>) -> anyhow::Result<u8> {
    let hands = Hands::of(args, seat)?;
    let mut config = link_config(args)?;
    let performer = hands.name(seat).to_owned();
    let (opened, recorded) = hands.open(args.probe_hand)?;
    let steps = Steps;
    let asked = exercise::Asked {
        scene: args.scene.as_deref(),
        duration_s: args.duration,
        habit: args.habit,
        patient_seed: args.patient_seed,
        hand_seed: args.seed,
        rate_hz: args.rate_hz,
        ..exercise::Asked::of(&args.exercise)
    };
    let prepared = exercise::prepare(&asked, &steps)?;
    for warning in &prepared.warnings {
        tell!("warning: {warning}");
    }
    config.exercise.clone_from(&prepared.exercise.name);
    config.tick = args.tick.into();
    config.scene_hash = prepared.scene_hash();
    config.devices = match &opened {
        Some(opened) => opened.describe(prepared.scene.tick_s()),
        None => LinkConfig::in_both_hands(&performer),
    };
    if let Some(opened) = &opened {
        let zones = &prepared.exercise.zones;
        let force_n = (!zones.is_empty()).then_some(prepared.exercise.probing.force_n[0]);
        for remark in opened.hands().flat_map(|hand| hand.remarks(force_n)) {
            tell!("note: {remark}");
        }
    }
    let link =
        Link::connect(config.clone()).with_context(|| format!("server `{}`", args.server))?;
    tell_place(&link);
    let hello = link.hello();
    // A person needs no scene: the server's display is enough.
    let is_simulated = opened.is_none() && recorded.is_none() && performer == "simulated";
    if is_simulated && hello.scene_hash != prepared.scene_hash() {
        bail!(
            "the server simulates scene `{}`, which differs from the simulated operator's scene `{}`; give the server's scene file with --scene, the seed of its patient with --patient-seed, and its rate with --rate-hz",
            hello.scene,
            prepared.scene.name
        );
    }
    let periods = prepared.periods(args.duration, !is_simulated);
    let device: Box<dyn EventDevice> = match (opened, recorded) {
        (Some(opened), _) => Box::new(opened.begin(hello, Some(lines()?))?),
        (None, Some(recorded)) => Box::new(Playback::new(recorded)),
        (None, None) => Box::new(Simulated {
            operator: prepared.operator,
            until_done: prepared.until_done,
        }),
    };
    let device = match &args.ghost {
        Some(file) => ghost(file, args.guide, hello, device)?,
        None => device,
    };
    let device = if args.readings {
        let lines = BufReader::new(std::io::stdin());
        let device = WithReadings::new(device, listen(lines, prepared.scene.clone())?);
        taken(seat, &config, &link, &prepared.exercise, device)
    } else {
        taken(seat, &config, &link, &prepared.exercise, device)
    };
    let mode = link.hello().plan.mode.clone();
    let hand = HandTicker::on(&link, &prepared.scene)?;
    let ran = perform(link, device, periods, None, hand, &steps)?;
    if let Some(screen) = seat.filter(|_| ran.goodbye.is_ok()) {
        (screen.ended)(&Ending::Elsewhere(&mode));
    }
    let summary = ran.goodbye.as_ref().ok().map(|goodbye| &goodbye.summary);
    if args.json {
        let text = ran
            .goodbye
            .as_ref()
            .map_or_else(ToString::to_string, |goodbye| goodbye.text.clone());
        let lost = ran.goodbye.is_err();
        say!(
            "{}",
            json!({ "device": ran.report, "link": ran.stats, "session": summary, "goodbye": text, "server_lost": lost })
        );
    } else {
        let (r, rtt, network) = (&ran.report, &ran.stats.rtt_us, &ran.stats.network_us);
        say!(
            "device        {} periods, {} of them missed",
            r.periods,
            r.overslept
        );
        say!(
            "force         {:.2} N at most, changed by {:.3} N at most between two periods, {:.3} N at the end",
            r.max_displayed_n,
            r.max_displayed_step_n,
            r.last_displayed_n
        );
        say!(
            "pose to wrench  p50 {:.0}  p99 {:.0} us, with the wait for the server's tick",
            rtt.p50,
            rtt.p99
        );
        say!(
            "phase         {:.0} us before the server's tick, deviation {:.0} us, {} poses missed their tick",
            r.phase.aim_us,
            r.phase.deviation_us,
            r.phase.missed
        );
        say!(
            "network       p50 {:.0}  p99 {:.0} us, both ways",
            network.p50,
            network.p99
        );
        if let Some(summary) = summary {
            say!(
                "session       {} ticks, recorded by the server as {}",
                summary.ticks,
                summary.recording
            );
        }
    }
    match &ran.goodbye {
        Err(error) => {
            tell!("error: {error}; the displayed force has been taken to zero");
            Ok(1)
        }
        Ok(goodbye) => {
            if goodbye.summary.end != EndReason::Stopped {
                tell!("the server ended the session: {}", goodbye.text);
            }
            Ok(u8::from(!goodbye.summary.complete))
        }
    }
}

/// Ghost of the recording `file` beside `device`, with a guide of at most `most_n` newtons.
fn ghost(
    file: &Path,
    most_n: f64,
    hello: &ServerHello,
    device: Box<dyn EventDevice>,
) -> anyhow::Result<Box<dyn EventDevice>> {
    let recorded = Recorded::read(file)?;
    if recorded.scene_hash != hello.scene_hash {
        bail!(
            "the ghost {} was recorded in another scene than the server's `{}`; record the exercise on this server",
            file.shown(),
            hello.scene
        );
    }
    Ok(Box::new(Guided::new(device, &recorded, most_n)))
}

/// Takes lines for the person, and prints them from a thread of its own: the loop of the devices never waits.
fn lines() -> anyhow::Result<Sender<String>> {
    let (send, take) = channel();
    let print = move || {
        for line in take {
            tell!("{line}");
        }
    };
    std::thread::Builder::new()
        .name("sulcus-lines".into())
        .spawn(print)?;
    Ok(send)
}

fn link_config(args: &RunArgs) -> anyhow::Result<LinkConfig> {
    let (server, others) = resolve(&args.server)?;
    let ticket = match (&args.ticket, &args.token) {
        (None, Some(_)) => None,
        (given, _) => ticket(given.as_deref()),
    };
    let mut config = match (&ticket, &args.token, &args.certificate) {
        (Some(ticket), _, _) => LinkConfig::new(server, &ticket.parse()?, ""),
        (None, Some(token), Some(file)) => {
            let ticket = sulcus_proto::Ticket {
                token: token.clone(),
                fingerprint: [0; 32],
            };
            let pin = Pin::Certificate(read(file)?);
            LinkConfig {
                pin,
                ..LinkConfig::new(server, &ticket, "")
            }
        }
        _ => bail!(
            "the ticket is missing: give the ticket that the server prints with --ticket or SULCUS_TICKET, or give --token and --certificate"
        ),
    };
    config.learner.clone_from(&args.learner);
    if let Some(claim) = &args.code {
        config.learner.clone_from(claim);
        // The server compiles the plan of the learner before its answer.
        config.timeout = CODE;
    }
    config.others = others;
    Ok(config)
}

/// Ticket of the option, else of the environment: other users of the machine see arguments, but not the environment.
pub(crate) fn ticket(given: Option<&str>) -> Option<String> {
    let from_environment = || {
        std::env::var("SULCUS_TICKET")
            .ok()
            .filter(|ticket| !ticket.is_empty())
    };
    given.map(str::to_owned).or_else(from_environment)
}

/// First address of `HOST:PORT`, and the other addresses of the name.
pub(crate) fn resolve(server: &str) -> anyhow::Result<(SocketAddr, Vec<SocketAddr>)> {
    let mut found = server
        .to_socket_addrs()
        .with_context(|| format!("--server is `{server}`, expected HOST:PORT"))?;
    let first = found
        .next()
        .with_context(|| format!("--server is `{server}`, a name without an address"))?;
    Ok((first, found.collect()))
}

fn read(file: &Path) -> anyhow::Result<Vec<u8>> {
    std::fs::read(file).with_context(|| format!("--certificate {}: cannot read", file.shown()))
}
