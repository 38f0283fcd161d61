//! Log of the service.

mod entry;
mod judge;
mod reader;
mod writer;

pub use entry::{Command, EndReason, Entry, IdleCause, Violation, What};
pub use judge::{IdleSpan, Sent};
pub use reader::Log;
pub(crate) use writer::Writer;
