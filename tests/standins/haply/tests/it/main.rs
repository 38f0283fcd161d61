//! Rules of the stand-in of the Haply service, checked with a raw WebSocket client.

#![allow(clippy::unwrap_used)]

mod client;
mod devices;
mod faults;
mod forces;
mod hands;
mod judge;
mod process;
mod protocol;
mod rate;
mod settings;
