//! Number of stations that this machine holds, by the measured cost of their ticks.
//!
//! - [`cost`]: CPU time of a scene's ticks, measured at the start and corrected by running sessions
//! - [`machine`]: cores of this process, and limits of the kernel and of containers
//! - [`placement`]: core for a new session, or a sentence of refusal
//! - [`throttle`]: time that the kernel's limits took
//! - [`pin`]: a thread on one core
//!
//! # Model
//! A session has a simulation thread at SCHED_FIFO, pinned to one core. Threads of one priority do not preempt each
//! other: a tick waits for the running tick of another session on its core.
//! - Simulation threads use at most 70 % of each core, and at most 90 % of the kernel's real-time share. The kernel's
//!   throttle, 95 % by default, therefore never acts, and network and recorders always run.
//! - The mean ticks of all sessions of a core and the longest tick of one, its p99.9, fit into the shortest period.
//! - Each session also has its network, recorder and viewers' channels: a fixed share, corrected by measurement.
//!   Everything together uses at most 90 % of all cores, and of a container's quota.
//!
//! A machine without a session takes any one session, whatever its cost: misses are counted and recorded.

pub mod cost;
pub mod machine;
mod motion;
pub mod pin;
pub mod placement;
pub mod throttle;

pub use cost::{Cost, Estimate, measure_cost};
pub use machine::Machine;
pub use pin::pin_to;
pub use placement::{Capacity, Load, Model, NoRoom, SessionId};
pub use throttle::{Throttle, thread_wait_ns};
