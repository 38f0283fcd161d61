//! The router from outside, without a socket: every route for every role, foreign origins, streams.
#![allow(clippy::unwrap_used)]

mod cases;
mod clients;
mod first;
mod house;
mod register;
mod results;
mod roles;
mod streams;
mod view;
