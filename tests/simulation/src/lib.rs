//! A class in virtual time: sessions, hands and networks in one thread, with faults drawn from a seed.
//!
//! A run of one [`run::Name`] draws commands and faults ([`faults`]), steps the loops of server and client through them
//! ([`run`]), and shows what happens ([`seen`]) to the [`invariants`]. The same name gives the same events and the same
//! recording, bit for bit. [`class`] runs many names on all cores.

pub mod class;
pub mod control;
pub mod faults;
pub mod findings;
pub mod hand;
pub mod invariants;
pub mod known;
pub mod log;
pub mod machine;
pub mod replayed;
pub mod run;
pub mod scene;
pub mod seen;

/// Time since 1970 at the virtual time 0, nanoseconds.
pub const BEGAN: u64 = 1_790_000_000_000_000_000;
