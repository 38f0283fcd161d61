//! Stand-in of the Force Dimension SDK: the functions of libdhd and libdrd, with their names and their ABI.
//!
//! The library finds its controller by the variable [`sulcus_standins::board::ENV`].
//! No call for poses or forces locks or allocates.
#![cfg(target_os = "linux")]
#![allow(non_snake_case)]

mod errors;
mod expert;
mod force;
mod info;
mod modes;
mod open;
mod pose;
mod regulation;
mod reset;
mod state;
