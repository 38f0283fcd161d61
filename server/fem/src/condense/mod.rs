//! An organ condensed to its surface: the data that [`sulcus_core::tissue::surface`] needs of the finite elements.
//!
//! Displacements and tractions of the surface belong to one space. A smooth function `w_a` for each *master* spans
//! it: the weights with which places on the surface follow the master.
//!
//! Galerkin's condensation in that space is `S = M^-1 (W' K^-1 W) M^-1`. `W_a` are the consistent forces of the
//! traction `w_a`, and `M` is the mass matrix of the functions. `S` is symmetric and positive semi-definite by
//! construction.
//!
//! Point loads do not occur. Their displacement would grow without bound on finer meshes.

mod cells;
mod masters;

use faer::linalg::solvers::{Llt, Solve};
use faer::{Mat, Side};
use serde::{Deserialize, Serialize};
use sulcus_core::tissue::surface::{
    Cells, MAX_CELLS, MAX_MASTERS, Masters, SURFACE_CARRIERS, SurfaceCompliance, SurfaceParams,
    SurfaceSkin,
};

use crate::element::gradients;
use crate::error::FemError;
use crate::mesh::TetMesh;
use crate::stiffness::{Elastic, Factored};
use cells::divide;
use masters::{Functions, choose};

/// Most bytes of a condensed organ.
const MOST_BYTES: usize = 1 << 24;
/// Right-hand sides of one solution.
const BATCH: usize = 48;

/// Fineness of a condensation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CondenseOptions {
    /// Largest number of masters that move, 9 to 256. On a real tongue 96 leave an error of 1.4 % of the largest
    /// displacement, 128 of 1.1 %, 256 of 0.8 %.
    pub masters: usize,
    /// Number of cells of the large-displacement term, 0 to 64. The error at 15 mm is 7.5 % without cells, 3.0 % with
    /// 16, 2.8 % with 32 and 64.
    pub cells: usize,
}

impl Default for CondenseOptions {
    fn default() -> Self {
        Self {
            masters: 128,
            cells: 32,
        }
    }
}

/// A condensed organ.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Condensed {
    masters: Masters,
    poisson: f64,
    compliance: Vec<f32>,
    cells: Cells,
}

impl Condensed {
    /// Returns the organ as bytes.
    ///
    /// # Errors
    /// [`FemError::Bytes`] if the organ is too large to encode.
    pub fn to_bytes(&self) -> Result<Vec<u8>, FemError> {
        bincode::serde::encode_to_vec(self, bincode::config::standard())
            .map_err(|error| FemError::Bytes(error.to_string()))
    }

    /// Returns the organ that [`Condensed::to_bytes`] wrote.
    ///
    /// Masters outside of a surface are found by [`SurfaceCompliance::validate`], not here.
    ///
    /// # Errors
    /// [`FemError::Bytes`] if the bytes are not those of a condensed organ.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, FemError> {
        let config = bincode::config::standard().with_limit::<MOST_BYTES>();
        let (organ, used): (Self, usize) = bincode::serde::decode_from_slice(bytes, config)
            .map_err(|error| FemError::Bytes(error.to_string()))?;
        if used != bytes.len() || !organ.masters.are_sound() {
            return Err(FemError::Bytes("not what was written".into()));
        }
        Ok(organ)
    }

    /// Returns the masters.
    pub fn masters(&self) -> &Masters {
        &self.masters
    }

    /// Returns the carriers of a sphere that follows the masters with these weights.
    ///
    /// `weights` has at most eight pairs of a master's number and its weight; no master occurs twice.
    pub fn skin(&self, weights: &[(usize, f64)]) -> SurfaceSkin {
        let mut skin = SurfaceSkin::default();
        let moving = weights.iter().filter(|(k, _)| *k < self.masters.moving());
        for (slot, &(k, w)) in moving.enumerate().take(SURFACE_CARRIERS) {
            skin.masters[slot] = k as u16;
            skin.weights[slot] = w;
        }
        skin
    }

    /// Returns the tissue model of the organ. `skin` has the carriers of each node of its tree.
    pub fn model(&self, skin: Vec<SurfaceSkin>, params: SurfaceParams) -> SurfaceCompliance {
        SurfaceCompliance {
            params: SurfaceParams {
                poisson: self.poisson,
                ..params
            },
            masters: self.masters.clone(),
            compliance: self.compliance.clone(),
            cells: self.cells.clone(),
            skin,
        }
    }
}

