//! The client's end of a session: the [`link`] to a server over QUIC, and the [`device_loop`] of a haptic device on it.
//!
//! [`perform::perform`] runs a [`device::EventDevice`] on a connected [`link::Link`] from the start of a session to the
//! goodbye of the server. Beyond a LAN the ticks of the session may run here, beside the device: [`at_hand`]. The crate
//! knows no exercise and no recording; path of the wrench to the hand: `sulcus-haptics`.

#![cfg_attr(not(test), warn(clippy::print_stdout, clippy::print_stderr))]

pub mod at_hand;
pub mod carrier;
pub mod device;
pub mod device_loop;
pub mod display;
pub mod instructor;
pub mod interrupt;
pub mod link;
pub mod perform;
pub mod phase;
pub mod progress;
pub mod report;
pub mod threaded;
