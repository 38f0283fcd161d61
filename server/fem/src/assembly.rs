//! Assembly of tetrahedra into one sparse matrix: number of each unknown, place of each entry, order of elimination.
//!
//! All three depend on the mesh alone. A Newton solver therefore fills in and factors new numbers only.

use faer::sparse::linalg::LltError;
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use faer::sparse::{Argsort, Pair, SparseColMat, SymbolicSparseColMat};
use faer::{Mat, MatRef, Side};
use sulcus_core::Vec3;
use sulcus_core::math::Mat3;

use crate::error::FemError;
use crate::mesh::TetMesh;
use crate::support;

/// Stiffness between each two nodes of a tetrahedron, N/m. The matrix is symmetric.
pub(crate) type Blocks = [[Mat3; 10]; 10];

/// Places of the entries of a mesh's stiffness matrix.
#[derive(Debug)]
pub(crate) struct Assembly {
    /// Number of each node's unknown along x, y, z; `None` where the node is held.
    unknowns: Vec<[Option<usize>; 3]>,
    count: usize,
    pattern: SymbolicSparseColMat<usize>,
    order: Argsort<usize>,
    elimination: SymbolicLlt<usize>,
}

fn failed(why: impl std::fmt::Debug) -> FemError {
    FemError::Factor(format!("{why:?}"))
}

impl Assembly {
    /// Returns the places of the entries for a mesh.
    ///
    /// # Errors
    /// [`FemError::Field`] if the mesh is invalid or is not held.
    pub fn new(mesh: &TetMesh) -> Result<Self, FemError> {
        mesh.validate()?;
        support::check(mesh)?;
        let mut count = 0;
        let mut number = |held: bool| {
            count += usize::from(!held);
            (!held).then(|| count - 1)
        };
        let held = mesh.held.iter();
        let unknowns: Vec<[Option<usize>; 3]> = held.map(|held| held.map(&mut number)).collect();
        let mut places = Vec::with_capacity(mesh.tets.len() * 465);
        for tet in &mesh.tets {
            each_entry(&unknowns, tet, |row, col, _| places.push(Pair { row, col }));
        }
        let (pattern, order) =
            SymbolicSparseColMat::try_new_from_indices(count, count, &places).map_err(failed)?;
        let elimination = SymbolicLlt::try_new(pattern.as_ref(), Side::Lower).map_err(failed)?;
        Ok(Self {
            unknowns,
            count,
            pattern,
            order,
            elimination,
        })
    }

    /// Factors the matrix of the stiffness that `blocks` returns for each tetrahedron; `None` if it is not positive
    /// definite.
    ///
    /// # Errors
    /// [`FemError::Factor`] if there is too little memory.
    pub fn factor(
        &self,
        mesh: &TetMesh,
        mut blocks: impl FnMut(&[u32; 10]) -> Blocks,
    ) -> Result<Option<Llt<usize, f64>>, FemError> {
        let mut values = Vec::with_capacity(mesh.tets.len() * 465);
        for tet in &mesh.tets {
            let blocks = blocks(tet);
            each_entry(&self.unknowns, tet, |_, _, [a, b, i, j]| {
                values.push(blocks[a][b][(i, j)]);
            });
        }
        let matrix = SparseColMat::new_from_argsort(self.pattern.clone(), &self.order, &values)
            .map_err(failed)?;
        drop(values);
        match Llt::try_new_with_symbolic(self.elimination.clone(), matrix.as_ref(), Side::Lower) {
            Ok(factored) => Ok(Some(factored)),
            Err(LltError::Numeric(_)) => Ok(None),
            Err(error) => Err(failed(error)),
        }
    }

    /// Returns the number of nodes.
    pub fn nodes(&self) -> usize {
        self.unknowns.len()
    }

    /// Returns the loads on the unknowns, a column for each of `loads`. Loads on held nodes are left out.
    pub fn gather(&self, loads: &[Vec<Vec3>]) -> Mat<f64> {
        let mut right = Mat::zeros(self.count, loads.len());
        for (c, load) in loads.iter().enumerate() {
            for (unknowns, force) in self.unknowns.iter().zip(load) {
                for (unknown, f) in unknowns.iter().zip(force.iter()) {
                    if let Some(row) = unknown {
                        right[(*row, c)] = *f;
                    }
                }
            }
        }
        right
    }

    /// Returns column `c` node by node, zero where a node is held.
    pub fn scatter(&self, answer: MatRef<'_, f64>, c: usize) -> Vec<Vec3> {
        let of = |unknowns: &[Option<usize>; 3]| {
            Vec3::from(unknowns.map(|unknown| unknown.map_or(0.0, |row| answer[(row, c)])))
        };
        self.unknowns.iter().map(of).collect()
    }
}

/// Calls `entry` for each entry of a tetrahedron in the lower triangle, with row, column and `[a, b, i, j]`: nodes
/// and axes.
///
/// The factorisation reads the lower triangle only.
fn each_entry(
    unknowns: &[[Option<usize>; 3]],
    tet: &[u32; 10],
    mut entry: impl FnMut(usize, usize, [usize; 4]),
) {
    for a in 0..10 {
        for b in 0..10 {
            let (rows, columns) = (unknowns[tet[a] as usize], unknowns[tet[b] as usize]);
            for (i, row) in rows.iter().enumerate() {
                for (j, column) in columns.iter().enumerate() {
                    if let (Some(row), Some(column)) = (row, column)
                        && row >= column
                    {
                        entry(*row, *column, [a, b, i, j]);
                    }
                }
            }
        }
    }
}
