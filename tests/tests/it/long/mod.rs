//! Proofs of minutes: see the table of long proofs in `sulcus-support`.

mod console;
mod kills;
mod replays;
mod report;
mod upgrade;
