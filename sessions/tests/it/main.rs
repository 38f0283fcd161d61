//! Recordings: read, replayed, damaged, graded.

mod channels;
mod cli;
mod cli_replay;
mod common;
mod corpus;
mod couplings;
mod devices;
mod events;
mod exercise;
mod gaps;
mod grade;
mod kill;
mod migrated;
mod mutated;
mod recover;
mod replay;
mod rewrites;
mod span;
mod stock;
mod tamper;
mod torn;
mod viewers;
mod what_if;
