//! Tests of the stand-ins, which load them as a client would.
#![cfg(target_os = "linux")]

mod dhd;
mod dhd_modes;
mod hd_abi;
mod hd_calibration;
mod hd_devices;
mod hd_faults;
mod hd_frames;
mod hd_scheduler;
mod log;
mod process;
mod support;
