//! List of the devices of the service.

use std::time::Duration;

use super::NAME;
use super::address::Address;
use super::connect::{Connected, connect};
use super::inventory::ArmEntry;
use super::pairing::pair;
use crate::{Found, State};

/// Time limit of the list.
const MOST: Duration = Duration::from_millis(1_700);

/// Lists the arms of the service at `address`. No device moves or gets a force.
pub(super) fn list(address: &str) -> Vec<Found> {
    let address = match Address::parse(address) {
        Ok(address) => address,
        Err(sentence) => return vec![Found::nothing(NAME, State::Error, sentence)],
    };
    let connected = match connect(&address, MOST) {
        Ok(connected) => connected,
        Err(no) => return vec![Found::nothing(NAME, no.state, no.sentence)],
    };
    let arms = &connected.inventory.arms;
    let found: Vec<Found> = arms.iter().map(|arm| entry(arm, &connected)).collect();
    connected.line.close();
    if found.is_empty() {
        let sentence = format!(
            "the Haply service at {address} has no arm: connect an Inverse3 and its power supply"
        );
        return vec![Found::nothing(NAME, State::NoDevice, sentence)];
    }
    found
}

fn entry(arm: &ArmEntry, connected: &Connected) -> Found {
    let pairs = pair(std::slice::from_ref(&arm.id), &connected.inventory);
    let grip = pairs
        .as_ref()
        .ok()
        .and_then(|pairs| pairs.first()?.grip.clone());
    let against = connected.against(std::iter::once(arm.id.as_str()));
    let asleep = grip
        .as_ref()
        .is_some_and(|(_, id)| connected.inventory.grip(id).is_some_and(|grip| !grip.awake));
    let (status, id) = (&arm.status, &arm.id);
    let (state, message) = if let Some(sentence) = against {
        (State::Error, sentence)
    } else if status.in_use == Some(true) {
        (
            State::InUse,
            format!("another program uses the arm {id}: close that program"),
        )
    } else if status.power == Some(false) {
        (
            State::Asleep,
            format!("the arm {id} has no power: connect its power supply"),
        )
    } else if status.calibrated == Some(false) {
        (
            State::Uncalibrated,
            format!("the arm {id} is not calibrated: calibrate it with the Haply software"),
        )
    } else if let Err(sentence) = &pairs {
        (State::Ready, sentence.clone())
    } else if asleep {
        (
            State::Asleep,
            format!("the grip of the arm {id} sleeps: press its button"),
        )
    } else {
        (
            State::Ready,
            ready(&grip.as_ref().map(|(_, grip)| grip.as_str())),
        )
    };
    Found {
        library: NAME,
        model: arm.model.clone(),
        serial: arm.id.clone(),
        hand: arm.hand.clone(),
        motion_dof: if grip.is_some() { 6 } else { 3 },
        force_dof: 3,
        state,
        message,
    }
}

fn ready(grip: &Option<&str>) -> String {
    match grip {
        Some(grip) => format!("ready with the grip {grip}"),
        None => "ready without a grip: the orientation is constant".into(),
    }
}
