//! Events on paths that are laid out by hand, in a scene of two round teeth: what is told, when, and nothing else.
#![allow(clippy::unwrap_used)]

mod call;
mod probing;
mod target;
mod two_teeth;
