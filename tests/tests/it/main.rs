//! The programs from outside, over real sockets and real files.

mod demo;
mod export;
mod full_disk;
mod interrupt;
mod kill;
mod kills;
mod lessons;
mod long;
mod readers;
mod refusals;
mod replays;
mod report;
mod station;
