//! A station: its configuration, the task that lives as long as the server, and the handle by which a program runs it.
//!
//! Connections hold a [`door::Door`] and never the station itself. The task `actor` owns plan, levels and session.

pub(crate) mod actor;
pub(crate) mod at_hand;
mod attach;
pub mod config;
pub mod door;
pub(crate) mod gap;
mod ghost;
pub mod handle;
mod instruct;
pub(crate) mod journal;
pub mod planner;
pub(crate) mod quota;
mod session;
pub(crate) mod shared;
