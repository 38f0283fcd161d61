//! Recordings: read, replayed, damaged, graded.

mod channels;
mod cli;
mod cli_replay;
mod common;
mod corpus;
mod events;
mod exercise;
mod grade;
mod kill;
mod migrated;
mod mutated;
mod recover;
mod replay;
mod span;
mod tamper;
mod torn;
mod what_if;
