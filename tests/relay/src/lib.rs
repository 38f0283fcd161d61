//! Networks that misbehave, the same from the same seed.
//!
//! - [`Network`] names common networks, `lan` to `geo`, and [`Conditions`] describes one direction of a network.
//! - [`Path`] decides the fate of each packet of one direction. It has no clock: the caller states the time.
//! - [`Wire`] carries values of one process through a path, for tests with a clock that the test moves.
//! - [`Relay`] carries UDP packets between clients and one server through two paths. [`Script`] changes it over time.
//!
//! All times are nanoseconds. All random numbers come from the seed, so two runs with the same packets at the same
//! times lose the same packets.

mod conditions;
mod network;
mod path;
mod relay;
mod script;
mod wire;

pub use conditions::{Conditions, ConditionsError};
pub use network::{Network, UnknownNetwork};
pub use path::{Counts, Fate, Path};
pub use relay::{Relay, RelayCounts};
pub use script::{Change, Script, ScriptError};
pub use wire::Wire;
