//! Grades from outside: what gets one and what gets none, how each mode shows it, and what the program writes.
#![allow(clippy::unwrap_used)]

mod continued;
mod modes;
mod place;
mod program;
mod recordings;
mod unfelt;
