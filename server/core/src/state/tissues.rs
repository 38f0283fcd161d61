//! Numbers of all tissues, with a flag for each tissue at rest. A tissue at rest costs nothing in a tick, and a byte in
//! its hash and in a snapshot.

use std::ops::{Deref, Range};

use crate::Scene;

/// State numbers of all tissues, object after object, with a flag for each yielding object: whether all its numbers are
/// zero. Each tissue model defines the number and the units.
///
/// The flag is part of the state and always agrees with the numbers: every change must end with `Tissues::settle`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tissues {
    numbers: Vec<f64>,
    parts: Vec<Part>,
}

/// Range of one yielding object in `Tissues::numbers`, and whether all its numbers are zero.
#[derive(Clone, Debug, PartialEq)]
struct Part {
    range: Range<usize>,
    at_rest: bool,
}

/// Slice of all numbers, object after object.
impl Deref for Tissues {
    type Target = [f64];
    fn deref(&self) -> &[f64] {
        &self.numbers
    }
}

impl Tissues {
    /// Creates all tissues of `scene` at rest.
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

    /// Returns the number of yielding objects.
    pub(super) fn parts(&self) -> usize {
        self.parts.len()
    }

    /// Whether all numbers of the yielding object `slot` (index among the yielding objects) are zero: the tissue is at
    /// rest.
    #[inline]
    pub fn at_rest(&self, slot: usize) -> bool {
        self.parts[slot].at_rest
    }

    /// Returns the state numbers of the yielding object `slot`, the index among the yielding objects. The tissue model
    /// defines their units.
    pub fn of(&self, slot: usize) -> &[f64] {
        &self.numbers[self.parts[slot].range.clone()]
    }

    /// Returns the numbers of the yielding object `slot` (index among the yielding objects) for a change;
    /// `Tissues::settle` must follow.
    pub(crate) fn of_mut(&mut self, slot: usize) -> &mut [f64] {
        &mut self.numbers[self.parts[slot].range.clone()]
    }

    /// Updates the rest flag of the yielding object `slot` (index among the yielding objects) after a change of its
    /// numbers. An object with a number that is not finite is reset to rest. Returns whether all numbers were finite.
    pub(crate) fn settle(&mut self, slot: usize) -> bool {
        let Part { range, at_rest } = &mut self.parts[slot];
        let numbers = &mut self.numbers[range.clone()];
        // A finite number times zero is zero, any other is NaN: a test without a branch per number.
        let magnitude = |x: f64| x.to_bits() & !(1 << 63);
        let (any, wrong) = numbers.iter().fold((0, 0), |(any, wrong), x| {
            (any | magnitude(*x), wrong | magnitude(x * 0.0))
        });
        let finite = wrong == 0;
        *at_rest = any == 0 || !finite;
        if *at_rest {
            // At rest every zero is positive: one encoding.
            numbers.fill(0.0);
        }
        finite
    }
}
