//! Faults of replies in wait, counted down by one for each reply.

use crate::fault::{BadNumber, Place};
use crate::options::Omit;

/// Faults of replies in wait.
#[derive(Debug, Default)]
pub(crate) struct Pending {
    pub(crate) malformed: u32,
    pub(crate) truncated: u32,
    pub(crate) twice_reply: u32,
    pub(crate) twice_device: u32,
    pub(crate) silence: u32,
    pub(crate) http_error: u32,
    pub(crate) bad: Vec<Bad>,
    pub(crate) omit: Vec<(Omit, u32)>,
}

/// A bad number in wait.
#[derive(Debug, Clone)]
pub(crate) struct Bad {
    pub(crate) device: String,
    pub(crate) place: Place,
    pub(crate) value: BadNumber,
    pub(crate) left: u32,
}

impl Pending {
    /// Counts the bad numbers and omissions of one reply down.
    pub(crate) fn count_down(&mut self) {
        for bad in &mut self.bad {
            bad.left = bad.left.saturating_sub(1);
        }
        self.bad.retain(|bad| bad.left > 0);
        for (_, left) in &mut self.omit {
            *left = left.saturating_sub(1);
        }
        self.omit.retain(|(_, left)| *left > 0);
    }
}

/// Counts one down; true where something was in wait.
pub(crate) fn take(count: &mut u32) -> bool {
    let some = *count > 0;
    *count = count.saturating_sub(1);
    some
}
