//! Events on paths that are laid out by hand, in a scene of two round teeth: what is told, when, and nothing else.
#![allow(
    clippy::disallowed_methods,
    reason = "paths of a made-up hand, which need not be the same bits everywhere"
)]
#![allow(clippy::unwrap_used)]

mod call;
mod probing;
mod target;
mod two_teeth;
