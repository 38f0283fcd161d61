//! The client as a library: the link, exercises, grades.

mod common;
mod display;
mod events;
mod flood;
mod gaps;
mod grades;
mod heavy_hand;
mod levels;
mod link;
mod long;
mod patient;
mod protocol;
mod roles;
mod stations;
mod swarm;