/// Condenses a mesh of a material with the given Poisson's ratio. `progress` receives the current step and the share
/// that is done.
///
/// # Errors
/// [`FemError`] if mesh, ratio or options are invalid, or the mesh is not held.
pub fn condense(
    mesh: &TetMesh,
    poisson: f64,
    options: &CondenseOptions,
    progress: &dyn Fn(&str, f64),
) -> Result<Condensed, FemError> {
    if !(9..=MAX_MASTERS).contains(&options.masters) {
        let found = options.masters.to_string();
        return Err(FemError::field("masters", found, "9 to 256"));
    }
    if options.cells > MAX_CELLS {
        let found = options.cells.to_string();
        return Err(FemError::field("cells", found, "0 to 64"));
    }
    progress("factoring the finite elements", 0.0);
    // All results are proportional to the modulus or to its inverse.
    let material = Elastic {
        young: 1.0,
        poisson,
    };
    let factored = Factored::new(mesh, &material)?;
    let masters = choose(mesh, options.masters)?;
    let functions = Functions::new(mesh, &masters);
    let count = masters.moving();
    let mass = functions
        .mass
        .llt(Side::Lower)
        .map_err(|error| FemError::Factor(format!("mass of the masters: {error:?}")))?;

    let points: Vec<_> = mesh
        .tets
        .iter()
        .filter_map(|tet| gradients(&mesh.corners(tet)))
        .collect();
    let mut strained = vec![0.0; points.len()];
    let mut raw = Mat::<f64>::zeros(3 * count, 3 * count);
    let numbers: Vec<usize> = (0..3 * count).collect();
    for batch in numbers.chunks(BATCH) {
        progress(
            "loading each master",
            batch[0] as f64 / numbers.len() as f64,
        );
        let loads = batch.iter().map(|k| functions.traction(k / 3, k % 3));
        let answers = factored.solve(&loads.collect::<Vec<_>>())?;
        for (&column, moved) in batch.iter().zip(&answers) {
            functions.read_all(moved, &mut raw, column);
            cells::add_strain(mesh, &points, moved, &mut strained);
        }
    }
    // The two sides are equal by symmetry.
    let half = projected(&mass, &raw);
    let whole = projected(&mass, &half.transpose().to_owned());
    let mut compliance = Vec::with_capacity(3 * count * (3 * count + 1) / 2);
    for i in 0..3 * count {
        for j in 0..=i {
            compliance.push((0.5 * (whole[(i, j)] + whole[(j, i)])) as f32);
        }
    }

    let division = divide(mesh, &points, &strained, options.cells);
    let mut cells = Cells {
        volumes: division.volumes,
        response: Vec::with_capacity(27 * count * options.cells),
    };
    let parts = cells.volumes.len();
    for cell in 0..parts {
        progress("stressing each cell", cell as f64 / parts as f64);
        let loads: Vec<_> = (0..9)
            .map(|k| cells::polarised(mesh, &points, &division.of, cell, k / 3, k % 3))
            .collect();
        let answers = factored.solve(&loads)?;
        let mut raw = Mat::<f64>::zeros(3 * count, 9);
        for (k, moved) in answers.iter().enumerate() {
            functions.read_all(moved, &mut raw, k);
        }
        let moved = projected(&mass, &raw);
        for k in 0..9 {
            cells
                .response
                .extend((0..3 * count).map(|i| moved[(i, k)] as f32));
        }
    }
    progress("condensed", 1.0);
    Ok(Condensed {
        masters,
        poisson,
        compliance,
        cells,
    })
}

/// Returns `M^-1` times each column. Rows are in the order x, y, z of each master; axes are treated one by one.
fn projected(mass: &Llt<f64>, rows: &Mat<f64>) -> Mat<f64> {
    let (count, columns) = (rows.nrows() / 3, rows.ncols());
    let mut out = Mat::<f64>::zeros(3 * count, columns);
    for axis in 0..3 {
        let part = Mat::from_fn(count, columns, |i, j| rows[(3 * i + axis, j)]);
        let solved = mass.solve(&part);
        for i in 0..count {
            for j in 0..columns {
                out[(3 * i + axis, j)] = solved[(i, j)];
            }
        }
    }
    out
}
