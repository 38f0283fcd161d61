//! Data of an organ's surface compliance in a scene, and their validation.

use serde::{Deserialize, Serialize};

use super::masters::{Masters, SURFACE_CARRIERS};
use crate::scene::params::within;
use crate::tissue::{TissueError, wrong};
use crate::tree::SphereTree;

/// Largest number of moving masters of one organ. Masters are the points to which the finite elements are condensed.
pub const MAX_MASTERS: usize = 256;
/// Largest number of cells of one organ. The cells carry the large-displacement term.
pub const MAX_CELLS: usize = 64;

/// Organ as finite elements condensed to masters, points on its surface.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SurfaceCompliance {
    /// Parameters of the material. All but Poisson's ratio may change without a new condensation.
    pub params: SurfaceParams,
    /// Masters. The tables below list x, y and z of each moving master in turn.
    pub masters: Masters,
    /// Compliance between the moving masters at a Young's modulus of 1 Pa, 1/m: the lower triangle, row by row. Divided
    /// by Young's modulus, an entry is in m/N.
    pub compliance: Vec<f32>,
    /// Cells of the large-displacement term.
    pub cells: Cells,
    /// Carriers of each node of the tree, in the order of the tree's nodes.
    pub skin: Vec<SurfaceSkin>,
}

/// Cells of the organ, each with a constant displacement gradient.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Cells {
    /// Volume of each cell, m3, 1e-15 to 1.
    pub volumes: Vec<f64>,
    /// Displacement of the masters for a stress of 1 Pa in each cell at a Young's modulus of 1 Pa, metres.
    ///
    /// The order is cell by cell, then the nine stresses row by row (`P_xx, P_xy, ...`), then x, y, z of all moving
    /// masters.
    pub response: Vec<f32>,
}

/// Parameters of a surface compliance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SurfaceParams {
    /// Young's modulus, Pa. Default 10,000, range 100 to 1e8. A relaxed tongue has about 10,000 to 15,000, a tense one
    /// 100,000.
    pub young: f64,
    /// Poisson's ratio of the finite elements before condensation. Default 0.49, range 0 to 0.499.
    pub poisson: f64,
    /// Time constant of the response to a load, seconds. Default 0.02, range two ticks (0.002 at 1 kHz) to 1. Shorter
    /// values feel livelier, longer values more viscous.
    pub relaxation: f64,
    /// Factor on the large-displacement term. Default 1, range 0 (linear) to 1.
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

/// Carriers of a sphere. An unused slot has weight zero. If the weights sum to less than 1, held masters carry the
/// rest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SurfaceSkin {
    /// Moving masters that carry the sphere.
    pub masters: [u16; SURFACE_CARRIERS],
    /// Weights of the masters, none negative, sum at most 1.
    pub weights: [f64; SURFACE_CARRIERS],
}

impl SurfaceParams {
    /// Checks the parameters for ticks of `tick_s` seconds.
    ///
    /// # Errors
    /// A parameter is out of range: the error names the field, the value found and the value expected.
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
    /// Returns the count of numbers in the state. The state has the displacement of the masters with the
    /// large-displacement term, its linear part (both in metres), and the displacement gradients of the cells.
    pub fn state_len(&self) -> usize {
        6 * self.masters.moving() + 9 * self.cells.volumes.len()
    }

    /// Returns the compliance between the coordinates `i` and `j` of the moving masters at a Young's modulus of 1 Pa,
    /// 1/m. A coordinate is three times the master's index, plus 0, 1 or 2 for x, y or z.
    pub fn entry(&self, i: usize, j: usize) -> f64 {
        let (row, column) = if i < j { (j, i) } else { (i, j) };
        f64::from(self.compliance[row * (row + 1) / 2 + column])
    }

    /// Checks the data against the tree, for ticks of `tick_s` seconds.
    ///
    /// # Errors
    /// A field is invalid: the error names the field, the value found and the value expected.
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

    /// Returns the first pivot of the compliance's Cholesky factor that is not positive, 1/m; `None` if all are.
    /// Diagonal entries are raised by 1e-5 of the largest, to allow for single precision.
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
            // A NaN counts as a negative pivot.
            if pivot.is_nan() || pivot <= 0.0 {
                return Some(pivot);
            }
            row[i] = pivot.sqrt();
        }
        None
    }
}
