//! The client as a library: the link, exercises, grades.

mod common;
mod events;
mod gaps;
mod grades;
mod heavy_hand;
mod levels;
mod link;
mod long;
mod patient;
mod protocol;
