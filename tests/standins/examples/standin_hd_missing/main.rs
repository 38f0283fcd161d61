//! The stand-in of HDAPI without `hdGetDoublev`, for a client's error about a missing symbol.
#![cfg(target_os = "linux")]
#![allow(non_snake_case)]

#[path = "../standin_hd/calibration.rs"]
mod calibration;
#[path = "../standin_hd/callbacks.rs"]
mod callbacks;
#[path = "../standin_hd/capabilities.rs"]
mod capabilities;
#[path = "../standin_hd/errors.rs"]
mod errors;
#[path = "../standin_hd/frame.rs"]
mod frame;
#[path = "../standin_hd/get.rs"]
mod get;
#[path = "../standin_hd/open.rs"]
mod open;
#[path = "../standin_hd/reset.rs"]
mod reset;
#[path = "../standin_hd/scheduler.rs"]
mod scheduler;
#[path = "../standin_hd/set.rs"]
mod set;
#[path = "../standin_hd/state.rs"]
mod state;
#[path = "../standin_hd/values.rs"]
mod values;
