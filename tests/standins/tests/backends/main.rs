//! Tests of the back-ends of haptic devices against the stand-ins of the drivers, judged by the controller's log.
//!
//! A driver's library is loaded once in a process. Each session therefore runs in a process of its own, the example
//! `backend_client`.
#![cfg(target_os = "linux")]

#[path = "../../examples/backend_client/commands.rs"]
mod commands;
mod dhd;
mod dhd_faults;
mod hd;
mod hd_ends;
mod hd_faults;
mod judge;
mod listing;
mod session;
