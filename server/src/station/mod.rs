//! A station: its configuration, the task that lives as long as the server, and the handle by which a program runs it.
//!
//! Connections hold a [`door::Door`] and never the station itself. The task `actor` owns plan, levels and session.

pub(crate) mod actor;
pub mod config;
pub mod door;
pub(crate) mod gap;
pub mod handle;
mod instruct;
pub(crate) mod journal;
pub mod planner;
mod session;
pub(crate) mod shared;
