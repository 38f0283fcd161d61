//! Stand-in of OpenHaptics HDAPI. Its functions have the names and the ABI of the vendor's library.
//!
//! The library finds its controller by the variable [`sulcus_standins::board::ENV`].
//! The scheduler calls every callback on one thread.
//! No call within a frame locks or allocates.
#![cfg(target_os = "linux")]
#![allow(non_snake_case)]

mod calibration;
mod callbacks;
mod capabilities;
mod errors;
mod frame;
mod get;
mod get_double;
mod open;
mod reset;
mod scheduler;
mod set;
mod state;
mod values;
