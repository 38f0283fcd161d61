//! Back-end of the Force Dimension SDK, for the devices delta, omega, sigma and lambda, and for the Novint Falcon.
//!
//! Each device has a thread of its own, `serve`, at up to 4 kHz. `servo` is one period of that thread. `run`
//! starts the threads and says what happens.

mod api;
mod axes;
mod errors;
mod listing;
mod models;
mod pace;
mod report;
mod run;
mod serve;
mod servo;
mod shared;
mod sys;
mod unit;

use sulcus_haptics::device::{Device, DeviceError};

use self::api::Dhd;
use self::run::Session;
use self::unit::Unit;
use crate::{Backend, Found};

/// Name of the back-end.
const LIBRARY: &str = "forcedimension";

/// Back-end of the Force Dimension SDK.
#[derive(Clone, Debug, Default)]
pub struct ForceDimension {}

impl Backend for ForceDimension {
    fn name(&self) -> &'static str {
        LIBRARY
    }

    fn list(&self) -> Vec<Found> {
        listing::list()
    }

    fn open(&self, serials: &[String]) -> Result<Box<dyn Device>, DeviceError> {
        if serials.is_empty() {
            return Err(DeviceError(
                "Force Dimension SDK: no serial number of a device is given".into(),
            ));
        }
        let dhd = Dhd::load().map_err(|error| DeviceError(error.to_string()))?;
        if let Some(text) = listing::too_old(&dhd) {
            return Err(DeviceError(text));
        }
        let open =
            |serial: &String| Unit::open(dhd, serial).map_err(|refusal| DeviceError(refusal.text));
        let units: Vec<Unit> = serials.iter().map(open).collect::<Result<_, _>>()?;
        Ok(Box::new(Session::new(dhd, units)))
    }
}
