//! The client as a library: the link, exercises, grades.

mod at_hand;
mod common;
mod couplings;
mod devices;
mod display;
mod events;
mod flood;
mod gaps;
mod ghost;
mod grades;
mod heavy_hand;
mod levels;
mod link;
mod long;
mod networks;
mod patient;
mod protocol;
mod roles;
mod shown_ghost;
mod stations;
mod swarm;
