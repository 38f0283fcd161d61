//! Back-end of OpenHaptics, for the devices Touch, Touch X and Phantom Premium of 3D Systems.
//!
//! The library has one scheduler with one thread for all devices. `servo` is its callback. For each device the
//! callback begins a frame, reads pose and buttons, exchanges both at the hand's door for a wrench, sends the wrench and ends the
//! frame.
//! `run` supervises the scheduler from the thread of the run. `service` is the way into and out of the scheduler.

mod api;
pub(crate) mod backoff;
mod calibration;
mod errors;
mod frame;
mod hand;
mod listing;
mod names;
pub(crate) mod pose;
mod report;
mod run;
mod service;
mod servo;
mod shared;
mod sys;
mod unit;

use sulcus_haptics::device::{Device, DeviceError};

use self::api::Hd;
use self::run::Session;
use self::shared::HANDS;
use self::unit::{Refusal, Unit};
use crate::{Backend, Found, State};

/// Name of the back-end.
const LIBRARY: &str = "openhaptics";

/// Back-end of OpenHaptics.
#[derive(Clone, Debug, Default)]
pub struct OpenHaptics {}

impl Backend for OpenHaptics {
    fn name(&self) -> &'static str {
        LIBRARY
    }

    fn list(&self) -> Vec<Found> {
        listing::list()
    }

    fn open(&self, serials: &[String]) -> Result<Box<dyn Device>, DeviceError> {
        if serials.is_empty() || serials.len() > HANDS {
            return Err(DeviceError(format!(
                "OpenHaptics opens 1 to {HANDS} devices, not {}",
                serials.len()
            )));
        }
        if !unit::used().is_empty() {
            return Err(DeviceError(
                "a session of this program uses OpenHaptics already: end that session first".into(),
            ));
        }
        let hd = Hd::load().map_err(|error| DeviceError(error.to_string()))?;
        let configs = names::configs(&names::directories());
        let mut units: Vec<Unit> = Vec::new();
        for wanted in serials {
            let unit = open(hd, wanted, &configs).map_err(|refusal| DeviceError(refusal.text))?;
            units.push(unit);
        }
        Ok(Box::new(Session::new(hd, units)))
    }
}

/// Opens the device with the name or serial number `wanted`.
fn open(hd: Hd, wanted: &str, configs: &[names::Config]) -> Result<Unit, Refusal> {
    let (named, unknown) = names::candidates(wanted, configs);
    let mut first = None;
    for name in named {
        match Unit::open(hd, name.as_deref()) {
            Ok(unit) => return Ok(unit),
            Err(refusal) => first = first.or(Some(refusal)),
        }
    }
    for name in unknown {
        match Unit::open(hd, name.as_deref()) {
            Ok(unit) if unit.info.serial == wanted => return Ok(unit),
            Ok(_) => {}
            Err(refusal) if refusal.code == 0 => return Err(refusal),
            Err(_) => {}
        }
    }
    Err(first.unwrap_or_else(|| {
        let names: Vec<_> = configs.iter().map(|config| config.name.as_str()).collect();
        let known = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
        Refusal {
            state: State::NoDevice,
            code: 0,
            text: format!(
                "OpenHaptics has no device {wanted}: the configured devices are {known}; run the setup program of the \
                 driver"
            ),
        }
    }))
}
