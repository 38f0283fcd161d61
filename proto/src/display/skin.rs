//! Rule by which a mesh follows the handles of a frame.

use serde::{Deserialize, Serialize};

use super::{HANDLES, finite, rule};
use crate::CodecError;

/// Weight 1 as an integer. Weights range from -2 to 2.
pub const WEIGHT: f32 = 16_384.0;

/// Carriers of each vertex of a mesh. A vertex moves by `sum_i w_vi u_i`, with the displacement `u_i` of handle `i`.
///
/// Handles are places of the display alone. Their number and places do not depend on hidden truth, unlike the spheres
/// of a gingiva.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Skin {
    /// Handles at rest, world axes, metres.
    pub handles: Vec<[f32; 3]>,
    /// Index of each vertex's first entry in `carriers`, then the number of entries.
    first: Vec<u32>,
    /// Handle of each entry.
    carriers: Vec<u16>,
    /// Weight of each entry, in units of 1 / [`WEIGHT`].
    weights: Vec<i16>,
}

impl Skin {
    /// Creates a skin without vertices over handles at rest, metres.
    pub fn over(handles: Vec<[f32; 3]>) -> Self {
        Self {
            handles,
            first: vec![0],
            ..Self::default()
        }
    }

    /// Appends a vertex with its carriers: handle and weight. Weights beyond -2 to 2 are limited; zero is left out.
    pub fn push(&mut self, carriers: impl IntoIterator<Item = (u16, f64)>) {
        for (handle, weight) in carriers {
            // The conversion limits to the range of 16 bits; NaN becomes zero.
            let weight = (weight * f64::from(WEIGHT)).round() as i16;
            if weight != 0 {
                self.carriers.push(handle);
                self.weights.push(weight);
            }
        }
        self.first.push(self.carriers.len() as u32);
    }

    /// Number of vertices.
    pub fn vertices(&self) -> usize {
        self.first.len().saturating_sub(1)
    }

    /// Carriers of vertex `v`: handle and dimensionless weight.
    pub fn carriers(&self, v: usize) -> impl Iterator<Item = (u16, f32)> + '_ {
        let entries = self.first[v] as usize..self.first[v + 1] as usize;
        let weights = self.weights[entries.clone()].iter();
        self.carriers[entries]
            .iter()
            .zip(weights)
            .map(|(handle, weight)| (*handle, f32::from(*weight) / WEIGHT))
    }

    /// Writes the displacement of each vertex for the displacements `moved` of all handles, in the same unit.
    pub fn displacements(&self, moved: &[[f32; 3]], out: &mut [[f32; 3]]) {
        for (v, out) in out.iter_mut().enumerate().take(self.vertices()) {
            *out = [0.0; 3];
            for (handle, weight) in self.carriers(v) {
                for (sum, by) in out.iter_mut().zip(moved[usize::from(handle)]) {
                    *sum += weight * by;
                }
            }
        }
    }

    pub(super) fn check(&self, vertices: usize) -> Result<(), CodecError> {
        rule(self.handles.len() <= HANDLES, "a skin has too many handles")?;
        finite("a handle", self.handles.iter().flatten())?;
        let (entries, handles) = (self.carriers.len(), self.handles.len());
        rule(
            self.weights.len() == entries && u32::try_from(entries).is_ok(),
            "a skin has not one weight for each carrier",
        )?;
        rule(
            self.vertices() == vertices
                && self.first.first() == Some(&0)
                && self.first.last().map(|last| *last as usize) == Some(entries)
                && self.first.is_sorted(),
            "a skin does not fit the vertices",
        )?;
        rule(
            self.carriers.iter().all(|&k| usize::from(k) < handles),
            "a carrier is no handle",
        )?;
        rule(!self.weights.contains(&0), "a weight is zero")
    }
}
