//! The instructor's console in a real browser, with four students at their stations.
#![allow(clippy::unwrap_used)]

mod browser;
mod cases;
mod class;
mod classes;
mod live;
mod looks;
mod results;
mod room;
