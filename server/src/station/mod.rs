//! A station: its configuration, and the handle by which a program runs it.

pub mod config;
pub mod handle;
