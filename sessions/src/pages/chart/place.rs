//! Place of a row in the drawing of a jaw: heights of teeth, scale and lines of numbers.

use super::{LINE, MM};

/// Place of a row in the drawing of a jaw.
pub struct Row {
    /// Whether the row is the cheek's side.
    pub buccal: bool,
    /// Name of the side.
    pub name: &'static str,
    /// Direction of the roots: -1 up the page, 1 down.
    pub up: f64,
    /// Height of the cemento-enamel junction.
    pub cej: f64,
    /// Height of the line of numbers next to the teeth.
    pub inner: f64,
    /// Right edge.
    pub width: f64,
}

impl Row {
    /// Height of a place `mm` from the cemento-enamel junction towards the root.
    pub fn y(&self, mm: f64) -> f64 {
        self.cej + self.up * mm * MM
    }

    /// Height of line `k` of the numbers, from the teeth outwards.
    pub fn line(&self, k: usize) -> f64 {
        self.inner + self.up * k as f64 * LINE
    }
}
