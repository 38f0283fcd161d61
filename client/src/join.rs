//! `sulcus-client run`: joins a running server.

use std::io::BufReader;
use std::net::{SocketAddr, ToSocketAddrs};
use std::path::Path;

use anyhow::{Context, bail};
use serde_json::json;
use sulcus_connection::link::{Link, LinkConfig, Pin};
use sulcus_connection::perform::perform;
use sulcus_connection::progress::Steps;
use sulcus_demo::exercise;
use sulcus_demo::seat::{self, Ending, Seat, taken};
use sulcus_demo::simulated::Simulated;
use sulcus_program::{PathText, say, tell};
use sulcus_proto::control::EndReason;

use crate::cli::RunArgs;
use crate::typed::{WithReadings, listen};

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
    if args.device != "simulated" {
        bail!(
            "--device is `{}`, expected `simulated`; real devices are not supported yet",
            args.device
        );
    }
    let mut config = link_config(args)?;
    config.device.name = seat::device(seat).to_owned();
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
    let link =
        Link::connect(config.clone()).with_context(|| format!("server `{}`", args.server))?;
    let hello = link.hello();
    // A person needs no scene: the server's display is enough.
    let is_simulated = seat::device(seat) == "simulated";
    if is_simulated && hello.scene_hash != prepared.scene_hash() {
        bail!(
            "the server simulates scene `{}`, which differs from the simulated operator's scene `{}`; give the server's scene file with --scene, the seed of its patient with --patient-seed, and its rate with --rate-hz",
            hello.scene,
            prepared.scene.name
        );
    }
    let device = Simulated {
        operator: prepared.operator,
        until_done: prepared.until_done,
    };
    let device = if args.readings {
        let lines = BufReader::new(std::io::stdin());
        let device = WithReadings::new(device, listen(lines, prepared.scene.clone())?);
        taken(seat, &config, &link, &prepared.exercise, device)
    } else {
        taken(seat, &config, &link, &prepared.exercise, device)
    };
    let mode = link.hello().plan.mode.clone();
    let ran = perform(link, device, prepared.ticks, None, &steps)?;
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

fn link_config(args: &RunArgs) -> anyhow::Result<LinkConfig> {
    let (server, others) = resolve(&args.server)?;
    // Other users of the machine see arguments, but not the environment.
    let from_environment = || {
        std::env::var("SULCUS_TICKET")
            .ok()
            .filter(|ticket| !ticket.is_empty())
    };
    let ticket = match (&args.ticket, &args.token) {
        (None, None) => from_environment(),
        (ticket, _) => ticket.clone(),
    };
    let mut config = match (&ticket, &args.token, &args.certificate) {
        (Some(ticket), _, _) => LinkConfig::new(server, &ticket.parse()?, &args.device),
        (None, Some(token), Some(file)) => {
            let ticket = sulcus_proto::Ticket {
                token: token.clone(),
                fingerprint: [0; 32],
            };
            let pin = Pin::Certificate(read(file)?);
            LinkConfig {
                pin,
                ..LinkConfig::new(server, &ticket, &args.device)
            }
        }
        _ => bail!(
            "the ticket is missing: give the ticket that the server prints with --ticket or SULCUS_TICKET, or give --token and --certificate"
        ),
    };
    config.learner.clone_from(&args.learner);
    config.others = others;
    Ok(config)
}

/// First address of `HOST:PORT`, and the other addresses of the name.
fn resolve(server: &str) -> anyhow::Result<(SocketAddr, Vec<SocketAddr>)> {
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
