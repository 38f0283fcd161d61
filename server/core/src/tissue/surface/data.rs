//! What a scene says of an organ by its surface compliance, and what of it cannot stand.

use serde::{Deserialize, Serialize};

use super::masters::{Masters, SURFACE_CARRIERS};
use crate::scene::params::within;
use crate::tissue::{TissueError, wrong};
use crate::tree::SphereTree;

/// Most masters.
pub const MAX_MASTERS: usize = 256;
/// Most cells of the large-displacement term.
pub const MAX_CELLS: usize = 64;

/// An organ condensed to its surface.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SurfaceCompliance {
    /// Numbers that a user may turn.
    pub params: SurfaceParams,
    /// Masters; in what follows x, y and z in turn of those that move.
    pub masters: Masters,
    /// Compliance between the masters for a Young's modulus of 1 Pa, 1/m: the lower triangle, row by row.
    pub compliance: Vec<f32>,
    /// The large-displacement term.
    pub cells: Cells,
    /// For each node of the tree who carries it.
    pub skin: Vec<SurfaceSkin>,
}

/// Cells of the organ in which the displacement gradient counts as one.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Cells {
    /// Volume of each, m3.
    pub volumes: Vec<f64>,
    /// Displacement of the masters for a stress of 1 Pa in each cell at a Young's modulus of 1 Pa, metres: cell by cell, in
    /// each the nine stresses row by row (`P_xx, P_xy, ...`), for each of these x, y, z of all masters.
    pub response: Vec<f32>,
}

/// Numbers of a surface compliance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SurfaceParams {
    /// Young's modulus, Pa. 100 to 1e8; a relaxed tongue about 10,000 to 15,000, a tense one 100,000.
    pub young: f64,
    /// Poisson's ratio of the finite elements that it was condensed from. 0 to 0.499.
    pub poisson: f64,
    /// Time constant with which it follows a load, seconds. 0.002 to 1; shorter feels livelier, longer more viscous.
    pub relaxation: f64,
    /// Share of the large-displacement term. 0 (linear) to 1.
    pub large: f64,
}

impl Default for SurfaceParams {
    fn default() -> Self {
        Self {
            young: 10e3,
            poisson: 0.49,
            relaxation: 0.02,
            large: 1.0,
        }
    }
}

/// Who carries a sphere: a place without a carrier has weight zero. Where the weights fall short of 1 the rest is held.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SurfaceSkin {
    /// Masters.
    pub masters: [u16; SURFACE_CARRIERS],
    /// How much each counts.
    pub weights: [f64; SURFACE_CARRIERS],
}

impl SurfaceParams {
    /// Checks the numbers, for ticks of `tick_s` seconds.
    ///
    /// # Errors
    /// Names the field, the value found and the value expected.
    pub fn validate(&self, tick_s: f64) -> Result<(), TissueError> {
        if !within(self.young, 100.0, 1e8) {
            return wrong("young", self.young, "100 to 1e8 Pa");
        }
        if !within(self.poisson, 0.0, 0.499) {
            return wrong("poisson", self.poisson, "0 to 0.499");
        }
        if !within(self.relaxation, 2.0 * tick_s, 1.0) {
            let least = 2.0 * tick_s;
            return wrong("relaxation", self.relaxation, format!("{least} to 1 s"));
        }
        if !within(self.large, 0.0, 1.0) {
            return wrong("large", self.large, "0 to 1");
        }
        Ok(())
    }
}

impl SurfaceCompliance {
    /// Numbers of state: twice the displacement of the masters (with the large-displacement term, and its linear part), then
    /// the gradients of the cells.
    pub fn state_len(&self) -> usize {
        6 * self.masters.moving() + 9 * self.cells.volumes.len()
    }

    /// Compliance between two of the masters' numbers for 1 Pa, 1/m.
    pub fn entry(&self, i: usize, j: usize) -> f64 {
        let (row, column) = if i < j { (j, i) } else { (i, j) };
        f64::from(self.compliance[row * (row + 1) / 2 + column])
    }

    /// Checks the data against the tree, for ticks of `tick_s` seconds.
    ///
    /// # Errors
    /// Names the field, the value found and the value expected.
    pub fn validate(&self, rest: &SphereTree, tick_s: f64) -> Result<(), TissueError> {
        self.params.validate(tick_s)?;
        let (m, cells) = (self.masters.moving(), self.cells.volumes.len());
        if !(1..=MAX_MASTERS).contains(&m) {
            return wrong("number of masters", m, "1 to 256");
        }
        if !self.masters.are_sound() {
            return wrong(
                "masters",
                format!("{m} that move of {}", self.masters.places.len()),
                "more than 8 at finite places",
            );
        }
        let entries = 3 * m * (3 * m + 1) / 2;
        if self.compliance.len() != entries {
            return wrong("entries of the compliance", self.compliance.len(), entries);
        }
        if cells > MAX_CELLS {
            return wrong("number of cells", cells, "0 to 64");
        }
        if let Some(volume) = self.cells.volumes.iter().find(|v| !within(**v, 1e-15, 1.0)) {
            return wrong("volume of a cell", volume, "1e-15 to 1 m3");
        }
        let entries = 27 * m * cells;
        if self.cells.response.len() != entries {
            return wrong("entries of the cells", self.cells.response.len(), entries);
        }
        if let Some(x) = self
            .cells
            .response
            .iter()
            .find(|x| x.is_nan() || x.abs() > 1e6)
        {
            return wrong("response to a cell", x, "at most 1e6 m");
        }
        if let Some(x) = self.compliance.iter().find(|x| x.is_nan() || x.abs() > 1e9) {
            return wrong("compliance", x, "at most 1e9 1/m");
        }
        if let Some(pivot) = self.negative_pivot() {
            return wrong("pivot of the compliance", pivot, "positive semi-definite");
        }
        if self.skin.len() != rest.nodes().len() {
            return wrong("skin of the surface", self.skin.len(), rest.nodes().len());
        }
        for (k, skin) in self.skin.iter().enumerate() {
            let sum: f64 = skin.weights.iter().sum();
            if skin.weights.iter().any(|w| !within(*w, 0.0, 1.0)) || !within(sum, 0.0, 1.0 + 1e-9) {
                return wrong(
                    "skin weights",
                    format!("{:?} of tree node {k}", skin.weights),
                    "none negative, sum at most 1",
                );
            }
            if let Some(master) = skin.masters.iter().find(|x| usize::from(**x) >= m) {
                return wrong(
                    "skin",
                    format!("master {master} for tree node {k}"),
                    format!("one under {m}"),
                );
            }
        }
        Ok(())
    }

    /// The first pivot of a Cholesky factor that is negative by more than single precision explains, if there is one.
    fn negative_pivot(&self) -> Option<f64> {
        let n = 3 * self.masters.moving();
        let most = (0..n).fold(0.0, |most, i| crate::math::fmax(most, self.entry(i, i)));
        let spare = 1e-5 * most;
        let mut factor = vec![0.0; n * n];
        for i in 0..n {
            let (above, row) = factor.split_at_mut(i * n);
            for j in 0..i {
                let other = &above[j * n..=j * n + j];
                let inner = row[..j].iter().zip(other).map(|(a, b)| a * b);
                row[j] = (self.entry(i, j) - inner.sum::<f64>()) / other[j];
            }
            let own = row[..i].iter().map(|a| a * a).sum::<f64>();
            let pivot = self.entry(i, i) + spare - own;
            // Written so that a NaN is found, too.
            if pivot.is_nan() || pivot <= 0.0 {
                return Some(pivot);
            }
            row[i] = pivot.sqrt();
        }
        None
    }
}
