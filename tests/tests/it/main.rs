//! The programs from outside, over real sockets and real files.

mod addresses;
mod couplings;
mod demo;
mod documents;
mod export;
mod folders;
mod full_disk;
mod hand_written;
mod interrupt;
mod kill;
mod kills;
mod lessons;
mod long;
mod output;
mod readers;
mod refusals;
mod replays;
mod report;
mod sources;
mod station;
mod tidy;
