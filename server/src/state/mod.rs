//! State folder of a server: identity, tokens and plans that outlive the process.
//!
//! | file | content |
//! |---|---|
//! | `station.key`, `station.pub` | key that signs recordings; made by `sulcus-sessions` |
//! | `identity.toml` | certificate and its private key: [`identity`] |
//! | `tokens.json` | tokens as hashes, with role, station and dates: [`tokens`] |
//! | `people.json` | login names and hashes of passwords for the console: `people` |
//! | `classes.json` | classes, learners by opaque id, tasks, hashes of codes, exams: [`classes`] |
//! | `names.json` | key table: names of the learners: [`classes::names`] |
//! | `reassigned.jsonl` | sessions of another learner than the recording says: [`classes::reassigned`] |
//! | `audit.jsonl` | changes and readings of the console: [`audit`] |
//! | `plans/STATION.toml` | plan that was set at run time: [`crate::plan`] |
//! | `cases/` | patients of a school with their compiled scenes: [`crate::cases`] |
//! | `control.sock` | socket of the running server for `plan`: [`crate::control_socket`] |
//! | `*.lock` | locks of the above; empty |
//!
//! The folder has mode 0700 and every file 0600 from its first byte on. A file that other users can read is refused.
//! A file is replaced as a whole: written under another name, synchronised, renamed, and its folder synchronised. A
//! crash leaves the old or the new file, never a part.

pub mod audit;
pub mod backup;
pub mod classes;
pub mod date;
pub mod error;
mod files;
pub mod folder;
pub mod identity;
#[cfg(feature = "console")]
pub mod people;
pub mod rollover;
pub mod roster;
pub mod tokens;

pub use error::StateError;
pub use folder::StateFolder;
pub use identity::ServerIdentity;
pub use tokens::{Denied, Grant, Place, Tokens};

pub(crate) use files::{Lock, create_private, read_private, remove_private, write_private};
