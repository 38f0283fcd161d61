//! Haptic devices of a station: list, settings, choice, check, measurement.

pub mod choose;
mod forceless;
pub mod guided;
pub mod hands;
pub mod identify;
mod measuring;
pub mod opened;
mod path;
pub mod recorded;
pub mod settings;
mod touches;

use std::path::PathBuf;

use serde_json::json;
use sulcus_devices::doctor::{Asked, Roots, examine};
use sulcus_devices::{Found, State};
use sulcus_program::say;
use sulcus_proto::Ticket;

use crate::cli::{DevicesArgs, DevicesCommand, DoctorArgs};
use settings::Settings;

/// Runs `devices` and its commands.
///
/// # Errors
/// The settings are invalid, or a device cannot be opened or measured.
pub fn run(args: &DevicesArgs) -> anyhow::Result<u8> {
    match &args.command {
        None => list(args.json),
        Some(DevicesCommand::Hands) => identify::run(),
        Some(DevicesCommand::Measure(args)) => measuring::run(args),
        Some(DevicesCommand::Handle(args)) => touches::run(args),
    }
}

/// Checks this station. The exit code is 1 if a check is not ok.
///
/// # Errors
/// None at present.
pub fn doctor(args: &DoctorArgs) -> anyhow::Result<u8> {
    let ticket = std::env::var("SULCUS_TICKET")
        .ok()
        .filter(|ticket| !ticket.is_empty());
    let ticket = ticket.map(|text| text.parse::<Ticket>());
    let read = |ticket: &Result<Ticket, _>| match ticket {
        Ok(Ticket { fingerprint, .. }) => Ok(sulcus_proto::hex::hex(fingerprint)),
        Err(error) => Err(format!("{error}")),
    };
    let mut checks = examine(&Asked {
        recordings: args.recordings.clone(),
        server: args.server.clone(),
        ticket: ticket.as_ref().map(read),
        roots: Roots::system(),
    });
    if let Some(server) = &args.server {
        let ticket = ticket.as_ref().and_then(|ticket| ticket.as_ref().ok());
        checks.push(path::check(server, ticket));
    }
    let all_ok = checks.iter().all(|check| check.ok);
    if args.json {
        say!("{}", json!({ "checks": checks }));
    } else {
        for check in &checks {
            let mark = if check.ok { "ok  " } else { "MEND" };
            say!("{mark}  {:<28} {}", check.name, check.message);
        }
    }
    Ok(u8::from(!all_ok))
}

/// Settings of this station, with their file.
///
/// # Errors
/// The file is invalid.
pub fn stored() -> anyhow::Result<(Settings, Option<PathBuf>)> {
    let file = Settings::file();
    let settings = file.as_deref().map(Settings::read).transpose()?;
    Ok((settings.unwrap_or_default(), file))
}

/// Lists the devices of all back-ends.
///
/// # Errors
/// The settings file is invalid.
pub fn list(as_json: bool) -> anyhow::Result<u8> {
    let (settings, _) = stored()?;
    let mut found = opened::found(&settings);
    found.extend(forceless::forceless());
    if as_json {
        say!("{}", json!({ "devices": found }));
        return Ok(0);
    }
    for found in &found {
        say!("{}", line(found));
    }
    Ok(0)
}

/// Line of the list for a person.
fn line(found: &Found) -> String {
    if found.serial.is_empty() {
        return format!("{:<15} {}", found.library, found.message);
    }
    let hand = if found.hand.is_empty() {
        String::new()
    } else {
        format!(", {} hand", found.hand)
    };
    if found.library == found.serial {
        return format!(
            "{:<15} {}, without force: {}",
            found.library, found.model, found.message
        );
    }
    let ready = if found.state == State::Ready {
        ""
    } else {
        "not ready: "
    };
    format!(
        "{:<15} {}:{}  {}{hand}, moves in {} axes, force in {}: {ready}{}",
        found.library,
        found.library,
        found.serial,
        found.model,
        found.motion_dof,
        found.force_dof,
        found.message
    )
}
