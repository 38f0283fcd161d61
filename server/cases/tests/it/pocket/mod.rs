//! A probe in the pocket of one molar, through the whole tick: depths, forces, turning, release.

pub mod calm;
mod limits;
mod reading;
mod reentry;
mod release;
pub mod run;
