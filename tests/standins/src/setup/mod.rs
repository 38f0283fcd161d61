//! What a test sets before the controller starts: devices, drivers and hands.

mod hand;
mod models;

pub use hand::{Grip, Hand, Motion};

use crate::board::{Calibration, Family, Traits};
use serde::{Deserialize, Serialize};

/// All settings of a controller.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Setup {
    /// One to four device boxes. HDAPI and DHD number the devices of their family in this order.
    pub devices: Vec<DeviceSetup>,
    /// Settings of the driver libraries.
    pub driver: DriverSetup,
    /// True: the controller and the driver's scheduler ask for the real-time class.
    pub realtime: bool,
}

impl Setup {
    /// Settings with these devices and the usual driver.
    pub fn new(devices: Vec<DeviceSetup>) -> Self {
        Self {
            devices,
            driver: DriverSetup::default(),
            realtime: true,
        }
    }
}

/// Settings of the driver libraries.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct DriverSetup {
    /// Version that `hdGetString` shows.
    pub hd_version: String,
    /// Version that `dhdGetSDKVersion` shows.
    pub dhd_version: [u32; 4],
    /// Scheduler rates in Hz that HDAPI accepts; at most four.
    pub rates: Vec<u32>,
    /// Real rate of the scheduler in Hz; 0 for the rate that the client set.
    pub real_rate: u32,
    /// Largest random delay of a scheduler tick in us.
    pub jitter_us: u32,
    /// True: `hdDisableDevice` ends in a memory fault, as on FireWire models.
    pub crash_on_disable: bool,
}

impl Default for DriverSetup {
    fn default() -> Self {
        Self {
            hd_version: "3.4.0".into(),
            dhd_version: [3, 17, 5, 0],
            rates: vec![1000],
            real_rate: 0,
            jitter_us: 0,
            crash_on_disable: false,
        }
    }
}

/// Settings of one device box.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct DeviceSetup {
    /// Vendor's library that drives the device.
    pub family: Family,
    /// Name in the driver's configuration; HDAPI opens a device by this name.
    pub name: String,
    /// Name of the model.
    pub model: String,
    /// Serial number; a number below 65536 for a DHD device.
    pub serial: String,
    /// Name of the vendor.
    pub vendor: String,
    /// Version of the firmware.
    pub firmware: String,
    /// Version of the device driver.
    pub driver_version: String,
    /// Properties of the model.
    pub traits: Traits,
    /// Time without a command after which the hardware turns the motors off, in ms; 0 for never.
    pub watchdog_ms: f64,
    /// Time from a command to the motors in us.
    pub latency_us: f64,
    /// Step of the position encoders in m; 0 for none.
    pub step: f64,
    /// Step of the rotation encoders in rad; 0 for none.
    pub angle_step: f64,
    /// Damping of the mechanics in N s/m.
    pub damping: f64,
    /// Coulomb friction of the mechanics in N.
    pub friction: f64,
    /// Apparent mass of the mechanics at the handle in kg.
    pub mass: f64,
    /// Weight of the handle as a mass in kg, which only gravity compensation of DHD carries; 0 for a balanced arm.
    pub weight: f64,
    /// Further damping in mode brake in N s/m.
    pub brake: f64,
    /// Heat that the motors bear, in s. The heat grows by the square of force over continuous force, less one, per s.
    pub heat_budget: f64,
    /// Speed in m/s above which a DHD controller brakes; 0 for none.
    pub speed_trip: f64,
    /// Calibration at power-on.
    pub calibration: CalibrationSetup,
    /// True while the FORCE button of a DHD device is lit.
    pub lit: bool,
    /// Error code that every opening of the device reports; 0 for none.
    pub open_error: u32,
    /// The hand at the device.
    pub hand: Hand,
}

/// Calibration of a device at power-on.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct CalibrationSetup {
    /// State at power-on. A DHD device that is not calibrated starts in mode reset.
    pub state: Calibration,
    /// Updates until the calibration is right.
    pub updates: u32,
    /// Error of the position in m until then.
    pub offset: [f64; 3],
}

impl Default for CalibrationSetup {
    fn default() -> Self {
        Self {
            state: Calibration::Ok,
            updates: 1,
            offset: [0.0; 3],
        }
    }
}

impl DeviceSetup {
    /// The same device with another hand.
    pub fn with_hand(mut self, hand: Hand) -> Self {
        self.hand = hand;
        self
    }

    /// The same device in a calibration state, with `updates` until it is right.
    pub fn with_calibration(mut self, state: Calibration, updates: u32) -> Self {
        self.calibration.state = state;
        self.calibration.updates = updates;
        self
    }
}
