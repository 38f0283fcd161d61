//! Back-end `haply` of the client against the stand-in.
//!
//! The tests run one after another: the machine has few processors, and each test needs a steady period.

#![allow(clippy::unwrap_used)]

mod capture;
mod doors;
mod ending;
mod faults;
mod faults_of_devices;
mod forces;
mod hands;
mod judged;
mod opening;
mod returns;
mod rig;
mod versions;
