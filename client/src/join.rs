//! `run`: joins a server that is already running.

use std::path::Path;

use anyhow::{Context, bail};
use serde_json::json;
use sulcus_core::optimise::SolverKind;

use crate::cli::RunArgs;
use crate::device::Simulated;
use crate::exercise;
use crate::link::{Link, LinkConfig, Pin};
use crate::perform::perform;
use crate::progress::Steps;

/// Joins; the exit code is 1 when the server was lost in mid-session.
///
/// # Errors
/// On bad input, and when the server is absent or refuses.
pub fn run(args: &RunArgs) -> anyhow::Result<u8> {
    if args.device != "simulated" {
        bail!(
            "unknown device `{}`, expected `simulated` (real devices are not supported yet)",
            args.device
        );
    }
    let config = link_config(args)?;
    let steps = Steps;
    let solver = SolverKind::ActiveSet;
    let prepared = exercise::prepare(
        "crown",
        args.scene.as_deref(),
        args.duration,
        args.seed,
        solver,
        &steps,
    )?;
    for warning in &prepared.warnings {
        eprintln!("warning: {warning}");
    }
    let link = Link::connect(config)?;
    let hello = link.hello();
    if hello.scene_hash != prepared.scene_hash() {
        bail!(
            "the server simulates scene `{}`, which is not the `{}` that the simulated operator knows: name the server's with --scene",
            hello.scene,
            prepared.scene.name
        );
    }
    let ran = perform(
        link,
        Simulated(prepared.operator),
        prepared.ticks,
        None,
        &steps,
    )?;
    if args.json {
        println!(
            "{}",
            json!({ "device": ran.report, "link": ran.stats, "session": ran.summary })
        );
    } else {
        let r = &ran.report;
        println!(
            "device        {} periods, {} overslept",
            r.periods, r.overslept
        );
        println!(
            "force         {:.2} N at most, {:.3} N per ms at most, {:.3} N at the end",
            r.max_displayed_n, r.max_displayed_step_n, r.last_displayed_n
        );
        println!(
            "round trip    p50 {:.0}  p99 {:.0} us",
            ran.stats.rtt_us.p50, ran.stats.rtt_us.p99
        );
        if let Some(summary) = &ran.summary {
            println!(
                "session       {} ticks, recorded by the server as {}",
                summary.ticks, summary.recording
            );
        }
    }
    if ran.report.server_lost {
        eprintln!("error: the server fell silent; the force was taken to zero");
        return Ok(1);
    }
    Ok(0)
}

fn link_config(args: &RunArgs) -> anyhow::Result<LinkConfig> {
    let mut config = match (&args.ticket, &args.token, &args.certificate) {
        (Some(ticket), _, _) => LinkConfig::new(args.server, &ticket.parse()?, &args.device),
        (None, Some(token), Some(file)) => {
            let ticket = sulcus_proto::Ticket {
                token: token.clone(),
                fingerprint: [0; 32],
            };
            let pin = Pin::Certificate(read(file)?);
            LinkConfig {
                pin,
                ..LinkConfig::new(args.server, &ticket, &args.device)
            }
        }
        _ => bail!(
            "whom to trust is missing: give --ticket as the server prints it, or --token with --certificate"
        ),
    };
    config.learner.clone_from(&args.learner);
    Ok(config)
}

fn read(file: &Path) -> anyhow::Result<Vec<u8>> {
    std::fs::read(file).with_context(|| format!("cannot read the certificate `{}`", file.display()))
}
