//! The numbers of all tissues, and which tissues are at rest: those cost nothing in a tick, in its hash and in a snapshot.

use std::ops::{Deref, Range};

use crate::Scene;

/// Numbers of all tissues, object after object, and for each object that yields whether all of its numbers are zero. That
/// flag is part of the state and always true to the numbers: whoever changes them goes through `Tissues::settle`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tissues {
    numbers: Vec<f64>,
    parts: Vec<Part>,
}

/// One object's.
#[derive(Clone, Debug, PartialEq)]
struct Part {
    range: Range<usize>,
    at_rest: bool,
}

/// All numbers, object after object.
impl Deref for Tissues {
    type Target = [f64];
    fn deref(&self) -> &[f64] {
        &self.numbers
    }
}

impl Tissues {
    /// All tissues of `scene` at rest.
    pub(super) fn new(scene: &Scene) -> Self {
        let mut end = 0;
        let soft = scene
            .objects
            .iter()
            .filter(|object| !object.tissue.is_rigid());
        let parts = soft.map(|object| {
            let begin = end;
            end += object.tissue.state_len(&object.tree);
            Part {
                range: begin..end,
                at_rest: true,
            }
        });
        let parts = parts.collect();
        Self {
            numbers: vec![0.0; end],
            parts,
        }
    }

    /// Number of objects that yield.
    pub(super) fn parts(&self) -> usize {
        self.parts.len()
    }

    /// Whether all numbers of the yielding object `slot` (counted among those that yield) are zero.
    #[inline]
    pub fn at_rest(&self, slot: usize) -> bool {
        self.parts[slot].at_rest
    }

    /// Numbers of the yielding object `slot`.
    pub fn of(&self, slot: usize) -> &[f64] {
        &self.numbers[self.parts[slot].range.clone()]
    }

    /// Numbers of the yielding object `slot`, to be changed: `Tissues::settle` must follow.
    pub(crate) fn of_mut(&mut self, slot: usize) -> &mut [f64] {
        &mut self.numbers[self.parts[slot].range.clone()]
    }

    /// Notes whether the yielding object `slot` is at rest after its numbers were changed. One that has a number that is
    /// not finite goes back to rest; returns whether it had none.
    pub(crate) fn settle(&mut self, slot: usize) -> bool {
        let Part { range, at_rest } = &mut self.parts[slot];
        let numbers = &mut self.numbers[range.clone()];
        // (What is finite times zero is zero, all else is not a number: without a branch for each.)
        let magnitude = |x: f64| x.to_bits() & !(1 << 63);
        let (any, wrong) = numbers.iter().fold((0, 0), |(any, wrong), x| {
            (any | magnitude(*x), wrong | magnitude(x * 0.0))
        });
        let finite = wrong == 0;
        *at_rest = any == 0 || !finite;
        if *at_rest {
            // (Zeros have one sign at rest.)
            numbers.fill(0.0);
        }
        finite
    }
}
