//! Last values of a force.

use std::collections::VecDeque;

/// Number of values that a trace holds.
pub const VALUES: usize = 160;

/// Last [`VALUES`] values of a force, newtons, oldest first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trace(VecDeque<f32>);

impl Trace {
    /// Adds a value, and drops the oldest one of a full trace. A value that is not finite counts as zero.
    pub fn push(&mut self, force_n: f32) {
        if self.0.len() == VALUES {
            self.0.pop_front();
        }
        self.0
            .push_back(if force_n.is_finite() { force_n } else { 0.0 });
    }

    /// Values, oldest first.
    pub fn values(&self) -> impl ExactSizeIterator<Item = f32> + '_ {
        self.0.iter().copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_full_trace_forgets_its_oldest_values() {
        let mut trace = Trace::default();
        for k in 0..VALUES + 3 {
            trace.push(k as f32);
        }
        trace.push(f32::NAN);
        assert_eq!(trace.values().len(), VALUES);
        assert_eq!(trace.values().next(), Some(4.0));
        assert_eq!(trace.values().last(), Some(0.0));
    }
}
