//! An organ condensed to its surface: what the tick needs of the finite elements
//! ([`sulcus_core::tissue::surface`] says what it does with it).
//!
//! Displacements and tractions of the surface are taken from one space, spanned by a smooth function `w_a` for each *master*
//! (the weights with which places on the surface follow it). Galerkin's condensation in that space, `S = M^-1 (W' K^-1 W) M^-1`
//! with `W_a` the consistent forces of the traction `w_a` and `M` the mass matrix of the functions, is symmetric and
//! positive semi-definite by construction, and does not know point loads (whose displacement grows without bound on finer meshes).

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
use crate::{Elastic, Factored, FemError, TetMesh};
use cells::divide;
use masters::{Functions, choose};

/// Most bytes of a condensed organ.
const MOST_BYTES: usize = 1 << 24;
/// Right-hand sides that are solved at once.
const BATCH: usize = 48;

/// How fine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CondenseOptions {
    /// Masters that move, at most. 9 to 256: on a real tongue 96 leave 1.4 % of the largest displacement, 128 1.1 %, 256 0.8 %.
    pub masters: usize,
    /// Cells of the large-displacement term. 0 to 64: none leave 7.5 % at 15 mm, 16 3.0 %, 32 and 64 2.8 %.
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
    /// As bytes.
    ///
    /// # Errors
    /// Only when it is too large to encode.
    pub fn to_bytes(&self) -> Result<Vec<u8>, FemError> {
        bincode::serde::encode_to_vec(self, bincode::config::standard())
            .map_err(|error| FemError::Bytes(error.to_string()))
    }

    /// Back from bytes. (Masters that no surface has are the business of [`SurfaceCompliance::validate`].)
    ///
    /// # Errors
    /// When they are not those of a condensed organ.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, FemError> {
        let config = bincode::config::standard().with_limit::<MOST_BYTES>();
        let (organ, used): (Self, usize) = bincode::serde::decode_from_slice(bytes, config)
            .map_err(|error| FemError::Bytes(error.to_string()))?;
        if used != bytes.len() || !organ.masters.are_sound() {
            return Err(FemError::Bytes("not what was written".into()));
        }
        Ok(organ)
    }

    /// The masters.
    pub fn masters(&self) -> &Masters {
        &self.masters
    }

    /// Who carries a sphere that follows the masters with these weights (by number, each once; no more than eight).
    pub fn skin(&self, weights: &[(usize, f64)]) -> SurfaceSkin {
        let mut skin = SurfaceSkin::default();
        let moving = weights.iter().filter(|(k, _)| *k < self.masters.moving());
        for (slot, &(k, w)) in moving.enumerate().take(SURFACE_CARRIERS) {
            skin.masters[slot] = k as u16;
            skin.weights[slot] = w;
        }
        skin
    }

    /// The tissue model of an organ whose spheres are carried as `skin` says, node by node of its tree.
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

/// Condenses a mesh of a material with this Poisson's ratio. `progress` gets what is being done and how much of it is.
///
/// # Errors
/// When mesh, ratio or options are wrong, or the mesh is not held.
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
    // All is proportional to the modulus or its inverse.
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
    // To the left and to the right, the same by symmetry.
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

/// `M^-1` times each column, axis by axis of rows in the order x, y, z of each master.
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
