//! Tokens: random secrets that open connections, each with a role, a station and an end.
//!
//! A token has 256 random bits. Its holder has the only copy: the state folder keeps the BLAKE3 hash. A hash without a
//! work factor is enough, because nobody can guess 256 bits. [`store`] changes the file, [`lookup`] answers a server.

pub mod lookup;
pub mod record;
pub mod store;

pub use lookup::{Denied, Grant, Tokens};
pub use record::{NewToken, Place, Secret, TokenRecord};
pub use store::TokenStore;
