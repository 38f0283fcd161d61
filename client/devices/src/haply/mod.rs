//! Haply: Inverse3, Inverse3x and Minverse with a VerseGrip, by the Inverse service of the vendor.
//!
//! The service is a program of the vendor on this machine. The back-end speaks its simulation channel, a WebSocket with
//! JSON, and nothing of the vendor is linked. One connection drives all hands: each message carries the force of every
//! hand for one period, and each message has exactly one reply with the poses. The service displays no force without
//! messages.
//!
//! # Rate
//! The period of the messages is ours. [`Backend::open`] aims at the rate of the device model and measures what the
//! service answers; [`sulcus_haptics::HandInfo::period_ns`] is the result.
//!
//! # Grip
//! The arm measures the position, and the grip measures the orientation at about 50 Hz. The back-end rotates from one
//! measured orientation to the next over the measured interval of both, 40 ms at most. The orientation is therefore
//! late by one interval of the grip, 20 ms. An arm without a grip has three axes of motion and a constant orientation.
//!
//! No field of the service tells which grip is on which arm. A name `049D+61576` names arm and grip, `049D+none` an arm
//! without a grip. Otherwise arms and grips belong together in the order of the service, if their numbers are equal.
//!
//! # Place
//! The origin of the base is that of the service: the middle of the workspace with the preset `arm_front_centered`, and
//! the foot of the arm with another preset.
//!
//! # Force
//! Forces of several programs add up in the service. The back-end compares the force that the service reports with the
//! forces sent. A foreign force above 0.05 N takes the force away until a button is pressed.

#![cfg_attr(test, allow(clippy::unwrap_used))]

mod address;
mod axes;
mod back_off;
mod connect;
mod connector;
mod device;
mod event;
mod events;
mod flow;
mod foreign;
mod hand;
mod http;
mod inventory;
mod line;
mod listing;
mod loose;
mod message;
mod opening;
mod pairing;
mod reply;
mod run;
mod settings;
mod turning;
mod version;

use sulcus_haptics::device::{Device, DeviceError};

use crate::{Backend, Found};

/// Name of the library in lists and models.
const NAME: &str = "haply";
/// Environment variable with the address of the service.
const VARIABLE: &str = "SULCUS_HAPLY";
/// Address of the service without a setting.
const ADDRESS: &str = "127.0.0.1:10001";

/// Back-end of the Inverse service.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Haply {
    address: String,
}

impl Haply {
    /// Back-end of the service at `address`, host and port of its simulation channel, such as `127.0.0.1:10001`. The
    /// channel of events has the port number plus 19.
    pub fn at(address: impl Into<String>) -> Self {
        Self {
            address: address.into(),
        }
    }

    /// Address of the simulation channel.
    pub fn address(&self) -> &str {
        &self.address
    }
}

impl Default for Haply {
    /// Service at the address of the environment variable `SULCUS_HAPLY`, or at `127.0.0.1:10001`.
    fn default() -> Self {
        let set = std::env::var(VARIABLE).ok();
        let set = set.filter(|address| !address.trim().is_empty());
        Self::at(set.unwrap_or_else(|| ADDRESS.into()))
    }
}

impl Backend for Haply {
    fn name(&self) -> &'static str {
        NAME
    }

    fn list(&self) -> Vec<Found> {
        listing::list(&self.address)
    }

    fn open(&self, serials: &[String]) -> Result<Box<dyn Device>, DeviceError> {
        let device = opening::open(&self.address, serials).map_err(DeviceError)?;
        Ok(Box::new(device))
    }
}
